"""Forced response with measured friction loops by multi-harmonic balance.

Scenes are what the command line takes: a file, or a dict of the same form. Everything is in SI units, frequencies in Hz, phases in
rad; harmonics are one-sided complex amplitudes, ``w(t) = Re sum_k W_k exp(i k 2 pi f t)``.

>>> scene = example("hoffmann-2017")            # or Scene("my-scene.json")
>>> result = scene.sweep(harmonics=7)
>>> result.amplitude("w2").max()
"""

from ._errors import LoopError, SceneError, SolveError, StickslipError
from ._example import example, examples
from ._loops import Loop, Scaling, scale
from ._native import SCENE_SCHEMA, STUDY_SCHEMA, __version__
from ._peaks import Optimum, Peaks, PeaksCurve
from ._result import Backbone, Contact, Curve, Direction, Joint, Orbit, Result, Truncation
from ._scene import PythonLaw, Scene, Step
from ._study import Study, StudyTable

__all__ = [
    "Backbone",
    "Contact",
    "Curve",
    "Direction",
    "Joint",
    "Loop",
    "LoopError",
    "Optimum",
    "Orbit",
    "Peaks",
    "PeaksCurve",
    "PythonLaw",
    "Result",
    "SCENE_SCHEMA",
    "STUDY_SCHEMA",
    "Scaling",
    "Scene",
    "SceneError",
    "SolveError",
    "Step",
    "StickslipError",
    "Study",
    "StudyTable",
    "Truncation",
    "__version__",
    "example",
    "examples",
    "scale",
]
