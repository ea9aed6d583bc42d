"""What comes back: arrays with names."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._errors import SceneError

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]


@dataclass(frozen=True)
class Contact:
    """One contact over the points of a result."""

    dissipation: Floats
    """J a cycle, shape (points,)."""
    state: list[str | None]
    """``stick``, ``slip``, ``mixed``, ``held`` or ``apart``."""
    extrapolated: NDArray[np.bool_]
    """The amplitude left the range in which the law was measured."""
    amplitude: Floats
    """Half the peak-to-peak relative displacement in m, shape (points,)."""
    force: Complexes
    """On the first body, in N, shape (points, harmonics)."""


@dataclass(frozen=True)
class Direction:
    """One direction of a joint over the points of a result."""

    amplitude: Floats
    """Half the peak-to-peak relative displacement in m, shape (points,)."""
    displacement: Complexes
    """Relative displacement in m, shape (points, harmonics); towards each other is positive in the normal direction."""
    force: Complexes
    """On the first body, in N, shape (points, harmonics)."""


@dataclass(frozen=True)
class Joint:
    """A contact in several directions over the points of a result."""

    dissipation: Floats
    """Of all directions together, J a cycle, shape (points,)."""
    state: list[str | None]
    """``stick``, ``slip``, ``mixed`` or ``apart``."""
    extrapolated: NDArray[np.bool_]
    """The motion left the range in which the law was measured."""
    apart: Floats
    """Part of the period during which the bodies are apart, shape (points,)."""
    directions: dict[str, Direction]
    """``tangential``, or ``tangential1`` and ``tangential2``, and ``normal``."""


def _contact(columns: Mapping[str, Any]) -> Contact | Joint:
    directions = columns.get("directions")
    if directions is None:
        return Contact(**columns)
    named = {name: Direction(**direction) for name, direction in directions.items()}
    return Joint(**{**columns, "directions": named})


class _Answer:
    """An answer and the JSON that the command line would have written."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._data: dict[str, Any] | None = None

    @property
    def data(self) -> dict[str, Any]:
        """The whole result as the command line writes it."""
        if self._data is None:
            self._data = json.loads(self._text)
        assert self._data is not None
        return self._data

    @property
    def notes(self) -> list[str]:
        """What a user should be told."""
        return list(self.data.get("notes", []))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the result as JSON, whole or not at all."""
        path = Path(path)
        partial = path.with_name(path.name + ".partial")
        partial.write_text(self._text + "\n", encoding="utf-8")
        partial.replace(path)


class _Points(_Answer):
    """Points of a response."""

    def __init__(self, columns: Mapping[str, Any], text: str) -> None:
        super().__init__(text)
        self.frequency: Floats = columns["frequency"]
        """In Hz, shape (points,)."""
        self.status: list[str] = columns["status"]
        """``converged``, ``stuck`` or ``failed``, one a point."""
        self.reason: list[str | None] = columns["reason"]
        """Why a point failed."""
        self.harmonics: NDArray[np.int64] = columns["harmonics"]
        """N of each point."""
        self.iterations: NDArray[np.int64] = columns["iterations"]
        """Newton steps of each point."""
        self.residual: Floats = columns["residual"]
        """Relative to the excitation."""
        self.truncation_error: Floats = columns["truncation_error"]
        """Estimate of the relative error from having stopped at N; NaN where none was made."""
        self.sampling_error: Floats = columns["sampling_error"]
        """Likewise from sampling the contact forces."""
        self.stable: list[bool | None] = columns["stable"]
        """Whether a point is stable, one a point; None where it is undecided, not known (:attr:`notes` say why), or was not asked
        for."""
        self.multipliers: Complexes = columns["multipliers"]
        """Floquet multipliers of a period of the excitation, the largest first, shape (points, multipliers); NaN where there are
        none or fewer. No columns when stability was not asked for."""
        self.stability_error: Floats = columns["stability_error"]
        """Estimate of how far each multiplier may be from the true one, shape (points,)."""
        self.orders: NDArray[np.int64] = columns["orders"]
        """k of every column of a spectrum, shape (harmonics,)."""
        self.dofs: list[str] = columns["dofs"]
        """Names along the second axis of :attr:`displacement`."""
        self.displacement: Complexes = columns["displacement"]
        """W_k in m, shape (points, dofs, harmonics); NaN where a point failed."""
        self.contacts: dict[str, Contact | Joint] = {
            name: _contact(contact) for name, contact in columns["contacts"].items()
        }
        """By the contacts' names."""

    def __len__(self) -> int:
        return len(self.frequency)

    @property
    def converged(self) -> NDArray[np.bool_]:
        """Where there is a solution, shape (points,)."""
        return np.array([status != "failed" for status in self.status])

    @property
    def unstable(self) -> NDArray[np.bool_]:
        """Where a point is known to be unstable, shape (points,)."""
        return np.array([stable is False for stable in self.stable], dtype=bool)

    def spectrum(self, dof: str | None = None) -> Complexes:
        """W_k of a dof in m, shape (points, harmonics); of the only one where there is one."""
        return self.displacement[:, self._dof(dof), :]

    def amplitude(self, dof: str | None = None, order: int = 1) -> Floats:
        """|W_k| of a dof in m, shape (points,); zero where the response has no such harmonic."""
        column = np.flatnonzero(self.orders == order)
        if column.size == 0:
            return np.where(self.converged, 0.0, np.nan)
        return np.abs(self.spectrum(dof)[:, column[0]])

    def waveform(self, index: int, dof: str | None = None, samples: int = 512) -> tuple[Floats, Floats]:
        """Instants in s and the displacement in m of point ``index`` over one period, shape (samples,) each."""
        tau = 2 * np.pi * np.arange(samples) / samples
        w = (self.spectrum(dof)[index] * np.exp(1j * np.outer(tau, self.orders))).real.sum(axis=1)
        return tau / (2 * np.pi * self.frequency[index]), w

    def _dof(self, dof: str | None) -> int:
        if dof is None and len(self.dofs) == 1:
            return 0
        if dof not in self.dofs:
            raise SceneError(f"{dof!r} is not among the dofs of the result: {', '.join(self.dofs)}")
        return self.dofs.index(dof)

    def to_dataframe(self) -> pd.DataFrame:
        """One row a point: frequency, status, N, errors, ``|W_1|`` of every dof and what every contact does. Needs pandas."""
        import pandas as pd

        columns: dict[str, Any] = {
            "frequency": self.frequency,
            "status": self.status,
            "harmonics": self.harmonics,
            "residual": self.residual,
            "truncation_error": self.truncation_error,
            "sampling_error": self.sampling_error,
        }
        for dof in self.dofs:
            columns[f"amplitude {dof}"] = self.amplitude(dof)
        for name, contact in self.contacts.items():
            if isinstance(contact, Contact):
                columns[f"amplitude {name}"] = contact.amplitude
            else:
                for direction, motion in contact.directions.items():
                    columns[f"amplitude {name} {direction}"] = motion.amplitude
            columns[f"state {name}"] = contact.state
            columns[f"dissipation {name}"] = contact.dissipation
        return pd.DataFrame(columns)


class Result(_Points):
    """The forced response of a sweep."""

    def plot(self, dofs: str | list[str] | None = None, ax: Axes | None = None, **style: Any) -> Axes:
        """|W_1| over frequency, one line a dof. Needs matplotlib."""
        return _amplitudes(self, dofs, ax, style)


class Curve(_Points):
    """The response along a curve, through its folds."""

    def __init__(self, columns: Mapping[str, Any], text: str) -> None:
        super().__init__(columns, text)
        self.parameter: Floats = columns["parameter"]
        """Frequency in Hz, or the entry along which the curve runs, shape (points,)."""
        self.arclength: Floats = columns["arclength"]
        """Relative steps added up."""
        self.fold: NDArray[np.bool_] = columns["fold"]
        """The curve turns back here."""

    @property
    def reached(self) -> bool:
        """The curve arrived at its end; else :attr:`why` says why not."""
        return bool(self.data["end"] == "reached")

    @property
    def why(self) -> str:
        """Why the curve ended early; empty when it did not."""
        return str(self.data["reason"])

    def plot(self, dofs: str | list[str] | None = None, ax: Axes | None = None, **style: Any) -> Axes:
        """|W_1| along the curve, one line a dof. Needs matplotlib."""
        return _amplitudes(self, dofs, ax, style, self.parameter, self.data["parameter"])


class Backbone(_Points):
    """A damped nonlinear mode over its amplitude."""

    def __init__(self, columns: Mapping[str, Any], text: str) -> None:
        super().__init__(columns, text)
        self.modal: Floats = columns["amplitude"]
        """|W_1| of the reference dof in m, shape (points,); :attr:`frequency` is the natural frequency."""
        self.damping_ratio: Floats = columns["damping_ratio"]
        """Of critical damping."""
        self.excitation: Floats = columns["excitation"]
        """Factor on the scene's excitation whose resonance has this amplitude; NaN where nothing excites the mode."""
        self.resonance: Floats = columns["resonance"]
        """Frequency of that resonance in Hz."""

    def plot(self, axes: tuple[Axes, Axes] | None = None, **style: Any) -> tuple[Axes, Axes]:
        """Natural frequency and damping ratio over amplitude. Needs matplotlib."""
        import matplotlib.pyplot as plt

        if axes is None:
            _, drawn = plt.subplots(2, 1, sharex=True)
            axes = (drawn[0], drawn[1])
        axes[0].semilogx(self.modal, self.frequency, **style)
        axes[0].set_ylabel("natural frequency [Hz]")
        axes[1].semilogx(self.modal, 100 * self.damping_ratio, **style)
        axes[1].set(xlabel=f"|W_1| of {self.dofs[0]} [m]", ylabel="damping ratio [%]")
        return axes


class Truncation(_Answer):
    """Error and time against the number of harmonics."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        rows = self.data["rows"]

        def column(key: str) -> Floats:
            return np.array([np.nan if row[key] is None else row[key] for row in rows], dtype=float)

        self.reference: str = self.data["reference"]
        """What the solutions were compared with: ``orbit``, or ``harmonics:255``."""
        self.frequency = column("frequency")
        """In Hz, shape (rows,); every frequency has one row a number of harmonics."""
        self.harmonics = column("harmonics").astype(np.int64)
        """N, shape (rows,)."""
        self.error = column("error")
        """Relative l2 error of the displacement spectrum, the worst of the dofs, shape (rows,)."""
        self.error_first = column("error_first")
        """Of |W_1|."""
        self.estimate = column("estimate")
        """The solver's own estimate of :attr:`error`."""
        self.seconds = column("seconds")
        """Time of a point."""

    def to_dataframe(self) -> pd.DataFrame:
        """The rows. Needs pandas."""
        import pandas as pd

        return pd.DataFrame(self.data["rows"])


class Orbit:
    """The exact periodic motion at one frequency."""

    def __init__(self, answer: Mapping[str, Any], frequency: float, dofs: list[str], contacts: list[str]) -> None:
        self.frequency = frequency
        """In Hz."""
        self.period: float = answer["period"]
        """In s."""
        self.time: Floats = answer["time"]
        """Instants of one period in s, shape (instants,)."""
        self.dofs = dofs
        """Names along the first axis of motions."""
        self.contacts = contacts
        """Names along the first axis of forces."""
        self.displacement: Floats = answer["displacement"]
        """In m, shape (dofs, instants)."""
        self.velocity: Floats = answer["velocity"]
        """In m/s, shape (dofs, instants)."""
        self.contact_force: Floats = answer["contact_force"]
        """On the first body in N, shape (contacts, instants)."""
        self.spectrum: Complexes = answer["spectrum"]
        """W_0 … in m, shape (dofs, harmonics + 1)."""
        self.force_spectrum: Complexes = answer["force_spectrum"]
        """In N, shape (contacts, harmonics + 1)."""
        self.dissipation: Floats = answer["dissipation"]
        """J a period, shape (contacts,)."""
        self.closure: float = answer["closure"]
        """By how much the period fails to close, relative."""


def _amplitudes(
    points: _Points,
    dofs: str | list[str] | None,
    ax: Axes | None,
    style: Mapping[str, Any],
    over: Floats | None = None,
    label: str = "frequency",
) -> Axes:
    import matplotlib.pyplot as plt

    if ax is None:
        _, ax = plt.subplots()
    chosen = points.dofs if dofs is None else [dofs] if isinstance(dofs, str) else dofs
    for dof in chosen:
        ax.semilogy(
            points.frequency if over is None else over, points.amplitude(dof), **{"label": dof, **style}
        )
    ax.set(xlabel="frequency [Hz]" if label == "frequency" else label, ylabel="|W_1| [m]")
    ax.legend()
    return ax
