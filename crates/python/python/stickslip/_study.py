"""Studies: grids over entries of a scene."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _native
from ._errors import SceneError
from ._interrupt import finished as ended
from ._scene import Progress, _Bar, _plain

if TYPE_CHECKING:
    import pandas as pd


class Study:
    """A grid over entries of a scene, as the command ``stickslip study`` takes it.

    Parameters
    ----------
    source
        The name of a study's file, or a dict of the same form.
    base
        Folder to which the scene's name in a dict is relative; the working directory if none.

    Studies can be pickled: what travels is the text, and the scene's files are read where the study arrives. On several machines they
    must see the same folder.
    """

    def __init__(
        self, source: str | os.PathLike[str] | Mapping[str, Any], base: str | os.PathLike[str] | None = None
    ) -> None:
        if isinstance(source, Mapping):
            self._text = json.dumps(dict(source), default=_plain)
            self._name = "study"
            self._base = Path(base) if base is not None else Path()
        else:
            path = Path(source)
            try:
                self._text = path.read_text(encoding="utf-8")
            except OSError as error:
                raise SceneError(f"{path}: {error.strerror or error}") from error
            self._name = path.stem
            self._base = path.parent if base is None else Path(base)
        self._base = self._base.absolute()
        self._native = _native.Study(self._text, str(self._base), self._name)

    def __reduce__(self) -> tuple[Callable[..., Study], tuple[str, str, str, str]]:
        return _arrived, (self._text, str(self._base), self._name, self.fingerprint)

    def __len__(self) -> int:
        """Number of cases."""
        return self._native.cases

    @property
    def fingerprint(self) -> str:
        """Of the study, its scene, its records and the version of stickslip: equal ones have equal results."""
        return self._native.fingerprint

    def solve(self, case: int) -> str:
        """One case, counted from 0, on one thread: the finished case as text, for :meth:`table`."""
        return self._native.solve(case)

    def run(self, *, threads: int | None = None, progress: Progress = None) -> StudyTable:
        """All cases on this machine. The result does not depend on the number of threads.

        Whatever ends it early carries the table of the finished cases as ``partial``, as with :meth:`Scene.sweep`.
        """
        finished: list[str] = []
        stopped: BaseException | None = None
        with _Bar(progress, len(self), "cases") as bar, ThreadPoolExecutor(threads or os.cpu_count()) as pool:
            cases = [pool.submit(self.solve, case) for case in range(len(self))]
            try:
                for case in cases:
                    finished.append(case.result())
                    if bar.report is not None:
                        bar.report(len(finished))
            except BaseException as error:
                # Cases that run already are waited for, the others are not begun.
                pool.shutdown(wait=False, cancel_futures=True)
                stopped = error
        return ended(self.table(finished), stopped)

    def table(self, finished: Iterable[str]) -> StudyTable:
        """The table of finished cases, the same whatever their order."""
        return StudyTable(self._native, list(finished))


def _arrived(text: str, base: str, name: str, fingerprint: str) -> Study:
    """A study that travelled."""
    study = Study.__new__(Study)
    study._text, study._base, study._name = text, Path(base), name
    study._native = _native.Study(text, base, name)
    if study.fingerprint != fingerprint:
        raise SceneError(
            f"the study in {base} is another one here: its scene, a record or the version of stickslip differs between machines"
        )
    return study


class StudyTable:
    """The result of a study: one row a point or a maximum."""

    def __init__(self, native: _native.Study, finished: list[str]) -> None:
        self._native = native
        self._finished = finished

    def to_csv(self) -> str:
        """As ``stickslip study -o FILE.csv`` writes it."""
        return self._native.table(self._finished, "csv")

    @property
    def data(self) -> dict[str, Any]:
        """As ``stickslip study -o FILE.json`` writes it."""
        data: dict[str, Any] = json.loads(self._native.table(self._finished, "json"))
        return data

    def to_dataframe(self) -> pd.DataFrame:
        """One row a point or a maximum. Needs pandas."""
        import io

        import pandas as pd

        return pd.read_csv(io.StringIO(self.to_csv()))
