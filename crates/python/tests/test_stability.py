import numpy as np
import pytest
import stickslip
from conftest import oscillator


def test_multipliers_of_a_linear_oscillator_are_its_closed_form():
    scene = stickslip.Scene(oscillator({"type": "linear", "stiffness": 0.5}))
    result = scene.sweep(stability=True)
    # exp(s T) of the roots of s^2 + 0.1 s + 1.5.
    roots = np.roots([1.0, 0.1, 1.5])
    for period, multipliers in zip(1 / result.frequency, result.multipliers, strict=True):
        np.testing.assert_allclose(
            np.sort_complex(multipliers), np.sort_complex(np.exp(roots * period)), rtol=0, atol=1e-9
        )
    assert result.stable == [True] * 3 and not result.unstable.any()
    assert result.stability_error.max() < 1e-6


def test_nothing_is_said_that_was_not_asked_for():
    result = stickslip.Scene(oscillator({"type": "linear", "stiffness": 0.5})).sweep()
    assert result.stable == [None] * 3 and not result.unstable.any()
    assert result.multipliers.shape == (3, 0) and np.isnan(result.stability_error).all()


def test_a_curve_is_unstable_between_its_folds():
    curve = stickslip.example("cubic").continue_(stability=True)
    first, second = np.flatnonzero(curve.fold)
    # A point that is a fold has a multiplier of one: undecided.
    between = np.arange(len(curve))[first + 1 : second]
    outside = np.r_[: first, second + 1 : len(curve)]
    assert between.size > 2 and curve.unstable[between].all()
    assert all(curve.stable[i] for i in outside)


def test_friction_is_judged_by_its_orbit():
    law = {"type": "elastic_coulomb", "stiffness": 1.0, "slip_force": 0.3}
    result = stickslip.Scene(oscillator(law, harmonics=31)).sweep([0.15], stability=True)
    assert result.stable == [True] and result.data["points"][0]["stability"]["method"] == "orbit"
