"""Measured friction loops and the scaling laws identified from them."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native


class Loop:
    """A measured friction loop as a Fourier series over loop phase; made by :meth:`fit` or :meth:`read`.

    Forces are in rig convention: a loop that dissipates has a positive integral of force over displacement.
    """

    def __init__(self, native: _native.Fit) -> None:
        self._native = native

    @classmethod
    def fit(cls, displacement: ArrayLike, force: ArrayLike, time: ArrayLike | None = None) -> Loop:
        """Fits samples of a record, in m, N and s: steady cycles are told from run-up and run-down and averaged.

        Raises
        ------
        LoopError
            When there is no steady cycle, or the force drives the motion (flip its sign then).
        """

        def array(values: ArrayLike) -> NDArray[np.float64]:
            return np.ascontiguousarray(values, dtype=float)

        return cls(_native.fit(array(displacement), array(force), None if time is None else array(time)))

    @classmethod
    def read(cls, path: str | os.PathLike[str], **options: Any) -> Loop:
        """Reads a record's file and fits it; options are those of ``loop`` in a scene: ``columns={"displacement": "d"}``,
        ``units={"displacement": "in"}``, ``force_sign=-1``."""
        return cls(_native.fit_file(os.fspath(path), json.dumps(options)))

    @property
    def displacement_amplitude(self) -> float:
        """Half peak-to-peak, in m."""
        return self._native.displacement_amplitude

    @property
    def force_amplitude(self) -> float:
        """|F_1| in N."""
        return self._native.force_amplitude

    @property
    def phase(self) -> float:
        """arg F_1 in rad."""
        return self._native.phase

    @property
    def dissipation(self) -> float:
        """J a cycle."""
        return self._native.dissipation

    @property
    def harmonics(self) -> NDArray[np.complex128]:
        """F_0 … F_K in N over loop phase."""
        return self._native.harmonics

    @property
    def cycles(self) -> int:
        """Steady cycles that were averaged."""
        return self._native.cycles

    @property
    def period(self) -> float | None:
        """In s; None without times."""
        return self._native.period

    @property
    def noise(self) -> float:
        """Scatter about the mean cycle, relative to |F_1|."""
        return self._native.noise

    @property
    def even_content(self) -> float:
        """Of even harmonics, relative to |F_1|."""
        return self._native.even_content

    @property
    def notes(self) -> list[str]:
        """What was noticed."""
        return self._native.notes

    def force(self, theta: ArrayLike) -> NDArray[np.float64]:
        """Force in N at loop phases in rad; displacement there is ``displacement_amplitude * cos(theta)``."""
        theta = np.asarray(theta, dtype=float)
        return self._native.force(theta.ravel()).reshape(theta.shape)

    def to_scene(self) -> dict[str, Any]:
        """What a scene takes as ``loop`` of a ``scaled_loop``."""
        series = [[k, f.real, f.imag] for k, f in enumerate(self.harmonics.tolist()) if f != 0]
        return {"displacement": self.displacement_amplitude, "harmonics": series}


@dataclass(frozen=True)
class Scaling:
    """The scaling laws, eqs (6) and (7) of the paper, as identified."""

    magnitude: Mapping[str, Any]
    """offset, slope and shift of g(alpha), each with value, std_error and interval (95 %)."""
    phase: Mapping[str, Any]
    """limit, span and decay of psi_C(alpha), likewise."""
    reference: Mapping[str, Any]
    """index, displacement (W* in m) and force (F* in N) of the reference loop."""
    residual_rms: float
    """Relative to F*."""
    notes: list[str]
    """What the loops do not tell."""

    def to_scene(self) -> dict[str, dict[str, float]]:
        """What a scene takes as ``magnitude`` and ``phase`` of a ``scaled_loop``."""
        return {
            law: {name: number["value"] for name, number in values.items()}
            for law, values in (("magnitude", self.magnitude), ("phase", self.phase))
        }


def scale(
    loops: Sequence[Loop],
    *,
    magnitude: str = "turning-points",
    weighting: str = "equal",
    reference: int | None = None,
) -> Scaling:
    """Identifies the scaling laws from loops at several amplitudes.

    Parameters
    ----------
    loops
        Three or more.
    magnitude
        ``"turning-points"`` (as in the paper) or ``"first-harmonic"``.
    weighting
        ``"equal"`` (as in the paper) or ``"noise"``.
    reference
        Which loop's amplitude and force are W* and F*; the largest if none.
    """
    settings = {"magnitude": magnitude, "weighting": weighting, "reference": reference}
    return Scaling(**_native.identify([loop._native for loop in loops], json.dumps(settings)))
