"""Forced responses by stepping through time from rest until the motion repeats, each point on its own.

`newmark`: average acceleration at fixed steps a period in NumPy, sliders by return mapping, Newton's method in each step.
`solve_ivp`: SciPy's adaptive Runge–Kutta method (DOP853), the slider's spring as one more state.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp

import exchange

MOST = 1000  # periods


def spectra(motion, harmonics):
    """Of samples [instant, dof] at the starts of equal parts of a period."""
    coefficients = np.fft.rfft(motion, axis=0) * 2 / len(motion)
    coefficients[0] /= 2
    return [list(enumerate(column[: harmonics + 1])) for column in coefficients.T]


def repeats(now, before, tolerance):
    return before is not None and np.linalg.norm(now - before) <= tolerance * np.linalg.norm(now)


def newmark(scene, case, hertz):
    mass, damping, stiffness = (np.array(scene[name]) for name in ("mass", "damping", "stiffness"))
    law, steps = scene["law"], case["steps"]
    friction = law["type"] == "elastic_coulomb"
    h = 1 / (hertz * steps)
    size = len(mass)
    loads = [scene["force"] * math.cos(2 * math.pi * (step + 1) / steps) for step in range(steps)]
    kernel = stiffness + 2 / h * damping + 4 / h**2 * mass
    # Seen from the first dof the linear part of a step is a spring with a load: one scalar equation a step.
    inverse = np.linalg.inv(kernel)
    compliance = inverse[0, 0]
    first = inverse[:, 0].copy()
    u = np.zeros(size)
    v = np.zeros(size)
    a = np.zeros(size)
    a[-1] = scene["force"] / mass[-1, -1]
    spring = 0.0
    before = None
    for _ in range(MOST):
        now = np.empty((steps, size))
        for step in range(steps):
            right = mass @ (4 / h**2 * u + 4 / h * v + a) + damping @ (2 / h * u + v)
            right[-1] += loads[step]
            free = inverse @ right
            if friction:
                k, limit = law["stiffness"], law["slip_force"]
                trial = (free[0] - u[0] + spring / k) / (compliance + 1 / k)
                force = min(max(trial, -limit), limit)
                spring = force
            else:
                k, force = law["stiffness"], law["stiffness"] * u[0] ** 3
                for _ in range(50):
                    x = free[0] - compliance * force
                    change = (force - k * x**3) / (1 + 3 * k * x * x * compliance)
                    force -= change
                    if abs(change) <= 1e-13 * abs(force):
                        break
            new = free - force * first
            velocity = 2 / h * (new - u) - v
            a = 4 / h**2 * (new - u) - 4 / h * v - a
            u, v = new, velocity
            now[step] = u
        if repeats(now, before, case["tolerance"]):
            return np.roll(now, 1, axis=0)  # the last instant is the first of the next period
        before = now
    return None


def runge_kutta(scene, case, hertz):
    inverse = np.linalg.inv(np.array(scene["mass"]))
    damping, stiffness = np.array(scene["damping"]), np.array(scene["stiffness"])
    law, omega, size = scene["law"], 2 * math.pi * hertz, len(inverse)
    friction = law["type"] == "elastic_coulomb"

    def slope(t, y):
        u, v = y[:size], y[size : 2 * size]
        force = -(damping @ v) - stiffness @ u
        force[-1] += scene["force"] * math.cos(omega * t)
        if friction:
            spring = y[-1]
            force[0] -= spring
            slips = abs(spring) >= law["slip_force"] and spring * v[0] > 0
            change = [0.0 if slips else law["stiffness"] * v[0]]
        else:
            force[0] -= law["stiffness"] * u[0] ** 3
            change = []
        return np.concatenate([v, inverse @ force, change])

    period = 1 / hertz
    instants = np.arange(256) / 256
    state = np.zeros(2 * size + friction)
    # Displacements of a micrometre, velocities of a millimetre a second, forces of a newton.
    scale = np.concatenate([np.full(size, 1e-5), np.full(size, 1e-3), np.ones(int(friction))])
    before = None
    for number in range(MOST):
        start = number * period
        found = solve_ivp(
            slope, (start, start + period), state, method="DOP853", rtol=case["accuracy"],
            atol=case["accuracy"] * scale, t_eval=np.append(start + instants * period, start + period),
            max_step=period / 8,
        )
        if not found.success:
            return None
        state = found.y[:, -1]
        if friction:
            # The limit is passed by the length of a step; the spring's force is never larger.
            state[-1] = min(max(state[-1], -law["slip_force"]), law["slip_force"])
        now = found.y[:size, :-1].T
        # Periods cannot be more alike than they are accurate.
        if repeats(now, before, max(case["tolerance"], 10 * case["accuracy"])):
            return now
        before = now
    return None


METHODS = {"newmark": newmark, "solve_ivp": runge_kutta}


def solve(scene, case):
    method = METHODS[case["method"]]

    def sweep():
        began = exchange.clock()
        motions = [method(scene, case, hertz) for hertz in case["frequencies"]]
        return exchange.clock() - began, motions

    seconds, motions = exchange.repeat(sweep, case)
    points = [
        exchange.point(hertz, None if motion is None else spectra(motion, case["harmonics"]))
        for hertz, motion in zip(case["frequencies"], motions)
    ]
    return case | {"seconds": seconds / len(points), "points": points}


request = exchange.read()
answers = [solve(request["scene"], case) for case in request["cases"]]
exchange.write(["numpy", "scipy"], answers)
