import json
import os
import pickle
import signal
import time

import pytest
import stickslip
from conftest import oscillator

JENKINS = {"type": "elastic_coulomb", "stiffness": 1.0, "slip_force": 0.3}


@pytest.fixture
def study(tmp_path):
    scene = oscillator(JENKINS, harmonics=7)
    scene["frequencies"] = {"from": 0.1, "to": 0.3, "points": 41}
    (tmp_path / "scene.json").write_text(json.dumps(scene))
    grid = {
        "scene": "scene.json",
        "vary": {
            "/excitation/0/amplitude": {"from": 0.5, "to": 2.0, "points": 6},
            "/contacts/0/law/slip_force": [0.2, 0.4],
        },
        "harmonics": [1, 7],
        "keep": "peaks",
    }
    (tmp_path / "study.json").write_text(json.dumps(grid))
    return stickslip.Study(tmp_path / "study.json")


def test_a_study_is_the_sweeps_of_its_cases(study, tmp_path):
    table = study.run(threads=2).to_dataframe()
    assert len(study) == 24
    scene = stickslip.Scene(tmp_path / "scene.json")
    row = table[(table["harmonics"] == 7) & (table["peak"] == "highest")].iloc[0]
    amplitude, slip = row["/excitation/0/amplitude"], row["/contacts/0/law/slip_force"]
    one = scene.replace("/excitation/0/amplitude", amplitude).replace("/contacts/0/law/slip_force", slip)
    highest = one.sweep()
    assert row["frequency"] == pytest.approx(highest.frequency[highest.contacts["c"].amplitude.argmax()])
    assert row["amplitude"] == pytest.approx(highest.contacts["c"].amplitude.max(), rel=1e-3)


def test_order_and_repetition_do_not_matter(study):
    cases = [study.solve(case) for case in range(len(study))]
    assert study.table(cases[::-1] + cases[:3]).to_csv() == study.run().to_csv()
    assert study.table(cases).data["complete"] and not study.table(cases[1:]).data["complete"]
    with pytest.raises(stickslip.StickslipError, match="no case 24"):
        study.solve(24)


def test_a_study_travels_with_its_fingerprint(study, tmp_path):
    packed = pickle.dumps(study)
    assert pickle.loads(packed).solve(3) == study.solve(3)
    (tmp_path / "scene.json").write_text((tmp_path / "scene.json").read_text() + "\n")
    with pytest.raises(stickslip.SceneError, match="differs between machines"):
        pickle.loads(packed)


@pytest.mark.filterwarnings("ignore")
def test_a_killed_worker_changes_nothing(study):
    distributed = pytest.importorskip("distributed")
    import stickslip.dask

    expected = study.run().to_csv()
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        workers = client.run(os.getpid)
        assert len(workers) == 2
        told = []

        def progress(count):
            told.append(count)
            if count == 5:
                os.kill(next(iter(workers.values())), signal.SIGKILL)
                time.sleep(0.5)

        table = stickslip.dask.run(study, client, progress=progress)
        assert told[-1] == len(study)
        assert client.run(os.getpid).keys() != workers.keys()
    assert table.to_csv() == expected
