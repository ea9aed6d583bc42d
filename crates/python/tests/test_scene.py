import json
import threading
import time

import numpy as np
import pytest
import stickslip
from conftest import oscillator

LINEAR = {"type": "linear", "stiffness": 0.5}
JENKINS = {"type": "elastic_coulomb", "stiffness": 1.0, "slip_force": 0.3}


def test_a_linear_oscillator_is_its_closed_form():
    result = stickslip.Scene(oscillator(LINEAR)).sweep()
    omega = 2 * np.pi * result.frequency
    exact = 1.0 / (1.5 - omega**2 + 0.1j * omega)
    assert result.orders.tolist() == [1]
    assert result.displacement.shape == (3, 1, 1)
    np.testing.assert_allclose(result.spectrum()[:, 0], exact, rtol=1e-13)
    np.testing.assert_allclose(result.contacts["c"].amplitude, np.abs(exact), rtol=1e-13)


def test_one_harmonic_of_a_jenkins_element_balances():
    result = stickslip.Scene(oscillator(JENKINS)).sweep()
    a = result.amplitude()
    # Describing function of the element, textbook form: theta is the phase at which it slips again.
    theta = np.arccos(1 - 2 * 0.3 / a)
    force = (a / np.pi) * (theta - 0.5 * np.sin(2 * theta) + 1j * np.sin(theta) ** 2)
    omega = 2 * np.pi * result.frequency
    balance = (1 - omega**2 + 0.1j * omega) * a + force
    np.testing.assert_allclose(np.abs(balance), 1.0, rtol=1e-11)


def test_the_exact_orbit_agrees_with_time_integration():
    integrate = pytest.importorskip("scipy.integrate")
    orbit = stickslip.Scene(oscillator(JENKINS)).orbit(0.15)
    omega = 2 * np.pi * 0.15

    # One period from the orbit's own state, with the slider where the orbit has it.
    def rates(t, y):
        x, v, f = y
        slips = abs(f) >= 0.3 and f * v > 0
        return [v, np.cos(omega * t) - 0.1 * v - x - f, 0.0 if slips else v]

    start = [orbit.displacement[0, 0], orbit.velocity[0, 0], -orbit.contact_force[0, 0]]
    run = integrate.solve_ivp(rates, (0, orbit.period), start, max_step=orbit.period / 20000, rtol=1e-8, atol=1e-10)
    assert np.allclose(run.y[:, -1], start, atol=2e-4)


def test_orbit_and_many_harmonics_agree():
    scene = stickslip.Scene(oscillator(JENKINS, harmonics=127))
    orbit = scene.orbit(0.15, harmonics=5)
    result = scene.sweep(frequencies=[0.15])
    first = result.spectrum()[0, result.orders == 1][0]
    assert abs(orbit.spectrum[0, 1] - first) < 1e-6 * abs(first)
    table = scene.truncation([1, 7, 31], frequencies=[0.15])
    assert table.reference == "orbit"
    assert np.all(np.diff(table.error) < 0) and table.error[-1] < 1e-4


def test_the_paper_scene_from_its_file(scenes):
    scene = stickslip.Scene(scenes / "hoffmann-2017.json")
    result = scene.sweep(harmonics=1)
    assert result.converged.all() and len(result) == len(scene.frequencies)
    # The paper: the second resonance falls by about half a hertz from 108 Hz.
    assert result.frequency[np.argmax(result.amplitude("w1"))] == pytest.approx(107.4, abs=0.6)
    assert all("why" in step._fields for step in scene.explain())


def test_threads_do_not_matter():
    scene = stickslip.Scene(oscillator(JENKINS, harmonics=7))
    frequencies = np.linspace(0.1, 0.3, 101)
    one, two = (scene.sweep(frequencies, threads=n) for n in (1, 2))
    assert np.array_equal(one.displacement, two.displacement)


def test_variants_and_numpy_in_dicts():
    data = oscillator(LINEAR)
    data["model"]["stiffness"] = np.array([[1.0]])
    data["frequencies"] = np.linspace(0.1, 0.2, 3)
    scene = stickslip.Scene(data).replace("/contacts/0/law/stiffness", 3.0)
    omega = 2 * np.pi * scene.frequencies
    np.testing.assert_allclose(scene.sweep().spectrum()[:, 0], 1.0 / (4 - omega**2 + 0.1j * omega), rtol=1e-13)
    with pytest.raises(stickslip.SceneError, match="nothing at /contacts/1"):
        scene.replace("/contacts/1/law/stiffness", 3.0)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"contacts": [{"name": "c", "between": ["x", "ground"], "law": {**JENKINS, "slip_force": -1}}]}, "slip_force"),
        ({"frequencies": []}, "frequencies"),
        ({"modle": {}}, "modle"),
    ],
)
def test_mistakes_are_named(change, says):
    with pytest.raises(stickslip.SceneError, match=says):
        stickslip.Scene({**oscillator(LINEAR), **change})
    assert issubclass(stickslip.SceneError, stickslip.StickslipError)


def test_a_missing_file_is_a_scene_error(tmp_path):
    with pytest.raises(stickslip.SceneError, match="nowhere.json"):
        stickslip.Scene(tmp_path / "nowhere.json")


def test_curves_pass_folds(scenes):
    curve = stickslip.Scene(scenes / "cubic.json").continue_()
    folds = np.sort(curve.parameter[curve.fold])
    assert curve.reached and folds.size == 2
    # Folds near 43.219 and 43.262 Hz.
    np.testing.assert_allclose(folds, [43.219, 43.262], atol=2e-3)


def test_backbones(scenes):
    mode = stickslip.Scene(scenes / "hoffmann-2017-elastic-coulomb.json").backbone(points=12, harmonics=1)
    assert mode.status.count("converged") == len(mode)
    # A stuck contact is linear: frequency and damping do not change.
    assert mode.frequency[0] == pytest.approx(mode.frequency[1], rel=1e-9)
    # From point to point the mode changes little: it stays on its branch.
    assert np.abs(np.diff(mode.damping_ratio)).max() < 0.1


def test_results_are_saved_and_shown(tmp_path):
    pandas = pytest.importorskip("pandas")
    result = stickslip.Scene(oscillator(JENKINS, harmonics=3)).sweep()
    result.save(tmp_path / "result.json")
    assert json.loads((tmp_path / "result.json").read_text()) == result.data
    table = result.to_dataframe()
    assert isinstance(table, pandas.DataFrame) and len(table) == 3
    np.testing.assert_array_equal(table["amplitude x"], result.amplitude())
    time, w = result.waveform(1, samples=64)
    assert time[0] == 0 and 2 * np.abs(np.fft.rfft(w)[1]) / 64 == pytest.approx(result.amplitude()[1])


def test_results_are_drawn():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    result = stickslip.Scene(oscillator(JENKINS)).sweep()
    (line,) = result.plot().lines
    np.testing.assert_array_equal(line.get_ydata(), result.amplitude())


def test_progress_is_told_and_the_lock_released():
    scene = stickslip.Scene(oscillator(JENKINS, harmonics=255))
    told, beats, stop = [], [0], threading.Event()

    def beat():
        while not stop.is_set():
            beats[0] += 1
            time.sleep(1e-3)

    heart = threading.Thread(target=beat)
    heart.start()
    scene.sweep(np.linspace(0.05, 0.3, 4000), progress=told.append, threads=1)
    stop.set()
    heart.join()
    assert told[-1] == 4000 and told == sorted(told)
    assert beats[0] > 10


def test_a_progress_function_that_raises_ends_the_sweep():
    scene = stickslip.Scene(oscillator(JENKINS, harmonics=255))

    def refuse(_count):
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        scene.sweep(np.linspace(0.05, 0.3, 4000), progress=refuse)
