"""Work that was stopped keeps what is finished."""

from __future__ import annotations

import contextlib
from typing import TypeVar

Answer = TypeVar("Answer")


def finished(answer: Answer, stopped: BaseException | None) -> Answer:
    """The answer; or, when Ctrl-C or a progress function ended the work early, that exception with the answer as ``partial``."""
    if stopped is None:
        return answer
    # An exception of somebody else's may have no room for it.
    with contextlib.suppress(AttributeError):
        stopped.partial = answer  # type: ignore[attr-defined]
        if hasattr(stopped, "add_note"):
            stopped.add_note("stickslip: what was finished before is the attribute `partial` of this exception")
    raise stopped
