"""The example scenes, which are part of the package."""

from __future__ import annotations

from pathlib import Path

from ._errors import SceneError
from ._scene import Scene

_FOLDER = Path(__file__).parent / "scenes"


def examples() -> list[str]:
    """Names of the example scenes."""
    return sorted(path.stem for path in _FOLDER.glob("*.json"))


def example(name: str) -> Scene:
    """An example scene: ``two-mass``, ``elastic-coulomb``, ``cubic``, and of the paper's Fig. 4 ``hoffmann-2017`` with the measured
    loop and ``hoffmann-2017-elastic-coulomb``.

    Raises
    ------
    SceneError
        When there is none of that name.
    """
    if name not in examples():
        raise SceneError(f"there is no example {name!r}; there are {', '.join(examples())}")
    return Scene(_FOLDER / f"{name}.json")
