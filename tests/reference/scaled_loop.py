"""Writes scaled_loop.json: the scaled hysteresis law, one and many harmonics; run `python3 scaled_loop.py`.

Needs numpy and scipy. A few minutes.

Sections of the file (SI units unless said otherwise; complex numbers as [re, im]; one-sided amplitudes,
w(t) = Re sum_k W_k e^{ik tau}, tau = Omega t):

law     the monoharmonic law F_contact,1 = F* g(alpha) e^{i(psi(alpha) + arg W_1)}, g = 0.98 + 0.21 ln(alpha + 0.01),
        psi = -pi/2 - (7/15) pi e^{-4 alpha}, alpha = |W_1| / W*, tabulated.
single  N = 1 on a two-mass model: all roots of phi(a) = a |1 + G_11 k(a)| - |G_12 f_hat|.
forces  the measured force f over one period for given displacement spectra, by the loop law below.
balance N = 3 and N = 7 harmonic balance of the two-mass model with the loop law, three odd loops (odd harmonics;
        also started from, and checked in, all harmonics 0..N). More than one solution: rows `solution` 0, 1, ...

Loop law. a = half the range of w over the period, alpha = a / W*,

    L(theta) = Re sum_k c_k e^{ik theta},  c_1 = -g(alpha) F* e^{i psi(alpha)},  c_k = sigma F*_k,
    sigma = Im c_1 / Im F*_1,  F* = |F*_1|.

Unloading branches drop by D(x) = L(0) - L(arccos(1 - x/a)) over the distance x from the point where they began,
reloading branches rise by U(x) = L(-arccos(-1 + x/a)) - L(pi); for an odd loop U = D. Memory is a stack of reversal
points in time order, begun at the first global maximum: a reversal pushes its point; when w comes back to the level
of the point below the top, the two top points are dropped (that minor loop is closed and forgotten) and the branch
that was interrupted goes on.

Loops that are not odd: a reloading branch of a minor loop of range x0 is U(x) D(x0) / U(x0), so that the loop
closes; a reversal is the second tip of the open minor loop if w reaches the loop's first tip before it comes back to
the level of the reversal, else it opens a loop of its own. This is one reading of "the reloading branch is scaled so
that it closes"; only the spectrum marked "reading": true depends on it.

Two evaluations are compared: `Pieces` (turning points and closure instants as roots to rounding, Gauss-Legendre
quadrature between them; what is stored) and `literal` (state machine stepping through 2^16 samples a period and
the turning points).
"""

import json
import os

import numpy as np
from scipy.optimize import brentq, minimize_scalar, root

W_STAR = 8e-6
LOOP = {
    1: 12.0 * np.exp(1j * 0.4914 * np.pi),
    3: 0.6 + 2.3j,
    5: 0.3 + 0.8j,
    7: 0.1 + 0.3j,
}
LOOP_UNEVEN = dict(LOOP)
LOOP_UNEVEN.update({2: 0.5 - 0.35j, 4: -0.2 + 0.15j})
# two loops whose balance has interior reversals: an elastic Coulomb loop of x_c = 0.28 W* (harmonics 3, 5, 7, rounded)
# and one with strong, mostly dissipative harmonics
LOOP_ELASTIC = {1: LOOP[1], 3: 2.36 - 1.83j, 5: -0.68 - 0.66j, 7: 0.01 + 0.35j}
LOOP_SHARP = {1: LOOP[1], 3: 1.1 + 3.4j, 5: 0.9 + 1.7j, 7: 0.6 + 0.9j}
LOOPS = {"odd": LOOP, "elastic": LOOP_ELASTIC, "sharp": LOOP_SHARP, "uneven": LOOP_UNEVEN}
F_STAR = 12.0
MODEL = {"m1": 4.0, "m2": 1.27, "c1": 4.1e5, "c2": 4.1e5, "d": 24.0, "force_on_w2": 9.1}


def g(alpha):
    return 0.98 + 0.21 * np.log(alpha + 0.01)


def psi(alpha):
    return -np.pi / 2.0 - 7.0 / 15.0 * np.pi * np.exp(-4.0 * alpha)


def contact_first(w1):
    """F_contact,1 of W_1, force on the mass."""
    alpha = abs(w1) / W_STAR
    return F_STAR * g(alpha) * np.exp(1j * (psi(alpha) + np.angle(w1)))


# ---- loop law ---------------------------------------------------------------------------------------------------


class Loop:
    """The loop at one alpha: drops D and rises U, without cancellation at small distances."""

    def __init__(self, record, a):
        alpha = a / W_STAR
        self.a = a
        self.k = np.array(sorted(record))
        c1 = -g(alpha) * F_STAR * np.exp(1j * psi(alpha))
        sigma = c1.imag / record[1].imag
        self.c = np.array([c1 if k == 1 else sigma * record[k] for k in self.k])

    def value(self, theta):
        return np.real(np.exp(1j * np.multiply.outer(theta, self.k)) @ self.c)

    def difference(self, start, delta):
        """L(start + delta) - L(start)."""
        h = np.multiply.outer(np.asarray(delta) / 2.0, self.k)
        return np.real((2j * np.sin(h) * np.exp(1j * h)) @ (self.c * np.exp(1j * self.k * start)))

    def angle(self, x):
        """arccos(1 - x/a)."""
        return 2.0 * np.arcsin(np.sqrt(np.clip(x / (2.0 * self.a), 0.0, 1.0)))

    def drop(self, x):
        return -self.difference(0.0, self.angle(x))

    def rise(self, x):
        # -arccos(-1 + x/a) = -pi + angle(x): from -pi upwards
        return self.difference(-np.pi, self.angle(x))

    def drop_at(self, phase):
        return -self.difference(0.0, phase)

    def rise_at(self, phase):
        return self.difference(-np.pi, phase)


class Motion:
    """A trigonometric polynomial, its turning points in time order from the first global maximum on."""

    def __init__(self, coefficients, samples=4096):
        self.w = np.asarray(coefficients, dtype=complex)
        self.k = np.arange(self.w.size)
        e = np.exp(2j * np.pi * np.outer(np.arange(samples) / samples, self.k))
        v = np.real(e @ (1j * self.k * self.w))
        i = np.nonzero(np.sign(v) * np.sign(np.roll(v, -1)) <= 0.0)[0]
        lo = 2.0 * np.pi * i / samples
        hi = lo + 2.0 * np.pi / samples
        t = 0.5 * (lo + hi)
        # a trigonometric polynomial is resolved by this grid: bisection, then Newton
        flo = np.sign(v[i])
        for _ in range(12):
            s = np.sign(self.derivative(t, 1))
            lo, hi = np.where(s == flo, t, lo), np.where(s == flo, hi, t)
            t = 0.5 * (lo + hi)
        for _ in range(4):
            second = self.derivative(t, 2)
            step = np.where(second != 0.0, -self.derivative(t, 1) / np.where(second != 0.0, second, 1.0), 0.0)
            t = np.clip(t + step, lo, hi)
        order = np.argsort(t)
        t = t[order]
        level = self.derivative(t, 0)
        keep = np.concatenate([[True], np.diff(t) > 1e-13])
        t, level = t[keep], level[keep]
        top = np.argmax(level)
        t = np.concatenate([t[top:], t[:top] + 2.0 * np.pi, [t[top] + 2.0 * np.pi]])
        level = np.concatenate([level[top:], level[:top], [level[top]]])
        self.turn, self.level = t, level
        assert t.size % 2 == 1, "maxima and minima alternate"
        self.bottom = int(np.argmin(level))
        self.half_range = 0.5 * (level[0] - level[self.bottom])
        # the range without cancellation is the same; W_0 drops out
        self.anchor = [self.w * np.exp(1j * self.k * q) for q in t]

    def derivative(self, t, n):
        return np.real(np.exp(1j * np.multiply.outer(t, self.k)) @ ((1j * self.k) ** n * self.w))

    def away(self, t, i):
        """|w(t) - w(turning point i)| from the time difference, relative accuracy kept near the turning point."""
        delta = np.asarray(t) - self.turn[i]
        delta = delta - 2.0 * np.pi * np.round(delta / (2.0 * np.pi))
        x = np.multiply.outer(delta, self.k)
        small = np.abs(x) < 0.3
        y = np.where(small, x, 0.0)
        series = y**3 * (-1 / 6 + y**2 * (1 / 120 + y**2 * (-1 / 5040 + y**2 * (1 / 362880 - y**2 / 39916800))))
        sin_minus = np.where(small, series, np.sin(x) - x)
        return np.abs(np.real((-2.0 * np.sin(x / 2.0) ** 2 + 1j * sin_minus) @ self.anchor[i]))


class Pieces:
    """The force as analytic pieces: for each (t0, t1): branch begun at turning point `i`, its force, its scale."""

    def __init__(self, record, coefficients):
        self.m = m = Motion(coefficients)
        self.loop = Loop(record, m.half_range)
        self.pieces = []
        self.closures = 0
        self.depth = 0
        tip = float(self.loop.value(np.array(0.0)))
        stack = [(0, tip, 1.0)]
        n = m.turn.size
        for j in range(n - 1):
            down = m.level[j + 1] < m.level[j]
            if j > 0:
                f = float(self._force(m.turn[j], stack[-1], not down, j))
                stack.append((j, f, self._scale(j, stack)))
                # main loop: M, m are not minor loops
                base = 2 if j >= m.bottom else 1
                self.depth = max(self.depth, (len(stack) - base + 1) // 2)
            t = m.turn[j]
            target = m.level[j + 1]
            while len(stack) >= 3:
                level = m.level[stack[-2][0]]
                if (target < level) if down else (target > level):
                    s = brentq(lambda q: float(m.derivative(q, 0)) - level, t, m.turn[j + 1], xtol=1e-15, rtol=1e-15)
                    self.pieces.append((t, s, stack[-1], down))
                    del stack[-2:]
                    self.closures += 1
                    t = s
                else:
                    break
            self.pieces.append((t, m.turn[j + 1], stack[-1], down))
        self.jump = max(
            abs(float(self.force(p[1], p)) - float(self.force(q[0], q)))
            for p, q in zip(self.pieces, self.pieces[1:] + self.pieces[:1])
        )

    def _scale(self, j, stack):
        """Factor of the branch that begins at turning point j (one for unloading, for the main loop, for odd loops)."""
        m = self.m
        if j == m.bottom or m.level[j + 1] < m.level[j] or not np.any(self.loop.k % 2 == 0):
            return 1.0
        # reloading: down to the level of j again, or first up to the open loop's first tip?
        first = m.level[stack[-1][0]] if len(stack) > 1 else np.inf  # the tip M belongs to the main loop
        best = m.level[j]
        for i in range(j + 1, m.turn.size):
            if m.level[i] >= first:
                best = first
                break
            if m.level[i] <= m.level[j]:
                break
            best = max(best, m.level[i])
        x0 = best - m.level[j]
        return float(self.loop.drop(x0) / self.loop.rise(x0))

    def _force(self, t, entry, down, end):
        """Force on the branch of `entry` at t; `end`: index of the turning point where the piece ends, or None."""
        m, loop = self.m, self.loop
        i, f0, scale = entry
        x = m.away(t, i)
        phase = loop.angle(x)
        # the far end of a main branch: the angle from the opposite tip
        other = m.bottom if i == 0 else (0 if i == m.bottom else None)
        if other is not None:
            phase = np.where(x > m.half_range, np.pi - loop.angle(m.away(t, other)), phase)
        return f0 - loop.drop_at(phase) if down else f0 + scale * loop.rise_at(phase)

    def force(self, t, piece):
        return self._force(t, piece[2], piece[3], None)

    def at(self, t):
        """Force at arbitrary phases."""
        out = np.empty(len(t))
        start = self.m.turn[0]
        for n, q in enumerate(t):
            q = start + (q - start) % (2.0 * np.pi)
            for p in self.pieces:
                if p[0] <= q <= p[1]:
                    out[n] = self.force(q, p)
                    break
        return out

    def harmonics(self, k_max, panels=3, nodes=28):
        z, wt = gauss(nodes)
        k = np.arange(k_max + 1)
        total = np.zeros(k_max + 1, dtype=complex)
        for p in self.pieces:
            edges = np.linspace(p[0], p[1], panels + 1)
            mid, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * (edges[1:] - edges[:-1])
            t = (mid[:, None] + half[:, None] * z).ravel()
            total += np.exp(-1j * np.outer(k, t)) @ ((half[:, None] * wt).ravel() * self.force(t, p))
        total /= np.pi
        total[0] = 0.5 * total[0].real
        return total


GAUSS = {}


def gauss(n):
    if n not in GAUSS:
        GAUSS[n] = np.polynomial.legendre.leggauss(n)
    return GAUSS[n]


def literal(record, coefficients, samples=2**16):
    """State machine on samples and turning points in time order, odd loops only. Force at 2 pi j / samples."""
    m = Motion(coefficients)
    a = m.half_range
    loop = Loop(record, a)
    start = m.turn[0]
    grid = 2.0 * np.pi * np.arange(samples) / samples
    t = np.concatenate([start + (grid - start) % (2.0 * np.pi), m.turn])
    tag = np.concatenate([np.arange(samples), np.full(m.turn.size, -1)])
    order = np.argsort(t, kind="stable")
    t, tag = t[order], tag[order]
    w = m.derivative(t, 0)
    w[tag < 0] = m.level
    top = w[0]
    f_top = float(loop.value(np.array(0.0)))
    ks, cs = loop.k, loop.c

    def drop(x):
        theta = np.arccos(max(-1.0, min(1.0, 1.0 - x / a)))
        return f_top - float(np.real(np.exp(1j * ks * theta) @ cs))

    stack = [(top, f_top)]
    down = True
    force = np.empty(samples)
    f_last, w_last = f_top, top
    for n in range(1, t.size):
        now_down = w[n] < w_last if w[n] != w_last else down
        if now_down != down:
            stack.append((w_last, f_last))
            down = now_down
        while len(stack) >= 3 and (w[n] <= stack[-2][0] if down else w[n] >= stack[-2][0]):
            del stack[-2:]
        w0, f0 = stack[-1]
        f_last = f0 - drop(w0 - w[n]) if down else f0 + drop(w[n] - w0)
        w_last = w[n]
        if tag[n] >= 0:
            force[tag[n]] = f_last
    if tag[0] >= 0:
        force[tag[0]] = f_top
    return force


# ---- two-mass model ---------------------------------------------------------------------------------------------


def receptance(hertz, k):
    om = 2.0 * np.pi * hertz * k
    c1, c2 = MODEL["c1"], MODEL["c2"]
    h = np.array([[c1 + c2, -c2], [-c2, c2]], dtype=complex)
    h -= om**2 * np.diag([MODEL["m1"], MODEL["m2"]])
    h += 1j * om * MODEL["d"] * np.eye(2)
    return np.linalg.inv(h)


def single(hertz):
    """All N = 1 solutions: (W_1 of w1, W_1 of w2), and whether the stuck state exists."""
    gr = receptance(hertz, 1)
    free = gr[0, 1] * MODEL["force_on_w2"]

    def stiffness(a):
        return -contact_first(complex(a)) / a

    def phi(a):
        return a * abs(1.0 + gr[0, 0] * stiffness(a)) - abs(free)

    grid = np.geomspace(1e-14, 1e-1, 6001)
    values = np.array([phi(a) for a in grid])
    nodes = list(grid)
    for i in range(1, grid.size - 1):
        if (values[i] - values[i - 1]) * (values[i + 1] - values[i]) < 0.0:
            sign = 1.0 if values[i] < values[i - 1] else -1.0
            best = minimize_scalar(lambda q: sign * phi(np.exp(q)), bounds=(np.log(grid[i - 1]), np.log(grid[i + 1])),
                                   method="bounded", options={"xatol": 1e-12})
            nodes.append(np.exp(best.x))
    nodes = np.sort(nodes)
    values = np.array([phi(a) for a in nodes])
    found = []
    for i in np.nonzero(values[:-1] * values[1:] < 0.0)[0]:
        a = brentq(phi, nodes[i], nodes[i + 1], xtol=1e-24, rtol=8.9e-16)
        w1 = free / (1.0 + gr[0, 0] * stiffness(a))
        w2 = gr[1, 1] * MODEL["force_on_w2"] + gr[1, 0] * contact_first(w1)
        found.append((w1, w2))
    stuck = abs(free) <= abs(gr[0, 0]) * F_STAR * g(0.0)
    return found, bool(stuck)


class Balance:
    def __init__(self, hertz, n, odd=True, record=None):
        self.record = record or LOOP
        self.quality = (3, 28)  # panels, nodes
        self.n = n
        self.ks = np.arange(1, n + 1, 2) if odd else np.arange(n + 1)
        self.g = [receptance(hertz, k) for k in self.ks]
        self.mean = 0 if odd else 1
        self.scale = 1e-6

    def pack(self, w):
        z = w[self.ks] / self.scale
        re, im = z.real, z.imag
        return np.concatenate([re, im[self.mean:]])

    def unpack(self, u):
        m = self.ks.size
        z = u[:m].astype(complex)
        z[self.mean:] += 1j * u[m:]
        w = np.zeros(self.n + 1, dtype=complex)
        w[self.ks] = z * self.scale
        return w

    def response(self, measured):
        """Both displacements from the harmonics of the measured force (k up to n)."""
        out = np.zeros((2, self.n + 1), dtype=complex)
        for k, gr in zip(self.ks, self.g):
            out[:, k] = gr[:, 0] * -measured[k] + (gr[:, 1] * MODEL["force_on_w2"] if k == 1 else 0.0)
        return out

    def residual(self, u):
        w = self.unpack(u)
        measured = Pieces(self.record, w).harmonics(self.n, *self.quality)
        return self.pack(w - self.response(measured)[0])

    def jacobian(self, u, h=1e-6):
        cols = []
        for j in range(u.size):
            e = np.zeros(u.size)
            e[j] = h
            cols.append((self.residual(u + e) - self.residual(u - e)) / (2.0 * h))
        return np.array(cols).T

    def solve(self, w):
        u = self.pack(w)
        try:
            u = root(self.residual, u, method="hybr", options={"xtol": 1e-10, "maxfev": 400}).x
            for _ in range(8):
                r = self.residual(u)
                size = np.max(np.abs(r))
                if size < 2e-14 * np.max(np.abs(u)) or size > 0.3 * np.max(np.abs(u)):
                    break
                u = u - np.linalg.solve(self.jacobian(u), r)
            size = np.max(np.abs(self.residual(u))) / np.max(np.abs(u))
        except (AssertionError, np.linalg.LinAlgError, ValueError):
            return None, np.inf
        return self.unpack(u), size


# ---- sets -------------------------------------------------------------------------------------------------------

# name, {k: W_k in micrometres}, loop; chosen so that tips and samples do not coincide
SPECTRA = [
    ("one harmonic, alpha 1", {1: 7.2 + 3.486832954025631j}, "odd"),
    ("odd, no interior reversal", {1: 5.1 + 2.3j, 3: 0.31 - 0.42j, 5: 0.06 + 0.05j}, "odd"),
    ("even harmonics and mean, no interior reversal", {0: 1.7, 1: -3.3 + 4.1j, 2: 0.55 - 0.2j, 3: 0.1 + 0.25j}, "odd"),
    ("odd, interior reversals", {1: 3.1 - 0.7j, 3: -1.2 + 1.6j, 5: 0.35 + 0.22j}, "odd"),
    ("odd, interior reversals, small amplitude", {1: 0.21 + 0.13j, 3: 0.11 - 0.17j, 7: 0.023 + 0.041j}, "odd"),
    ("even harmonics and mean, interior reversals", {0: -2.3, 1: 2.6 + 1.9j, 2: 1.4 - 2.2j, 3: 0.3 + 0.9j, 5: 0.4 - 0.1j}, "odd"),
    ("odd, nested loops", {1: 7.32 + 1.97j, 3: -2.96 - 2.35j, 5: 1.16 + 0.85j, 9: 0.85 - 0.13j}, "odd"),
    ("odd, nested three deep", {1: 2.08 - 2.07j, 3: 0.19 + 1.83j, 5: -0.59 + 2.14j, 9: -0.03 - 1.32j}, "odd"),
    ("even harmonics, nested three deep",
     {0: -0.17, 1: 0.05 + 1.54j, 2: 0.53 + 1.11j, 3: 4.88 + 2.56j, 5: -0.24 + 1.99j, 8: -0.6 + 1.12j}, "odd"),
    ("loop that is not odd, no interior reversal", {0: 0.4, 1: 4.3 - 3.1j, 2: 0.3 + 0.35j, 3: -0.2 + 0.15j}, "uneven"),
    ("loop that is not odd, interior reversals", {0: 0.4, 1: 2.9 - 1.4j, 2: 0.8 + 1.3j, 4: -0.6 + 0.55j, 7: 0.2 + 0.1j}, "uneven"),
]

def array(spectrum):
    w = np.zeros(max(spectrum) + 1, dtype=complex)
    for k, z in spectrum.items():
        w[k] = z * 1e-6
    return w


def separation(m):
    """Smallest distances between levels of turning points (relative) and between turning points and j 2 pi / 64."""
    level = np.sort(m.level[:-1])
    gap = np.min(np.diff(level)) / m.half_range if level.size > 1 else 1.0
    phase = m.turn * 32.0 / np.pi
    return gap, np.min(np.abs(phase - np.round(phase))) * np.pi / 32.0


def pair(z):
    return [float(np.real(z)), float(np.imag(z))]


def make_law():
    rows = []
    for alpha in np.concatenate([np.logspace(-6, 6, 37), [0.05, 0.25, 0.5, 0.75, 1.5, 3.0]]):
        for phase in (0.0, 0.7, -2.4, 3.0):
            w1 = alpha * W_STAR * np.exp(1j * phase)
            rows.append({"alpha": float(alpha), "phase": phase, "g": float(g(alpha)), "psi": float(psi(alpha)),
                         "w1": pair(w1), "force": pair(F_STAR * g(alpha) * np.exp(1j * (psi(alpha) + phase)))})
    return {"about": "force: F_contact,1 on the mass, N", "rows": rows}


def make_single():
    rows = []
    for hertz in range(15, 205, 5):
        found, stuck = single(float(hertz))
        rows.append({"hertz": float(hertz), "sliding": len(found), "stuck": stuck,
                     "w1": [pair(z[0]) for z in found], "w2": [pair(z[1]) for z in found]})
    print("N = 1: numbers of sliding solutions", sorted({r["sliding"] for r in rows}), "stuck", any(r["stuck"] for r in rows))
    return {"about": "W_1 of w1 and w2 of each sliding solution", "rows": rows}


def make_forces():
    rows = []
    tau = 2.0 * np.pi * np.arange(64) / 64
    for name, spectrum, which in SPECTRA:
        record = LOOPS[which]
        w = array(spectrum)
        p = Pieces(record, w)
        gap, dist = separation(p.m)
        fine = p.harmonics(15, panels=12, nodes=40)
        coarse = p.harmonics(15, panels=6, nodes=40)
        f = p.at(tau)
        line = {"quadrature": np.max(np.abs(fine - coarse)), "jump": p.jump}
        if which == "odd":
            lit = literal(record, w)
            line["samples_literal"] = np.max(np.abs(lit[:: lit.size // 64] - f))
            spec = np.fft.rfft(lit)[:16] * 2.0 / lit.size
            spec[0] *= 0.5
            line["harmonics_literal"] = np.max(np.abs(spec - fine))
        else:
            w_tau = p.m.derivative(tau, 0)
            if p.closures == 0:
                mid = 0.5 * (p.m.level[0] + p.m.level[p.m.bottom])
                xi = (w_tau - mid) / p.m.half_range
                v = p.m.derivative(tau, 1)
                line["samples_closed_form"] = np.max(np.abs(p.loop.value(np.where(v < 0, 1, -1) * np.arccos(xi)) - f))
        line = {k: float(f"{v:.1e}") for k, v in line.items()}
        print(f"{name}: alpha {p.loop.a / W_STAR:.4f}, turning points {p.m.turn.size - 1}, minor loops {p.closures}, "
              f"nesting {p.depth}, level gap {gap:.3f}, phase gap {dist:.4f}, {line}")
        rows.append({
            "name": name, "loop": which, "reading": which == "uneven" and p.closures > 0,
            "w_micrometre": [[k] + pair(z) for k, z in sorted(spectrum.items())],
            "alpha": float(p.loop.a / W_STAR), "turning_points": int(p.m.turn.size - 1), "minor_loops": p.closures,
            "nesting": p.depth, "turning_phases": [float(q % (2.0 * np.pi)) for q in p.m.turn[:-1]],
            "w": [float(x) for x in p.m.derivative(tau, 0)],
            "f_measured": [float(x) for x in f], "harmonics": [pair(z) for z in fine],
        })
    about = ("f_measured at tau_j = 2 pi j / 64 and its one-sided harmonics 0..15, N; w at the same phases, m; the "
             "contact force on the mass is -f_measured; turning_phases begin at the global maximum")
    return {"about": about, "rows": rows}


def make_balance():
    rng = np.random.default_rng(7)
    rows = []
    cases = [("odd", n, h) for h in (30.0, 43.0, 55.0, 75.0, 108.0, 150.0) for n in (3, 7)]
    cases += [("elastic", 3, 40.0), ("elastic", 7, 34.0), ("elastic", 7, 40.0), ("elastic", 7, 46.0)]
    cases += [("sharp", 3, 36.0), ("sharp", 3, 44.0), ("sharp", 7, 22.0), ("sharp", 7, 26.0), ("sharp", 7, 38.0),
              ("sharp", 7, 44.0)]
    for which, n, hertz in cases:
        record = LOOPS[which]
        one = single(hertz)[0]
        b = Balance(hertz, n, record=record)
        starts = []
        for z in one:
            w = np.zeros(n + 1, dtype=complex)
            w[1] = z[0]
            for size in (1e-3, 0.03, 0.1, 0.3):
                q = w.copy()
                for k in b.ks:
                    q[k] += size * abs(z[0]) * (rng.normal() + 1j * rng.normal()) / k
                starts.append(q)
        for _ in range(32 if hertz == 22.0 else 8):
            q = np.zeros(n + 1, dtype=complex)
            q[b.ks] = abs(one[0][0]) * 10 ** rng.uniform(-0.7, 0.7) * (
                rng.normal(size=b.ks.size) + 1j * rng.normal(size=b.ks.size)) / b.ks
            starts.append(q)
        found, hits, failed = [], [], 0
        for q in starts:
            w, size = b.solve(q)
            if size > 1e-10:
                failed += 1
                continue
            for i, (v, best) in enumerate(found):
                if np.max(np.abs(v - w)) < 1e-7 * np.max(np.abs(w)):
                    hits[i] += 1
                    if size < best:
                        found[i] = (w, size)
                    break
            else:
                found.append((w, size))
                hits.append(1)
        # all harmonics 0..n, asymmetric starts
        full = Balance(hertz, n, odd=False, record=record)
        full_found, full_failed = [], 0
        for _ in range(4):
            q = found[0][0] + 0.1 * abs(one[0][0]) * (rng.normal(size=n + 1) + 1j * rng.normal(size=n + 1))
            q[0] = q[0].real
            w, size = full.solve(q)
            if size > 1e-10:
                full_failed += 1
            else:
                full_found.append(min(np.max(np.abs(w - v[0])) for v in found) / np.max(np.abs(w)))
        b.quality = (12, 40)
        for i, (w, size) in enumerate(found):  # polish on the fine quadrature
            u = b.pack(w)
            jac = b.jacobian(u)
            for _ in range(4):
                u = u - np.linalg.solve(jac, b.residual(u))
            found[i] = (b.unpack(u), np.max(np.abs(b.residual(u))) / np.max(np.abs(u)))
        for (w, size), hit in zip(found, hits):
            p = Pieces(record, w)
            fine = p.harmonics(31, panels=12, nodes=40)
            both = b.response(fine)
            size_fine = np.max(np.abs((w - both[0])[b.ks])) / np.max(np.abs(w))
            size_full = np.max(np.abs(w - full.response(fine)[0])) / np.max(np.abs(w))
            lit = np.fft.rfft(literal(record, w, 2**14))[: n + 1] * 2.0 / 2**14
            lit[0] *= 0.5
            size_lit = np.max(np.abs((w - b.response(lit)[0])[b.ks])) / np.max(np.abs(w))
            gap, _ = separation(p.m)
            sing = np.linalg.svd(b.jacobian(b.pack(w)), compute_uv=False)
            print(f"{which} {hertz:.0f} Hz N = {n}: hits {hit}/{len(starts)} (failed {failed}), |W_1|/W* {abs(w[1]) / W_STAR:.8f}, "
                  f"turning points {p.m.turn.size - 1}, nesting {p.depth}, residual {size:.0e}, with fine quadrature "
                  f"{size_fine:.0e}, all harmonics {size_full:.0e}, literal AFT 2^14 {size_lit:.0e}, level gap {gap:.1e}, "
                  f"smallest singular value {sing[-1]:.2g}; all-harmonic starts: "
                  f"{len(full_found)} converged, distances {[float(f'{x:.0e}') for x in full_found]}", flush=True)
            rows.append({
                "loop": which, "hertz": hertz, "n": n,
                "solution": len([r for r in rows if (r["loop"], r["n"], r["hertz"]) == (which, n, hertz)]),
                "starts": len(starts), "hits": hit, "failed": failed,
                "residual": float(max(size, size_fine)), "turning_points": int(p.m.turn.size - 1), "nesting": p.depth,
                "w1": [[int(k)] + pair(w[k]) for k in b.ks], "w2": [[int(k)] + pair(both[1, k]) for k in b.ks],
                "force": [[k] + pair(-fine[k]) for k in range(1, 32, 2)],
            })
    about = ("harmonic balance, odd harmonics up to n; rows [k, re, im]; force: contact force on w1, "
             "beyond n too; residual: max |W_k - response| / max |W_k|; starts, hits: starts tried, that found this one")
    return {"about": about, "rows": rows}


def dump(value):
    """JSON with 17 significant digits."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(key)}: {dump(v)}" for key, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(dump(v) for v in value) + "]"
    if isinstance(value, float):
        return f"{value:.17g}"
    return json.dumps(value)


def main():
    data = {
        "about": "One-sided amplitudes, complex numbers as [re, im], SI units. Written by scaled_loop.py.",
        "parameters": {
            "w_star": W_STAR, "f_star": F_STAR, "offset": 0.98, "slope": 0.21, "shift": 0.01,
            "limit": -0.5, "span": 7.0 / 15.0, "decay": 4.0,
            "loops": {
                name: [[k] + pair(z) for k, z in sorted(record.items())] for name, record in LOOPS.items()
            },
            "model": MODEL,
        },
        "law": make_law(), "single": make_single(), "forces": make_forces(), "balance": make_balance(),
    }
    path = os.path.join(os.path.dirname(os.path.abspath(__file__)), "scaled_loop.json")
    with open(path, "w") as out:
        out.write("{\n")
        for i, key in enumerate(data):
            comma = "," if i + 1 < len(data) else ""
            if isinstance(data[key], dict) and "rows" in data[key]:
                out.write(f'"{key}": {{"about": {json.dumps(data[key]["about"])}, "rows": [\n')
                out.write(",\n".join(dump(r) for r in data[key]["rows"]))
                out.write("\n]}" + comma + "\n")
            else:
                out.write(f'"{key}": {dump(data[key])}{comma}\n')
        out.write("}\n")
    print(path, os.path.getsize(path), "bytes")


if __name__ == "__main__":
    main()
