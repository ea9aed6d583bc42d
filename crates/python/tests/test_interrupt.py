"""What ends work early carries what is finished. A progress function ends it at a known point; a signal takes the same way."""

import json
import os
import signal
import sys

import numpy as np
import pytest
import stickslip
from conftest import oscillator

JENKINS = {"type": "elastic_coulomb", "stiffness": 1.0, "slip_force": 0.3}


def test_ctrl_c_keeps_the_finished_points():
    scene = stickslip.Scene(oscillator(JENKINS, harmonics=255))
    frequencies = np.linspace(0.05, 0.3, 100_000)

    # Pressed when some points are finished, long before all are.
    def press(count):
        os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt) as stopped:
        scene.sweep(frequencies, progress=press, threads=1)
    partial = stopped.value.partial
    assert isinstance(partial, stickslip.Result)
    done = len(partial)
    assert 0 < done < frequencies.size
    assert any(f"stopped after {done} of {frequencies.size} points" in note for note in partial.notes)
    if sys.version_info >= (3, 11):
        assert any("partial" in note for note in stopped.value.__notes__)
    # They are the same as without an interruption.
    assert np.array_equal(partial.frequency, frequencies[:done])
    again = scene.sweep(frequencies[:5])
    assert np.array_equal(partial.displacement[:5], again.displacement)


def test_a_progress_function_that_raises_keeps_them_too():
    def refuse(_count):
        raise RuntimeError("enough")

    scene = stickslip.Scene(oscillator(JENKINS, harmonics=255))
    with pytest.raises(RuntimeError, match="enough") as stopped:
        scene.sweep(np.linspace(0.05, 0.3, 100_000), progress=refuse, threads=1)
    assert 0 < len(stopped.value.partial) < 100_000


def test_a_truncation_table_keeps_its_frequencies():
    def refuse(_count):
        raise RuntimeError("enough")

    scene = stickslip.Scene(oscillator(JENKINS))
    frequencies = np.linspace(0.05, 0.3, 2000)
    with pytest.raises(RuntimeError) as stopped:
        scene.truncation([1, 3], frequencies, progress=refuse)
    partial = stopped.value.partial
    assert 0 < len(set(partial.frequency)) < 2000


def test_a_study_keeps_its_cases(tmp_path):
    scene = oscillator(JENKINS)
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    grid = {"scene": "scene.json", "vary": {"/contacts/0/law/slip_force": [0.2, 0.3, 0.4, 0.5]}, "keep": "points"}

    def refuse(count):
        if count == 2:
            raise RuntimeError("enough")

    study = stickslip.Study(grid, tmp_path)
    with pytest.raises(RuntimeError, match="enough") as stopped:
        study.run(progress=refuse, threads=1)
    partial = stopped.value.partial
    assert not partial.data["complete"]
    # The first two cases of four, as they are in the whole table.
    whole, lines = study.run().to_csv().splitlines(), partial.to_csv().splitlines()
    assert lines == whole[: len(lines)] and len(lines) == 1 + (len(whole) - 1) // 2
