"""What the command line writes, read by NumPy and pandas and compared with its JSON and CSV."""

import json
import os
import subprocess

import numpy as np
import pandas as pd
import pytest

COMMAND = os.environ.get("STICKSLIP_COMMAND")
pytestmark = pytest.mark.skipif(COMMAND is None, reason="STICKSLIP_COMMAND names the program to test")


def run(folder, *arguments):
    done = subprocess.run([COMMAND, *map(str, arguments)], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr


def assert_is_table(columns, path):
    """Columns by name against the same table as CSV, digit by digit."""
    text = pd.read_csv(path, dtype=str, keep_default_na=False)
    assert list(columns) == list(text.columns)
    assert len(text) > 1
    for name, words in text.items():
        values = np.asarray(columns[name])
        assert len(values) == len(words), name
        if values.dtype == bool:
            assert values.tolist() == [word == "1" for word in words], name
        elif np.issubdtype(values.dtype, np.number):
            missing = np.isnan(values) | ((values == -1) & np.issubdtype(values.dtype, np.integer))
            assert missing.tolist() == [word == "" for word in words], name
            assert values[~missing].tolist() == [float(word) for word in words if word], name
        else:
            assert ["" if word is None or word != word else word for word in values.tolist()] == words.tolist(), name


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    from conftest import SCENES

    folder = tmp_path_factory.mktemp("results")
    for name in ("x.json", "x.csv", "x.npz", "x.parquet"):
        run(folder, "sweep", SCENES / "elastic-coulomb.json", "--frequencies", "20:120:11", "--harmonics", "7", "-o", name)
    return folder


def test_arrays_hold_what_json_says(results):
    points = json.loads((results / "x.json").read_text())["points"]
    with np.load(results / "x.npz") as arrays:
        assert arrays["scene"] == "elastic-coulomb"
        assert arrays["units"] == "SI, Hz, rad"
        assert arrays["dofs"].tolist() == list(points[0]["displacement"])
        assert arrays["status"].tolist() == [point["status"] for point in points]
        assert arrays["converged"].dtype == bool and arrays["converged"].all()
        for key in ("frequency", "harmonics", "iterations", "residual", "truncation_error", "sampling_error"):
            assert arrays[key].tolist() == [point[key] for point in points], key
        assert arrays["solutions"].tolist() == [point["solutions"] or -1 for point in points]

        def spectra(table, parts):
            expected = np.zeros((len(points), len(parts), table.shape[2]), complex)
            for p, spectrum in enumerate(parts_of for parts_of in zip(*parts)):
                for row, lines in enumerate(spectrum):
                    for k, re, im in lines:
                        expected[p, row, k] = complex(re, im)
            np.testing.assert_array_equal(table, expected)

        assert arrays["W"].shape == (11, 2, 8)
        spectra(arrays["W"], [[point["displacement"][dof] for point in points] for dof in arrays["dofs"].tolist()])
        names = arrays["contacts"].tolist()
        contacts = [[point["contacts"][name] for name in names] for point in points]
        for key in ("state", "dissipation", "extrapolated"):
            assert arrays[f"contact_{key}"].tolist() == [[one[key] for one in row] for row in contacts]
        assert arrays["contact_direction"].tolist() == names
        assert arrays["contact_amplitude"].tolist() == [[one["amplitude"] for one in row] for row in contacts]
        spectra(arrays["contact_force"], [[row[c]["force"] for row in contacts] for c in range(len(names))])


def test_contacts_in_several_directions_have_a_row_each(tmp_path):
    from conftest import SCENES

    run(tmp_path, "sweep", SCENES / "shroud.json", "--frequencies", "100,120", "--harmonics", "3", "-o", "x.npz")
    run(tmp_path, "sweep", SCENES / "shroud.json", "--frequencies", "100,120", "--harmonics", "3", "-o", "x.json")
    points = json.loads((tmp_path / "x.json").read_text())["points"]
    with np.load(tmp_path / "x.npz") as arrays:
        expected = [
            f"{name}.{direction}" if "directions" in contact else name
            for name, contact in points[0]["contacts"].items()
            for direction in contact.get("directions", [""])
        ]
        assert arrays["contact_direction"].tolist() == expected
        assert any("." in name for name in expected)
        for p, point in enumerate(points):
            amplitudes = [
                direction["amplitude"]
                for contact in point["contacts"].values()
                for direction in contact.get("directions", {"": contact}).values()
            ]
            assert arrays["contact_amplitude"][p].tolist() == amplitudes


def test_parquet_is_the_table_of_csv(results):
    table = pd.read_parquet(results / "x.parquet", engine="pyarrow")
    assert_is_table(table, results / "x.csv")
    assert table["re"].dtype == float and table["harmonic"].dtype == np.int64
    import pyarrow.parquet

    about = pyarrow.parquet.read_metadata(results / "x.parquet").metadata
    assert about[b"stickslip.scene"] == b"elastic-coulomb"
    assert about[b"stickslip.units"] == b"SI, Hz, rad"
    assert b"stickslip.version" in about


def test_a_table_of_several_pages(tmp_path):
    from conftest import SCENES

    for name in ("x.csv", "x.parquet"):
        frequencies = ("--frequencies", "20:120:2200", "--harmonics", "31")
        run(tmp_path, "sweep", SCENES / "elastic-coulomb.json", *frequencies, "-o", name)
    table = pd.read_parquet(tmp_path / "x.parquet", engine="pyarrow")
    assert len(table) > 1 << 16
    assert_is_table(table, tmp_path / "x.csv")


def test_tables_of_every_command(tmp_path):
    from conftest import SCENES

    study = {
        "scene": str(SCENES / "elastic-coulomb.json"),
        "vary": {"/excitation/0/amplitude": [5, 10]},
        "frequencies": {"from": 40, "to": 110, "points": 15},
        "harmonics": [1, 3],
        "keep": "peaks",
    }
    (tmp_path / "study.json").write_text(json.dumps(study))
    scene = SCENES / "elastic-coulomb.json"
    commands = {
        "study": ["study", "study.json"],
        "backbone": ["backbone", scene, "--points", "12", "--harmonics", "1"],
        "continue": ["continue", SCENES / "cubic.json", "--harmonics", "1", "--from", "35", "--to", "50"],
    }
    for name, command in commands.items():
        for extension in ("csv", "parquet", "npz"):
            run(tmp_path, *command, "-o", f"{name}.{extension}")
        assert_is_table(pd.read_parquet(tmp_path / f"{name}.parquet", engine="pyarrow"), tmp_path / f"{name}.csv")
        with np.load(tmp_path / f"{name}.npz") as arrays:
            if name != "continue":
                assert_is_table(arrays, tmp_path / f"{name}.csv")
                continue
            assert arrays["fold"].dtype == bool and arrays["fold"].any()
            assert arrays["parameter"].shape == arrays["frequency"].shape
            assert arrays["peak"].shape == arrays["W"].shape[:2]
            assert arrays["along"] == "frequency"
