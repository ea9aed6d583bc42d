import numpy as np
import pytest
import stickslip
from conftest import oscillator

SLIP_FORCE = "/contacts/0/law/slip_force"
VISCOUS = {"type": "linear", "stiffness": 0.5}


def test_the_peak_of_a_linear_oscillator_is_its_closed_form():
    scene = stickslip.Scene(oscillator(VISCOUS, damping=0.2))
    peaks = scene.peaks("/contacts/0/law/stiffness", 0.2, 0.8, points=4, frequencies=[0.1, 0.3])
    (curve,) = peaks.curves
    # |W| = 1 / sqrt((k - w^2)^2 + (c w)^2) has its largest value 1 / (c sqrt(k - c^2 / 4)) at w^2 = k - c^2 / 2.
    stiffness = 1.0 + curve.parameter
    np.testing.assert_allclose(curve.amplitude, 1 / (0.2 * np.sqrt(stiffness - 0.01)), rtol=1e-9)
    # Where a maximum lies is known to the root of what its height is known to.
    np.testing.assert_allclose(2 * np.pi * curve.frequency, np.sqrt(stiffness - 0.02), rtol=1e-6)
    assert curve.reached and peaks.optimum is not None
    # The stiffer, the lower: the optimum is the end of the range.
    assert (peaks.optimum.kind, peaks.optimum.parameter) == ("end", pytest.approx(0.8))


def test_the_best_slip_force_is_where_a_sweep_has_its_lowest_peak():
    scene = stickslip.example("elastic-coulomb")
    peaks = scene.peaks(SLIP_FORCE, 5.0, 40.0, log=True, points=5, harmonics=[1, 3])
    assert [curve.harmonics for curve in peaks.curves] == [1, 3]
    best = peaks.curves[0].optimum
    assert best is not None and peaks.optimum is peaks.curves[1].optimum
    near = best.frequency + np.linspace(-0.5, 0.5, 2001)
    highest = scene.replace(SLIP_FORCE, best.parameter).sweep(near, harmonics=1).amplitude(peaks.dof).max()
    # The nearest of the sweep's frequencies is within 0.25 mHz of the peak, where the response is flat.
    assert highest == pytest.approx(best.amplitude, rel=1e-6)
    (curve, _) = peaks.curves
    for i in (0, 1, -2, -1):
        every = scene.replace(SLIP_FORCE, curve.parameter[i]).sweep(np.linspace(40, 120, 8001), harmonics=1)
        highest = every.amplitude(peaks.dof).max()
        # The sweep's step of 10 mHz may miss some of the top, and finds nothing above it.
        assert 0.99 * curve.amplitude[i] < highest <= curve.amplitude[i] * (1 + 1e-9)
        assert curve.amplitude[i] > best.amplitude
    pytest.importorskip("pandas")
    table = peaks.to_dataframe()
    assert len(table) == sum(len(curve.parameter) for curve in peaks.curves)
    assert set(table["harmonics"]) == {1, 3}


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("/contacts/0/law/slip_forc", 1, 2), "slip_forc"),
        (("/harmonics", 1, 2), "no curve over it"),
        ((SLIP_FORCE, 2, 1), "must grow"),
        ((SLIP_FORCE, -1, 1), "slip_force = -1"),
    ],
)
def test_mistakes_are_named(arguments, says):
    with pytest.raises(stickslip.SceneError, match=says):
        stickslip.example("elastic-coulomb").peaks(*arguments)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_law_in_python_has_no_variants():
    scene = stickslip.Scene(oscillator(stickslip.PythonLaw(lambda w, v: w, length=1.0)))
    with pytest.raises(stickslip.SceneError, match="PythonLaw"):
        scene.peaks("/excitation/0/amplitude", 1, 2)
    with pytest.raises(stickslip.SceneError, match="PythonLaw"):
        scene.continue_(1, 2, along="/excitation/0/amplitude", at=0.1)
