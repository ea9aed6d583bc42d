"""Studies on a Dask cluster: ``stickslip.dask.run(study, client)``.

Every case is a task of its own, so that a worker that is lost costs the cases it was at, which the others take over. The table is the
same as that of one machine.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ._scene import Progress, _Bar
from ._study import Study, StudyTable

if TYPE_CHECKING:
    from distributed import Client

__all__ = ["run"]


def run(study: Study, client: Client, *, retries: int = 3, progress: Progress = None) -> StudyTable:
    """Solves the cases of ``study`` on the workers of ``client``.

    Parameters
    ----------
    study
        Its files must be found under the same path by every worker.
    client
        A ``dask.distributed.Client``.
    retries
        How often a case is tried again that raised an exception; cases of lost workers are always solved again.
    progress
        As in :meth:`stickslip.Scene.sweep`.

    Raises
    ------
    StickslipError
        What a case raised after all retries.
    """
    from distributed import as_completed

    shared = client.scatter(study, broadcast=True)
    # Pure by default would make tasks of equal studies equal: keys by fingerprint, so that results are found again.
    keys = [f"stickslip-{study.fingerprint}-{case}" for case in range(len(study))]
    tasks = [
        client.submit(_solve, shared, case, key=key, retries=retries) for case, key in enumerate(keys)
    ]
    finished: list[str] = []
    with _Bar(progress, len(study), "cases") as bar:
        for task in as_completed(tasks):
            finished.append(task.result())
            if bar.report is not None:
                bar.report(len(finished))
    return study.table(finished)


def _solve(study: Study, case: int) -> str:
    return study.solve(case)
