"""Writes exact_orbits.json: exact periodic stick-slip orbits of two scenes; run `python3 exact_orbits.py [--hbm]`.

Needs numpy and scipy. A few seconds; `--hbm` adds a cross-check (nothing stored) of about 20 s.

Model
-----
    M w'' + D w' + C w = f_hat cos(Omega t) e2 - f(t) e1

two masses, `f` the force in an elastic Coulomb element (spring k_t in series with a slider of slip force
F_s = k_t x_c) between the first mass and ground. `f` is the force the element carries; the contact force *on the
mass* is -f, and that is what is stored under "force".

Method
------
Stick and slip are linear systems with harmonic and constant forcing. Each is solved in closed form by the
eigen-decomposition of its 4 x 4 state matrix:

    x(t) = p + Re(Y e^{i Omega t}) + Re(V e^{lambda (t - t_s)} c).

Events, each a root found by bracketing and then polished by Newton to rounding:

    slip of sign s ends        v1 = 0 at t_r
    slip of sign -s begins     w1 - w1(t_r) = -2 s x_c
    slip of sign +s begins     w1 - w1(t_r) = 0, crossed in direction s (re-slip)

An event-driven run from rest approaches the orbit; Newton's method on the half-period map, section "slip of sign s
ends" (unknowns: its instant, w1, w2, v2; v1 = 0 and f = s F_s hold there), then solves x(t + T/2) = -x(t). The
result is propagated over a full period, without use of the symmetry, to measure the closure.

Fourier coefficients are closed-form integrals between events, one-sided, w(t) = Re sum_k W_k e^{ik Omega t}, phase
reference the excitation f_hat cos(Omega t). The force's are those of f' divided by ik Omega (f is continuous), which
keeps relative accuracy in the tail; the displacement's follow from them by W = H_k^-1 F for k >= 3 (k = 1: the
direct closed-form integral of w), and are compared with the direct integrals and with Gauss-Legendre quadrature.

Accuracy (against the same orbits in 30-digit arithmetic): W_1 2e-13 relative or better (R 108, 112 Hz; 2e-15 to 3e-14
elsewhere); harmonics up to 63 2e-12, up to 511 2e-11 relative to themselves; event times 2e-14 of a period.

`--hbm` solves a naive harmonic balance (odd harmonics up to N, element marched over 16384 samples a period) and prints
the relative l2 error of the w1 spectrum, sqrt(sum_k |W_k^N - W_k|^2) / sqrt(sum_k |W_k|^2) over all k, W_k^N = 0 for
k > N; its digits are limited by the sampling (about 1 % of the error at N = 31).
"""

import json
import os
import sys

import numpy as np
from scipy.optimize import brentq

SCENES = {
    "R": {
        "model": {
            "m1": 3.98, "m2": 1.27, "c1": 4.1e5, "c2": 4.1e5, "d": 24.0, "force_on_w2": 9.1,
            "k_t": 6.705e6, "x_c": 2.232e-6,
        },
        "hertz": [57.0, 62.0, 75.0, 100.0, 108.0, 112.0],
        # |W_1| of w1 as tabulated elsewhere (ten digits), for comparison only
        "expected": [2.774688183e-6, 2.943539707e-6, 1.988362982e-5, 2.388795768e-5, 2.781522903e-5, 5.219603747e-6],
        # relative l2 errors of the w1 spectrum at N = 1 and N = 31, for comparison only
        "hbm": [(0.675, 2.55e-5), (4.70, 1.29e-5), (0.090, 5.4e-6), (0.032, 2.9e-6), (0.046, 4.0e-6), (0.58, 5.9e-6)],
    },
    "P": {
        "model": {
            "m1": 1.0, "m2": 1.0, "c1": 190000.0, "c2": 190000.0, "d": 2.0, "force_on_w2": 3.0,
            "k_t": 60000.0, "x_c": 1.0 / 60000.0,
        },
        "hertz": [40.0, 55.0, 60.0, 108.0, 118.0],
        "expected": [1.166768192e-4, 3.591562365e-5, 2.509777370e-5, 1.945075923e-5, 3.460092910e-5],
        "hbm": None,
    },
}
K_MAX = 511  # computed
K_W1, K_W2, K_FORCE = 511, 127, 127  # stored


class Scene:
    """Matrices, eigen-decompositions and propagation of one scene at one frequency."""

    def __init__(self, model, hertz):
        self.omega = 2.0 * np.pi * hertz
        self.period = 1.0 / hertz
        self.k_t, self.x_c = model["k_t"], model["x_c"]
        self.f_s = self.k_t * self.x_c
        self.f_hat = model["force_on_w2"]
        c1, c2 = model["c1"], model["c2"]
        self.m = np.diag([model["m1"], model["m2"]])
        self.d = model["d"] * np.eye(2)
        self.c = np.array([[c1 + c2, -c2], [-c2, c2]])
        self.systems = {"slip": self._system(0.0), "stick": self._system(self.k_t)}

    def _system(self, k):
        m_inv = np.linalg.inv(self.m)
        c = self.c + np.diag([k, 0.0])
        a = np.block([[np.zeros((2, 2)), np.eye(2)], [-m_inv @ c, -m_inv @ self.d]])
        lam, v = np.linalg.eig(a)
        v_inv = np.linalg.inv(v)
        # one Newton step on the inverse removes what rounding the factorisation left
        v_inv = v_inv @ (2.0 * np.eye(4) - v @ v_inv)
        h = c - self.omega**2 * self.m + 1j * self.omega * self.d
        w = np.linalg.solve(h, np.array([0.0, self.f_hat]))
        y = np.concatenate([w, 1j * self.omega * w])
        unit = np.linalg.solve(c, np.array([1.0, 0.0]))  # static answer to a unit force on w1
        return {"lam": lam, "v": v, "v_inv": v_inv, "y": y, "unit": unit, "k": k}

    def segment(self, mode, t0, x0, f0):
        """Closed form from t0 on: force f0 there; `stick` adds k_t (w1 - w1(t0)), `slip` holds it."""
        s = self.systems[mode]
        constant = -(f0 - s["k"] * x0[0])
        p = np.concatenate([constant * s["unit"], [0.0, 0.0]])
        c = s["v_inv"] @ (x0 - p - np.real(s["y"] * np.exp(1j * self.omega * t0)))
        return Segment(self, mode, s, t0, f0, x0, p, c)

    def dynamic_stiffness(self, k):
        return self.c - (k * self.omega) ** 2 * self.m + 1j * k * self.omega * self.d


class Segment:
    def __init__(self, scene, mode, s, t0, f0, x0, p, c):
        self.scene, self.mode, self.s, self.t0, self.f0, self.x0, self.p, self.c = scene, mode, s, t0, f0, x0, p, c
        self.t1 = None

    def state(self, t):
        t = np.atleast_1d(np.asarray(t, dtype=float))
        e = np.exp(np.outer(self.s["lam"], t - self.t0)) * self.c[:, None]
        forced = np.real(self.s["y"][:, None] * np.exp(1j * self.scene.omega * t)[None, :])
        return self.p[:, None] + forced + np.real(self.s["v"] @ e)

    def at(self, t):
        return self.state(t)[:, 0]

    def force(self, t):
        t = np.atleast_1d(np.asarray(t, dtype=float))
        if self.mode == "slip":
            return np.full(t.shape, self.f0)
        return self.f0 + self.s["k"] * (self.state(t)[0] - self.x0[0])

    def acceleration(self, t):
        f = self.force(t)[0]
        x = self.at(t)
        sc = self.scene
        rhs = np.array([-f, sc.f_hat * np.cos(sc.omega * t)]) - sc.c @ x[:2] - sc.d @ x[2:]
        return rhs / np.diag(sc.m)

    def root_velocity(self, a, b):
        t = brentq(lambda q: self.at(q)[2], a, b, xtol=1e-18, rtol=8.9e-16)
        for _ in range(2):
            t -= self.at(t)[2] / self.acceleration(t)[0]
        return t

    def root_displacement(self, level, a, b):
        t = brentq(lambda q: self.at(q)[0] - level, a, b, xtol=1e-18, rtol=8.9e-16)
        for _ in range(2):
            x = self.at(t)
            if abs(x[2]) > 0.0:
                t -= (x[0] - level) / x[2]
        return t


SAMPLES = 600  # a period, for bracketing only


def next_event(seg, sign):
    """First event of `seg`. `sign`: of the slip (mode slip) or of the slip that ended (mode stick).

    Returns (kind, t); t stored as the segment's end too."""
    sc = seg.scene
    step = sc.period / SAMPLES
    block = 200
    # a stick phase starts at v1 = 0 and f = sign F_s: leave that root behind by a small step
    t = seg.t0
    first = True
    while t < seg.t0 + 3.0 * sc.period:
        grid = t + step * np.arange(block + 1)
        if first:  # resolve very short phases
            grid = np.concatenate([seg.t0 + step * np.geomspace(1e-5, 0.5, 40), grid[1:]])
            first = False
        x = seg.state(grid)
        v = sign * x[2]
        if seg.mode == "slip":
            hit = np.nonzero(v <= 0.0)[0]
            if hit.size:
                i = hit[0]
                seg.t1 = seg.root_velocity(grid[i - 1], grid[i]) if i else grid[0]
                return "stick", seg.t1
        else:
            # extremes between samples become nodes, so that no short excursion is missed
            turns = np.nonzero(v[:-1] * v[1:] < 0.0)[0]
            extra = [seg.root_velocity(grid[i], grid[i + 1]) for i in turns]
            grid = np.sort(np.concatenate([grid, extra]))
            h = sign * (seg.state(grid)[0] - seg.x0[0])  # 0 at start, negative inside, -2 x_c at the other limit
            low = np.nonzero(h < -2.0 * sc.x_c)[0]
            # the start itself (h = 0 up to rounding) does not count: w1 must have turned round first
            returning = np.logical_or.accumulate(sign * seg.state(grid)[2] > 0.0)
            high = np.nonzero((h > 0.0) & returning)[0]
            i_low = low[0] if low.size else grid.size
            i_high = high[0] if high.size else grid.size
            if min(i_low, i_high) < grid.size:
                i = min(i_low, i_high)
                assert i > 0, "stick phase does not start into the elastic range"
                level = seg.x0[0] + (sign * -2.0 * sc.x_c if i == i_low else 0.0)
                seg.t1 = seg.root_displacement(level, grid[i - 1], grid[i])
                return ("reverse" if i == i_low else "again"), seg.t1
        t = grid[-1]
    return "none", None


def run(scene, t0, x0, sign, events=None, until=None):
    """Event-driven propagation from the end of a slip of sign `sign`. Lists (segment, sign, kind at its end)."""
    out = []
    mode, t, x, f = "stick", t0, x0, sign * scene.f_s
    while (events is None or len(out) < events) and (until is None or t < until):
        seg = scene.segment(mode, t, x, f)
        kind, te = next_event(seg, sign)
        if kind == "none":
            return out, None
        x = seg.at(te)
        out.append((seg, sign, kind))
        t = te
        if kind == "stick":
            mode = "stick"
            x[2] = 0.0
            f = sign * scene.f_s
        else:
            if kind == "reverse":
                sign = -sign
            mode = "slip"
            f = sign * scene.f_s
    return out, (t, x, sign)


def start_from_rest(scene, periods):
    """Transient: rest, element unloaded; returns a slip end near the orbit and the events a half period."""
    # a first stick phase with f = 0: treat as one that ended a slip of sign +1 displaced by x_c
    seg = scene.segment("stick", 0.0, np.zeros(4), 0.0)
    ts = np.linspace(0.0, 20 * scene.period, 20 * SAMPLES)
    w = seg.state(ts)[0]
    i = np.nonzero(np.abs(w) > scene.x_c)[0][0]
    sign = float(np.sign(w[i]))
    t = seg.root_displacement(sign * scene.x_c, ts[i - 1], ts[i])
    slip = scene.segment("slip", t, seg.at(t), sign * scene.f_s)
    _, te = next_event(slip, sign)
    x = slip.at(te)
    x[2] = 0.0
    segs, (t, x, sign) = run(scene, te, x, sign, until=periods * scene.period)
    # go to a slip end that follows a phase of stick ended by `reverse` (one a half period, also with re-slips)
    kinds = []
    for _ in range(40):
        if kinds and kinds[-1] == "stick" and len(kinds) >= 2 and kinds[-2] == "reverse":
            break
        mode = "stick" if not kinds and segs[-1][2] == "stick" else None
        if mode is None and not kinds:  # the run stopped at the begin of slip: finish that slip
            slip = scene.segment("slip", t, x, sign * scene.f_s)
            _, t = next_event(slip, sign)
            x = slip.at(t)
            x[2] = 0.0
            kinds.append("stick")
            continue
        more, (t, x, sign) = run(scene, t, x, sign, events=2)
        kinds += [m[2] for m in more]
    # count the events of a half period
    more, _ = run(scene, t, x, sign, until=t + 0.5 * scene.period * (1 + 1e-3))
    n = 0
    for j, (seg, sg, kind) in enumerate(more):
        if kind == "stick" and abs(seg.t1 - t - 0.5 * scene.period) < 1e-2 * scene.period:
            n = j + 1
    assert n, "no half-period symmetry in sight"
    return t, x, sign, n


def residual(scene, u, sign, n, scale, half=True):
    """Closure of the half-period map (x -> -x) or of the period map in the unknowns (t0, w1, w2, v2)."""
    t0 = u[0] * scale[0]
    x = np.array([u[1] * scale[1], u[2] * scale[2], 0.0, u[3] * scale[3]])
    segs, (t, xe, se) = run(scene, t0, x, sign, events=n if half else 2 * n)
    assert segs[-1][2] == "stick" and se == (-sign if half else sign)
    if half:
        r = np.array([t - t0 - 0.5 * scene.period, xe[0] + x[0], xe[1] + x[1], xe[3] + x[3]])
    else:
        r = np.array([t - t0 - scene.period, xe[0] - x[0], xe[1] - x[1], xe[3] - x[3]])
    return r / scale, segs


def shoot(scene):
    t, x, sign, n = start_from_rest(scene, 60)
    t -= scene.period * np.floor(t / scene.period)
    wmax = max(abs(x[0]), abs(x[1]))
    scale = np.array([scene.period, abs(x[0]), wmax, wmax * scene.omega])
    u = np.array([t, x[0], x[1], x[3]]) / scale
    best = None
    for _ in range(40):
        r, _ = residual(scene, u, sign, n, scale)
        size = np.max(np.abs(r))
        if best is None or size < best[0]:
            best, stalled = (size, u.copy()), 0
        else:
            stalled += 1
        if stalled >= 4:
            break
        jac = np.empty((4, 4))
        for j in range(4):
            h = 1e-6
            e = np.zeros(4)
            e[j] = h
            jac[:, j] = (residual(scene, u + e, sign, n, scale)[0] - residual(scene, u - e, sign, n, scale)[0]) / (2 * h)
        u = u - np.linalg.solve(jac, r)
    half, u = best
    full, segs = residual(scene, u, sign, n, scale, half=False)
    return segs, half, np.max(np.abs(full)), 2 * n


def expint(z, t0, t1):
    """integral of e^{z t} from t0 to t1, stable for small z (t1 - t0)."""
    h = t1 - t0
    y = z * h
    small = np.abs(y) < 1e-5
    ys = np.where(small, 1.0, y)
    core = np.where(small, 1.0 + y / 2.0 + y * y / 6.0, (np.exp(ys) - 1.0) / ys)
    return np.exp(z * t0) * h * core


def spectrum(scene, segs, weights, kinds=("slip", "stick")):
    """One-sided coefficients k = 0..K_MAX of weights . x over the segments of the given modes, closed form."""
    k = np.arange(K_MAX + 1)
    q = -1j * k * scene.omega
    total = np.zeros(K_MAX + 1, dtype=complex)
    for seg, _, _ in segs:
        if seg.mode not in kinds:
            continue
        a, b = seg.t0, seg.t1
        total += (weights @ seg.p) * expint(q, a, b)
        y = weights @ seg.s["y"]
        total += 0.5 * y * expint(q + 1j * scene.omega, a, b) + 0.5 * np.conj(y) * expint(q - 1j * scene.omega, a, b)
        for j in range(4):
            # Re over a conjugate pair: the sum over all four eigenvalues is already real
            lam = seg.s["lam"][j]
            amp = (weights @ seg.s["v"][:, j]) * seg.c[j]
            total += amp * np.exp(q * a) * expint(lam + q, 0.0, b - a)
    total *= 2.0 / scene.period
    total[0] *= 0.5
    return total


def quadrature(scene, segs, value, k_max, nodes=24):
    """The same by Gauss-Legendre panels between events; `value(seg, t)`."""
    z, wt = np.polynomial.legendre.leggauss(nodes)
    k = np.arange(k_max + 1)
    total = np.zeros(k_max + 1, dtype=complex)
    for seg, _, _ in segs:
        panels = max(2, int(np.ceil((seg.t1 - seg.t0) / scene.period * k_max)))
        edges = np.linspace(seg.t0, seg.t1, panels + 1)
        mid, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * (edges[1:] - edges[:-1])
        t = (mid[:, None] + half[:, None] * z[None, :]).ravel()
        w = (half[:, None] * wt[None, :]).ravel()
        total += np.exp(-1j * scene.omega * np.outer(k, t)) @ (w * value(seg, t))
    total *= 2.0 / scene.period
    total[0] *= 0.5
    return total


def solve_point(scene):
    segs, half, full, events = shoot(scene)
    k = np.arange(K_MAX + 1)
    e = np.eye(4)
    # carried force f: f' = k_t v1 while sticking, 0 while slipping
    rate = scene.k_t * spectrum(scene, segs, e[2], kinds=("stick",))
    force = np.zeros(K_MAX + 1, dtype=complex)
    force[1:] = -rate[1:] / (1j * k[1:] * scene.omega)  # contact force on the mass
    w = np.zeros((2, K_MAX + 1), dtype=complex)
    for q in range(1, K_MAX + 1, 2):
        rhs = np.array([force[q], scene.f_hat if q == 1 else 0.0])
        w[:, q] = np.linalg.solve(scene.dynamic_stiffness(q), rhs)
    direct = [spectrum(scene, segs, e[i]) for i in (0, 1)]
    quad = quadrature(scene, segs, lambda s, t: s.state(t)[0], 127)
    quad_f = quadrature(scene, segs, lambda s, t: -s.force(t), 127)
    solved = w[:, 1].copy()
    w[:, 1] = direct[0][1], direct[1][1]  # near a resonance the direct integral is the more accurate for k = 1
    odd = k % 2 == 1
    checks = {
        "closure_half_period": half,
        "closure_period": full,
        "w1_balance_k1": np.abs(solved[0] - w[0, 1]) / np.abs(w[0, 1]),
        "w1_direct_rest": np.max(np.abs(direct[0] - w[0])[2:]) / np.abs(w[0, 1]),
        "w2_direct_rest": np.max(np.abs(direct[1] - w[1])[2:]) / np.abs(w[1, 1]),
        "w1_quadrature": np.max(np.abs(quad - w[0, :128])) / np.abs(w[0, 1]),
        "force_quadrature": np.max(np.abs(quad_f[1:] - force[1:128])[odd[1:128]]) / np.abs(force[1]),
        "even": np.max(np.abs(direct[0][~odd])) / np.abs(w[0, 1]),
    }
    # energy a cycle: friction work from slip distances, damping work by quadrature, input work from W_1 of w2
    friction = sum(scene.f_s * abs(s.at(s.t1)[0] - s.x0[0]) for s, _, _ in segs if s.mode == "slip")
    viscous = quadrature(scene, segs, lambda s, t: scene.d[0, 0] * (s.state(t)[2] ** 2 + s.state(t)[3] ** 2), 2)
    viscous = viscous[0].real * scene.period
    supplied = np.pi * scene.f_hat * -w[1, 1].imag
    harmonics = np.pi * np.sum(k[odd] * np.imag(np.conj(force[odd]) * w[0][odd]))
    checks["energy"] = (supplied - viscous - friction) / supplied
    checks["friction_harmonics"] = (harmonics - friction) / friction
    return segs, force, w, events, friction, viscous, supplied, checks


# ---- cross-check: naive harmonic balance ------------------------------------------------------------------------


def jenkins_sampled(scene, w1):
    """Force carried over one period of samples (columns: independent motions), two passes from an unloaded start."""
    f = np.zeros(w1.shape[1])
    out = np.empty_like(w1)
    last = w1[-1]
    for _ in range(2):
        for j in range(w1.shape[0]):
            f = np.clip(f + scene.k_t * (w1[j] - last), -scene.f_s, scene.f_s)
            last = w1[j]
            out[j] = f
    return out


def naive_hbm(scene, n, start, samples=16384):
    ks = np.arange(1, n + 1, 2)
    m = ks.size
    tau = 2.0 * np.pi * np.arange(samples) / samples
    basis = np.exp(1j * np.outer(tau, ks))
    g = [np.linalg.inv(scene.dynamic_stiffness(q)) for q in ks]
    g11 = np.array([x[0, 0] for x in g])
    free = np.where(ks == 1, np.array([x[0, 1] for x in g]) * scene.f_hat, 0.0)
    scale = scene.x_c

    def res(u):
        big = (u[:m] + 1j * u[m:]) * scale
        f = jenkins_sampled(scene, np.real(basis @ big))
        fk = 2.0 / samples * (basis.conj().T @ f)
        r = (big - free[:, None] + g11[:, None] * fk) / scale
        return np.concatenate([r.real, r.imag])

    u = np.concatenate([start.real, start.imag]) / scale
    for _ in range(30):
        h = 1e-6
        columns = np.concatenate([u[:, None], u[:, None] + h * np.eye(2 * m)], axis=1)
        r = res(columns)
        jac = (r[:, 1:] - r[:, :1]) / h
        size = np.max(np.abs(r[:, 0]))
        if size < 1e-9:
            break
        step = -np.linalg.solve(jac, r[:, 0])
        tries = u[:, None] + step[:, None] * 0.5 ** np.arange(8)[None, :]
        rr = np.max(np.abs(res(tries)), axis=0)
        u = tries[:, np.argmin(rr)]
    w = np.zeros(K_MAX + 1, dtype=complex)
    w[ks] = (u[:m] + 1j * u[m:]) * scale
    return w, size


def main():
    hbm = "--hbm" in sys.argv[1:]
    result = {}
    for name, spec in SCENES.items():
        points = []
        for i, hertz in enumerate(spec["hertz"]):
            scene = Scene(spec["model"], hertz)
            segs, force, w, events, friction, viscous, supplied, checks = solve_point(scene)
            a = abs(w[0, 1])
            short = {key: float(f"{value:.2g}") for key, value in checks.items()}
            print(f"{name} {hertz:5.0f} Hz  |W_1| {a:.10e}  table {spec['expected'][i]:.9e}  "
                  f"rel. difference {a / spec['expected'][i] - 1.0:+.1e}  events {events}\n      {short}")
            assert abs(a / spec["expected"][i] - 1.0) < 5.1e-10, "tabulated digits"
            assert checks["closure_period"] < 1e-12
            if hbm and spec["hbm"]:
                norm = np.sqrt(np.sum(np.abs(w[0]) ** 2))
                line = []
                for n, want in zip((1, 31), spec["hbm"][i]):
                    start = w[0, 1 : n + 1 : 2]
                    big, size = naive_hbm(scene, n, start)
                    line.append(f"N = {n}: {np.sqrt(np.sum(np.abs(big - w[0]) ** 2)) / norm:.3e} (table {want:g}; residual {size:.0e})")
                print("      relative l2 error of w1:", "; ".join(line))

            def rows(z, k_max):
                return [[q, float(z[q].real), float(z[q].imag)] for q in range(1, k_max + 1, 2)]

            points.append({
                "hertz": hertz, "events": events, "dissipation": float(friction), "viscous": float(viscous),
                "supplied": float(supplied), "event_times": [float(s.t0) for s, _, _ in segs],
                "event_kinds": [{"stick": "slip_ends", "reverse": "slip_begins", "again": "slip_resumes"}[
                    segs[j - 1][2]] for j in range(len(segs))],
                "closure": float(checks["closure_period"]),
                "w1": rows(w[0], K_W1), "w2": rows(w[1], K_W2), "force": rows(force, K_FORCE),
            })
        result[name] = {"model": spec["model"], "points": points}
    about = ("One-sided amplitudes, w(t) = Re sum W_k exp(ik Omega t), rows [k, re, im], SI units; excitation "
             "force_on_w2 * cos(Omega t) on w2; force is the contact force on w1 (opposes motion); dissipation, viscous, "
             "supplied: J per cycle. Written by exact_orbits.py.")
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "exact_orbits.json")
    with open(path, "w") as out:
        out.write('{\n"about": ' + json.dumps(about))
        for name, scene in result.items():
            out.write(f',\n"{name}": {{\n"model": {json.dumps(scene["model"])},\n"points": [')
            for j, p in enumerate(scene["points"]):
                out.write((",\n" if j else "\n") + dump(p))
            out.write("\n]}")
        out.write("\n}\n")
    print(path, os.path.getsize(path), "bytes")


def dump(value):
    """JSON with 17 significant digits."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)}: {dump(v)}" for key, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(dump(v) for v in value) + "]"
    if isinstance(value, float):
        return f"{value:.17g}"
    return json.dumps(value)


if __name__ == "__main__":
    main()
