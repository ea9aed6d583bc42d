import json

import pytest
import stickslip


def test_examples_are_those_of_the_repository(scenes):
    assert stickslip.examples() == ["cubic", "elastic-coulomb", "hoffmann-2017", "hoffmann-2017-elastic-coulomb", "two-mass"]
    for name in stickslip.examples():
        own = json.loads((scenes / f"{name}.json").read_text())
        assert stickslip.example(name).data == own
    with pytest.raises(stickslip.SceneError, match="there are cubic"):
        stickslip.example("cubi")


def test_the_paper_s_figure_needs_nothing_but_the_package(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    measured, coulomb = (stickslip.example(name) for name in ("hoffmann-2017", "hoffmann-2017-elastic-coulomb"))
    for scene in (measured, coulomb):
        assert scene.sweep([50.0, 107.4]).converged.all()


def test_schemas_are_json():
    titles = [json.loads(text)["title"] for text in (stickslip.SCENE_SCHEMA, stickslip.STUDY_SCHEMA)]
    assert titles == ["stickslip scene", "stickslip study"]
