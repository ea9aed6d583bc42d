from pathlib import Path

import pytest

SCENES = Path(__file__).resolve().parents[3] / "scenes"


@pytest.fixture
def scenes() -> Path:
    return SCENES


def oscillator(law: object, *, damping: float = 0.1, amplitude: float = 1.0, harmonics: int = 1) -> dict:
    """One mass of 1 kg on a spring of 1 N/m, with a contact to the ground."""
    return {
        "name": "oscillator",
        "model": {"dofs": ["x"], "mass": [[1.0]], "damping": [[damping]], "stiffness": [[1.0]]},
        "excitation": [{"dof": "x", "harmonic": 1, "amplitude": amplitude}],
        "contacts": [{"name": "c", "between": ["x", "ground"], "law": law}],
        "frequencies": [0.1, 0.15, 0.2],
        "harmonics": harmonics,
    }
