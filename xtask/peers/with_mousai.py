"""Forced responses with mousai, which has no memory in its forces: smooth springs only.

Upwards, each point from the previous solution, by its balance in frequency (`hb_freq`).
"""

import contextlib
import io
import warnings

import mousai
import numpy as np

import exchange

warnings.simplefilter("ignore")


def acceleration(scene):
    mass = np.linalg.inv(np.array(scene["mass"]))
    damping, stiffness = np.array(scene["damping"]), np.array(scene["stiffness"])
    force, cubic = scene["force"], scene["law"]["stiffness"]

    def of(x, v, params):
        total = -(damping @ v) - stiffness @ x
        total[0] -= cubic * x[0] ** 3
        total[-1] += force * np.cos(params["omega"] * params["cur_time"])
        return (mass @ total).reshape(-1, 1)

    return of


def linear(scene, omega, samples):
    """The response without the contact, at equal instants of a period."""
    matrices = [np.array(scene[name]) for name in ("stiffness", "mass", "damping")]
    load = np.zeros(len(matrices[0]))
    load[-1] = scene["force"]
    amplitudes = np.linalg.solve(matrices[0] - omega**2 * matrices[1] + 1j * omega * matrices[2], load)
    return np.real(amplitudes[:, None] * np.exp(2j * np.pi * np.arange(samples) / samples))


def spectra(x, harmonics):
    coefficients = np.fft.rfft(x) * 2 / x.shape[1]
    coefficients[:, 0] /= 2
    return [list(enumerate(row[: harmonics + 1])) for row in coefficients]


def solve(scene, case):
    of = acceleration(scene)
    harmonics = case["harmonics"]

    def sweep():
        started = linear(scene, 2 * np.pi * case["frequencies"][0], 2 * harmonics + 1)
        points = []
        began = exchange.clock()
        for hertz in case["frequencies"]:
            try:
                with contextlib.redirect_stdout(io.StringIO()):
                    solution = mousai.hb_freq(
                        of, started, 2 * np.pi * hertz, num_harmonics=harmonics, mask_constant=False,
                        num_time_steps=case["samples"], f_tol=case["tolerance"], maxiter=50,
                    )
                started = solution[1]
                points.append((hertz, started))
            except Exception:  # whatever mousai raises where it does not converge
                points.append((hertz, None))
        return exchange.clock() - began, points

    seconds, found = exchange.repeat(sweep, case)
    points = [exchange.point(hertz, None if x is None else spectra(x, harmonics)) for hertz, x in found]
    return case | {"seconds": seconds / len(points), "points": points}


request = exchange.read()
answers = [solve(request["scene"], case) for case in request["cases"]]
exchange.write(["mousai", "numpy", "scipy"], answers)
