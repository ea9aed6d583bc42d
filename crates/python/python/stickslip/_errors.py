"""The exceptions, under one base class."""

from ._native import LoopError, SceneError, SolveError, StickslipError

__all__ = ["LoopError", "SceneError", "SolveError", "StickslipError"]
