"""Scenes, and what can be asked of them."""

from __future__ import annotations

import copy
import json
import os
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._errors import SceneError
from ._interrupt import finished
from ._peaks import Peaks
from ._result import Backbone, Curve, Orbit, Result, Truncation

Progress = bool | Callable[[int], object] | None
Force = Callable[[NDArray[np.float64], NDArray[np.float64]], ArrayLike]


class Step(NamedTuple):
    """One line of :meth:`Scene.explain`."""

    what: str
    """What could be done."""
    used: bool
    """Whether this scene needs it."""
    why: str
    """Why, or why not."""


@dataclass(frozen=True)
class PythonLaw:
    """A contact law written in Python, for laws that stickslip does not know.

    ``force(displacement, velocity)`` gets one period at equidistant instants, in m and m/s, and answers with the force at each of them
    in N, in rig convention (the force that drives the contact; a dissipating one has a positive integral of force over
    displacement). It must be a function of these arrays alone.

    The interpreter evaluates it at every iteration and the derivative is taken by differences: expect a point to take a thousand
    times as long as with a law of stickslip's own.
    """

    force: Force
    """The law."""
    length: float
    """Displacement in m at which the law changes its character; sets units."""
    odd: bool = True
    """The force of the mirrored motion is the mirrored force."""
    determines_mean: bool = False
    """The mean force depends on the mean displacement, as that of a spring does."""

    def _called(self, displacement: NDArray[np.float64], velocity: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.ascontiguousarray(self.force(displacement, velocity), dtype=float)


class Scene:
    """A model with contacts under periodic excitation.

    Parameters
    ----------
    source
        The name of a scene's file, or a dict of the same form. NumPy arrays in a dict are taken as lists; the law of a contact may be a
        :class:`PythonLaw`.
    base
        Folder to which names of files in a dict are relative; the working directory if none. A file's scene is relative to its file.

    Raises
    ------
    SceneError
        With the path of the entry that is wrong: ``contacts[0].law.slip_force: must be positive, got -1``.
    """

    def __init__(
        self, source: str | os.PathLike[str] | Mapping[str, Any], base: str | os.PathLike[str] | None = None
    ) -> None:
        if isinstance(source, Mapping):
            self._data = copy.deepcopy(dict(source))
            self._base = Path(base) if base is not None else Path()
        else:
            path = Path(source)
            try:
                self._data = json.loads(path.read_text(encoding="utf-8"))
            except OSError as error:
                raise SceneError(f"{path}: {error.strerror or error}") from error
            except ValueError as error:
                raise SceneError(f"{path}: {error}") from error
            if not isinstance(self._data, dict):
                raise SceneError(f"{path}: must be an object {{model, excitation, contacts, frequencies, …}}")
            self._data.setdefault("name", path.stem)
            self._base = path.parent if base is None else Path(base)
        text, laws = _text(self._data)
        self._laws = bool(laws)
        self._native = _native.Scene(text, str(self._base), laws)
        if laws:
            warnings.warn(
                "a contact law in Python is evaluated by the interpreter, with differences for its derivative: expect a point to take "
                "milliseconds to seconds instead of microseconds",
                RuntimeWarning,
                stacklevel=2,
            )

    def __repr__(self) -> str:
        dofs, contacts, points = len(self.dofs), len(self.contacts), len(self.frequencies)
        return f"<stickslip.Scene {self.name!r}: {dofs} dofs, {contacts} contacts, {points} frequencies>"

    @property
    def data(self) -> dict[str, Any]:
        """A copy of the scene as a dict."""
        return copy.deepcopy(self._data)

    @property
    def name(self) -> str:
        """Its name, or that of its file."""
        return self._native.name

    @property
    def dofs(self) -> list[str]:
        """Names of the dofs that move."""
        return self._native.dofs

    @property
    def output(self) -> list[str]:
        """Names of the dofs whose displacement is recovered."""
        return self._native.output

    @property
    def contacts(self) -> list[str]:
        """Names of the contacts."""
        return self._native.contacts

    @property
    def frequencies(self) -> NDArray[np.float64]:
        """Frequencies of the sweep in Hz, shape (points,)."""
        return self._native.frequencies

    @property
    def notes(self) -> list[str]:
        """What a user should know about the scene's data."""
        return self._native.notes

    def replace(self, pointer: str, value: Any) -> Scene:
        """The same scene with another value at a JSON pointer, ``/contacts/0/law/slip_force``."""
        data: Any = copy.deepcopy(self._data)
        parts = [part.replace("~1", "/").replace("~0", "~") for part in pointer.split("/")[1:]]
        if not pointer.startswith("/"):
            raise SceneError(f"{pointer!r} is no JSON pointer; it begins with a slash: /contacts/0/law/slip_force")
        place = data
        try:
            for part in parts[:-1]:
                place = place[int(part)] if isinstance(place, list) else place[part]
            place[int(parts[-1]) if isinstance(place, list) else parts[-1]] = value
        except (KeyError, IndexError, ValueError, TypeError) as error:
            raise SceneError(f"the scene has nothing at {pointer}") from error
        return Scene(data, self._base)

    def _with(self, harmonics: Any, frequencies: ArrayLike | None, output: Sequence[str] | None = None) -> Scene:
        changes: dict[str, Any] = {}
        if harmonics is not None:
            changes["harmonics"] = harmonics
        if frequencies is not None:
            changes["frequencies"] = np.atleast_1d(np.asarray(frequencies, dtype=float))
        if output is not None:
            changes["output"] = list(output)
        if not changes:
            return self
        with warnings.catch_warnings():
            # The user was warned of laws in Python when this scene was made.
            warnings.simplefilter("ignore", RuntimeWarning)
            return Scene({**self._data, **changes}, self._base)

    def sweep(
        self,
        frequencies: ArrayLike | None = None,
        harmonics: int | Mapping[str, float] | None = None,
        output: Sequence[str] | None = None,
        *,
        threads: int | None = None,
        progress: Progress = None,
        all_solutions: bool = False,
        stability: bool = False,
    ) -> Result:
        """The forced response at every frequency.

        Parameters
        ----------
        frequencies
            In Hz; those of the scene if none.
        harmonics
            N, or ``{"tolerance": 1e-6, "max": 63}`` for as many as each point needs; that of the scene if none.
        output
            Names of the dofs to recover; those of the scene if none.
        threads
            One a core if none. The result does not depend on it.
        progress
            ``True`` for a bar (with tqdm, where it is installed), or a function of the number of finished points.
        all_solutions
            Keep all solutions where they are known (one harmonic, one contact); see ``result.data``.
        stability
            Find Floquet multipliers: ``result.stable``, ``result.multipliers``.

        Points without a solution are NaN and say why in ``result.reason``.

        Raises
        ------
        KeyboardInterrupt
            On Ctrl-C. What is finished by then is its attribute ``partial``, a :class:`Result` of fewer points; likewise of whatever
            ``progress`` raises, and of all that takes long: :meth:`continue_`, :meth:`backbone`, :meth:`peaks`, :meth:`truncation`,
            :meth:`Study.run`.
        """
        scene = self._with(harmonics, frequencies, output)
        with _Bar(progress, len(scene.frequencies), "points") as bar:
            columns, text, stopped = scene._native.sweep(threads, bar.report, all_solutions, stability)
        return finished(Result(columns, text), stopped)

    def continue_(
        self,
        begin: float | None = None,
        end: float | None = None,
        *,
        along: str | None = None,
        at: float | None = None,
        harmonics: int | None = None,
        output: Sequence[str] | None = None,
        stability: bool = False,
    ) -> Curve:
        """The response as a curve, through its folds.

        Parameters
        ----------
        begin, end
            Frequencies in Hz between which the curve runs, those of the scene if none; with ``along`` the values of that entry.
        along
            A JSON pointer to a number of the scene: the curve runs along it at the frequency ``at`` in Hz.
        harmonics, output, stability
            As in :meth:`sweep`.
        """
        scene = self._with(harmonics, None, output)
        frequencies = scene.frequencies
        if along is not None:
            self._refuse_python("a curve along an entry")
            if begin is None or end is None or at is None:
                raise SceneError("a curve along an entry needs begin, end, and the frequency: at")
        else:
            begin = float(frequencies.min()) if begin is None else begin
            end = float(frequencies.max()) if end is None else end
        columns, text, stopped = scene._native.curve(begin, end, along, at, stability)
        return finished(Curve(columns, text), stopped)

    def _refuse_python(self, what: str) -> None:
        """Variants are made from the scene's text, in which a law in Python is not."""
        if self._laws:
            raise SceneError(f"{what} needs laws of stickslip's own, and a contact has a PythonLaw")

    def peaks(
        self,
        vary: str,
        begin: float,
        end: float,
        *,
        log: bool = False,
        points: int = 13,
        dof: str | None = None,
        harmonics: int | Sequence[int] | None = None,
        frequencies: ArrayLike | None = None,
        threads: int | None = None,
    ) -> Peaks:
        """The highest peak over an entry of the scene, and where it is lowest: the best slip force of a damper.

        Parameters
        ----------
        vary
            A JSON pointer to a number of the model, the excitation or a contact: ``/contacts/0/law/slip_force``.
        begin, end
            Its smallest and its largest value.
        log
            Space the values evenly over the logarithm.
        points
            Values at which the whole response is looked at, ends included.
        dof
            The dof whose amplitude |W_1| in m counts; the first excited one if none.
        harmonics
            N, or several for a curve each; that of the scene if none.
        frequencies
            Only their range counts, in Hz; that of the scene if none.
        threads
            One a core if none. The result does not depend on it.
        """
        self._refuse_python("following peaks over an entry")
        if points < 2:
            raise SceneError(f"points: both ends are looked at, got {points}")
        numbers = [] if harmonics is None else [int(n) for n in np.atleast_1d(np.asarray(harmonics))]
        native = self._with(None, frequencies)._native
        text, stopped = native.peaks(vary, (begin, end), log, points, dof, numbers, threads)
        return finished(Peaks(text), stopped)

    def backbone(
        self,
        mode: int = 1,
        *,
        origin: str = "stuck",
        dof: str | None = None,
        amplitudes: tuple[float | None, float | None] = (None, None),
        points: int = 60,
        harmonics: int | None = None,
    ) -> Backbone:
        """Natural frequency and damping ratio of a mode against its amplitude (extended periodic motion concept).

        Parameters
        ----------
        mode
            Counted from one in the order of the frequencies of the structure that ``origin`` names.
        origin
            ``"stuck"``: from the structure with its contacts stuck; ``"free"``: without them.
        dof
            The dof whose amplitude |W_1| in m is given; the first excited one if none.
        amplitudes
            The smallest and the largest in m.
        points
            How many are wanted.
        """
        if origin not in ("stuck", "free"):
            raise SceneError(f'origin must be "stuck" or "free", not {origin!r}')
        scene = self._with(harmonics, None)
        columns, text, stopped = scene._native.backbone(mode, origin == "stuck", dof, amplitudes, points)
        return finished(Backbone(columns, text), stopped)

    def truncation(
        self,
        harmonics: Sequence[int] = (1, 3, 7, 15, 31),
        frequencies: ArrayLike | None = None,
        *,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Truncation:
        """Error and time against the number of harmonics: against the exact orbit where there is one, else against many more
        harmonics."""
        scene = self._with(None, frequencies)
        with _Bar(progress, len(scene.frequencies), "frequencies") as bar:
            text, stopped = scene._native.truncation([int(n) for n in harmonics], threads, bar.report)
        return finished(Truncation(text), stopped)

    def orbit(self, frequency: float, *, harmonics: int = 63, instants: int = 2048) -> Orbit:
        """The exact periodic motion at ``frequency`` in Hz, with spectra up to ``harmonics`` and one period at so many instants.

        Raises
        ------
        SolveError
            When there is none: a law without a mechanism in time, or a motion that does not close.
        """
        return Orbit(self._native.orbit(frequency, harmonics, instants), float(frequency), self.output, self.contacts)

    def explain(self) -> list[Step]:
        """What the scene needs, what it leaves out, and why."""
        return [Step(*step) for step in self._native.explain()]


_PLACEHOLDER = {"type": "linear", "stiffness": 1.0}


def _text(data: Mapping[str, Any]) -> tuple[str, list[tuple[str, Callable[..., Any], float, bool, bool]]]:
    """A scene as text, and the laws in Python that it does not hold."""
    laws = []
    contacts = data.get("contacts")
    if isinstance(contacts, (list, tuple)):
        plain = []
        for contact in contacts:
            law = contact.get("law") if isinstance(contact, Mapping) else None
            if isinstance(law, PythonLaw):
                if not law.length > 0.0:
                    raise SceneError(f"PythonLaw.length: must be positive, got {law.length}")
                laws.append((str(contact.get("name", "")), law._called, float(law.length), law.odd, law.determines_mean))
                contact = {**contact, "law": _PLACEHOLDER}
            plain.append(contact)
        data = {**data, "contacts": plain}
    return json.dumps(data, default=_plain), laws


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"a scene cannot hold {type(value).__name__}: {value!r}")


class _Bar:
    """Progress as it was asked for."""

    def __init__(self, wanted: Progress, total: int, unit: str) -> None:
        self._bar: Any = None
        self.report: Callable[[int], object] | None = None
        if callable(wanted):
            self.report = wanted
        elif wanted:
            try:
                from tqdm.auto import tqdm
            except ImportError:
                return
            self._bar = tqdm(total=total, unit=unit)
            self.report = self._advance

    def _advance(self, count: int) -> None:
        self._bar.update(count - self._bar.n)

    def __enter__(self) -> _Bar:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.close()
