"""Forced responses with pyHarm: its analysis without continuation, upwards, each point from the previous solution.

A point that fails is tried once more from the linear response, as pyHarm starts a sweep. (Its own loop would repeat the
failed step for ever, or shorten it and miss the frequencies.) Only the loop over frequencies is timed; numba compiles in
the warm-up.
"""

import logging

import numpy as np
from pyHarm.Maestro import Maestro
from pyHarm.Solver import SystemSolution

import exchange

logging.disable(logging.CRITICAL)


def description(scene, case):
    law = scene["law"]
    if law["type"] == "elastic_coulomb":
        contact = {"type": "Jenkins", "mu": 1.0, "N0": law["slip_force"], "k": law["stiffness"], "jac": "analytical"}
    else:
        contact = {"type": "CubicSpring", "k": law["stiffness"]}
    matrices = {"M": scene["mass"], "C": scene["damping"], "K": scene["stiffness"]}
    matrices = {name: np.array(matrix) for name, matrix in matrices.items()}
    matrices["G"] = np.zeros_like(matrices["M"])
    last = len(scene["mass"]) - 1
    omega = 2 * np.pi * np.array(case["frequencies"])
    step = omega[1] - omega[0]
    return {
        "analysis": {
            "sweep": {
                "study": "frf",
                "puls_inf": omega[0],
                "puls_sup": omega[-1] - 0.5 * step,  # the last step passes it
                "ds_min": 1e-3 * step,
                "ds_max": step,
                "ds0": step,
                "stepsizer": "constant",
                "predictor": "previous",
                "corrector": "nocontinuation",
                "solver": "scipyroot",
                "solver_options": {
                    "root": {"method": "hybr", "options": {"xtol": case["tolerance"]}},
                    # Where rounding stops it short of that, the residual in N decides.
                    "end_status_accepted": [1, 2, 3, 4, 5],
                    "residual_tolerance": 1e-9 * scene["force"],
                },
                "verbose": False,
            }
        },
        "system": {"type": "Base", "nh": case["orders"], "nti": case["samples"]},
        "substructures": {"masses": {"matrix": matrices, "ndofs": 1}},
        "connectors": {
            "contact": contact | {"connect": {"masses": [0], "GROUND": [0]}, "dirs": [0]},
            "force": {"type": "CosinusForcing", "connect": {"masses": [last]}, "dirs": [0], "amp": scene["force"]},
        },
    }


def spectra(dofs, solution):
    """x = c cos kΩt + s sin kΩt is Re (c − i s) e^{ikΩt}."""
    if not solution.flag_accepted:
        return None
    found = {}
    for row, value in zip(dofs.itertuples(), solution.x):
        harmonics = found.setdefault(row.node_num, {})
        part = value if row.cs == "c" else -1j * value
        harmonics[row.harm] = harmonics.get(row.harm, 0) + part
    return [sorted(found[node].items()) for node in sorted(found)]


def step(analysis, start, last):
    """What the analysis does in a step, from a given start."""
    reduced, _, _ = analysis._update_reductor(start, last)
    solution = SystemSolution(reduced, last)
    analysis.solver.Solve(solution, analysis.SolList)
    analysis.CompleteSolution(solution)
    return solution


def solve(scene, case):
    def sweep():
        maestro = Maestro(description(scene, case))
        analysis = maestro.nls["sweep"]
        solutions = []
        began = exchange.clock()
        analysis.initialise()
        last = analysis.SolList[-1]
        solutions.append(last)
        for hertz in case["frequencies"][1:]:
            omega = 2 * np.pi * hertz
            solution = step(analysis, np.append(last.x[:-1], omega), last)
            if not solution.flag_accepted:
                analysis.analysis_options["puls_start"] = omega
                solution = step(analysis, analysis._get_x0(None), last)
            solution.SaveSolution(analysis.SolList)
            solutions.append(solution)
            if solution.flag_accepted:
                last = solution
            analysis.purge_jacobians()
        return exchange.clock() - began, (maestro.system.expl_dofs, solutions)

    seconds, (dofs, solutions) = exchange.repeat(sweep, case)
    points = [exchange.point(hertz, spectra(dofs, one)) for hertz, one in zip(case["frequencies"], solutions)]
    return case | {"seconds": seconds / len(points), "points": points}


request = exchange.read()
answers = [solve(request["scene"], case) for case in request["cases"]]
exchange.write(["pyharm-os", "numpy", "scipy", "numba"], answers)
