import numpy as np
import pytest
import stickslip
from conftest import oscillator


def scene(law, harmonics=5):
    with pytest.warns(RuntimeWarning, match="interpreter"):
        return stickslip.Scene(oscillator(law, harmonics=harmonics))


def test_a_cubic_spring_in_python_is_the_cubic_spring():
    law = stickslip.PythonLaw(lambda w, v: 0.2 * w**3, length=1.0, determines_mean=True)
    own = stickslip.Scene(oscillator({"type": "cubic", "stiffness": 0.2}, harmonics=5)).sweep()
    python = scene(law).sweep()
    assert python.converged.all()
    # Both sample a polynomial without aliasing; iterations end at 1e-10.
    np.testing.assert_allclose(python.displacement, own.displacement, rtol=0, atol=1e-9)


def test_velocities_are_in_metres_a_second():
    law = stickslip.PythonLaw(lambda w, v: 0.3 * v, length=1.0)
    result = scene(law, harmonics=1).sweep()
    omega = 2 * np.pi * result.frequency
    np.testing.assert_allclose(result.spectrum()[:, 0], 1 / (1 - omega**2 + 0.4j * omega), rtol=1e-8)


def test_what_a_law_raises_arrives():
    def broken(w, v):
        raise ZeroDivisionError("my own mistake")

    with pytest.raises(ZeroDivisionError, match="my own mistake"):
        scene(stickslip.PythonLaw(broken, length=1.0)).sweep()


@pytest.mark.parametrize("answer", [lambda w, v: w[:-1], lambda w, v: 1.0])
def test_answers_of_the_wrong_shape_are_refused(answer):
    with pytest.raises(stickslip.StickslipError, match="a law must answer"):
        scene(stickslip.PythonLaw(answer, length=1.0)).sweep()


def test_a_length_must_be_positive():
    with pytest.raises(stickslip.SceneError, match="length"):
        stickslip.Scene(oscillator(stickslip.PythonLaw(lambda w, v: w, length=0.0)))
