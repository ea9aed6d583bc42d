"""Resonance peaks over an entry of a scene."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ._result import Floats, _Answer

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes


@dataclass(frozen=True)
class Optimum:
    """Where the highest peak is lowest."""

    kind: str
    """``minimum`` of one peak, ``crossing`` of two that are equally high, or the ``end`` of the range."""
    parameter: float
    """Value of the entry."""
    frequency: float
    """Of the peak, in Hz."""
    amplitude: float
    """|W_1| of the dof in m."""
    dissipation: float
    """Of all contacts, in J a period."""


class PeaksCurve:
    """The highest peak with one number of harmonics; NaN where it is not known."""

    def __init__(self, data: dict[str, Any]) -> None:
        self.harmonics: int = data["harmonics"]
        """N."""
        self.reached: bool = data["end"] == "reached"
        """All values have their peaks; else the work was stopped."""
        points = data["points"]
        self.parameter: Floats = np.array([point["parameter"] for point in points], dtype=float)
        """Values of the entry, growing, shape (points,): those that were asked for, and others where they were needed."""
        self.status: list[str] = [point["status"] for point in points]
        """``surveyed``: the whole response was looked at; ``followed``: from surveyed neighbours; ``higher at end``: the response is
        higher at an end of the frequencies; ``incomplete``, ``doubtful`` or ``failed``: the highest peak is not known."""
        highest = [_highest(point) for point in points]

        def column(key: str) -> Floats:
            return np.array([np.nan if peak is None else peak[key] for peak in highest], dtype=float)

        self.frequency = column("frequency")
        """Of the highest peak, in Hz, shape (points,)."""
        self.amplitude = column("amplitude")
        """|W_1| of the dof there, in m, shape (points,)."""
        self.dissipation = column("dissipation")
        """Of all contacts there, in J a period, shape (points,)."""
        self.optimum: Optimum | None = None
        """Where the highest peak is lowest; None where that is not known."""
        best = data["optimum"]
        peak = None if best is None else _highest(best)
        if peak is not None:
            self.optimum = Optimum(
                best["kind"], best["parameter"], peak["frequency"], peak["amplitude"], peak["dissipation"]
            )


def _highest(point: dict[str, Any]) -> dict[str, Any] | None:
    """The highest peak, where it is known."""
    sound = point["status"] not in ("incomplete", "doubtful", "failed")
    peaks: list[dict[str, Any]] = point["peaks"]
    return peaks[0] if sound and peaks else None


class Peaks(_Answer):
    """The highest peak over an entry of a scene, one curve a number of harmonics."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.parameter: str = self.data["parameter"]
        """The JSON pointer of the entry."""
        self.dof: str = self.data["dof"]
        """The dof whose amplitude counts."""
        self.curves = [PeaksCurve(curve) for curve in self.data["curves"]]
        """In the order in which numbers of harmonics were asked for."""

    @property
    def optimum(self) -> Optimum | None:
        """That of the last curve; None where it is not known."""
        return self.curves[-1].optimum if self.curves else None

    def to_dataframe(self) -> pd.DataFrame:
        """One row a value of the entry and number of harmonics. Needs pandas."""
        import pandas as pd

        tables = [
            pd.DataFrame(
                {
                    "harmonics": curve.harmonics,
                    "parameter": curve.parameter,
                    "status": curve.status,
                    "frequency": curve.frequency,
                    "amplitude": curve.amplitude,
                    "dissipation": curve.dissipation,
                }
            )
            for curve in self.curves
        ]
        return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame()

    def plot(self, ax: Axes | None = None, **style: Any) -> Axes:
        """Amplitude of the highest peak over the entry, one line a number of harmonics. Needs matplotlib."""
        import matplotlib.pyplot as plt

        if ax is None:
            _, ax = plt.subplots()
        draw = ax.loglog if self.data["logarithmic"] else ax.semilogy
        for curve in self.curves:
            draw(curve.parameter, curve.amplitude, **{"label": f"N = {curve.harmonics}", **style})
        ax.set(xlabel=self.parameter, ylabel=f"|W_{self.data['harmonic']}| of {self.dof} [m]")
        ax.legend()
        return ax
