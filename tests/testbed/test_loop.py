"""``diagnosis.json`` has the keys that people's scripts read, and the updated rig holds what was found."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
from made_up_diagnosis import made_up_diagnosis, made_up_record

from identification.result import Estimate
from models.plant import build_plant
from models.rig_file import read_rig, write_rig
from testbed.loop import diagnose_to_json, diagnosis_json, updated_rig
from testbed.outputs import json_text

REFERENCE = Path(__file__).parents[1] / "data" / "reference_rig.toml"
KEYS = [
    "verdict", "effects", "candidates", "candidates_beside", "indistinguishable", "error", "holdout", "where",
    "next_experiment", "seconds",
]  # fmt: skip


@pytest.fixture(scope="module")
def rig():
    return read_rig(REFERENCE)


@pytest.fixture(scope="module")
def content(rig):
    return json.loads(json_text(diagnosis_json(made_up_diagnosis(rig))))


def test_the_keys_are_those_of_the_format(content):
    assert list(content) == KEYS


def test_an_added_effect_tells_its_place_its_probability_and_its_intervals(content):
    assert content["effects"] == [
        {
            "kind": "squeeze_film",
            "sleeve": "sleeve 2",
            "probability": 0.97,
            "parameters": {"damping": {"value": 18.5, "std": 0.4, "unit": "N s/m"}},
        }
    ]


def test_a_candidate_carries_its_options_and_its_position(content):
    assert content["candidates"][1] == {
        "kind": "coulomb_friction",
        "position": 0.95,
        "against": "ground",
        "probability": 0.02,
        "nrmse": 0.05,
    }


def test_what_cannot_be_told_apart_stands_in_groups(content):
    masses = [{"kind": "point_mass", "position": 0.95}, {"kind": "point_mass", "position": 1.15}]
    assert content["indistinguishable"] == [masses]


def test_the_error_falls_from_model_to_model(content):
    assert [(row["model"], row["nrmse"]) for row in content["error"]] == [
        ("as given", 0.30),
        ("calibrated", 0.24),
        ("+ squeeze_film at sleeve 2", 0.0071),
    ]
    assert ["times_noise" in row for row in content["error"]] == [False, False, True]
    assert content["error"][-1]["times_noise"] == 1.02
    assert content["holdout"] == {"as given": 0.28, "updated": 0.0074, "noise_nrmse": 0.007}


def test_where_names_the_worst_sensor_band_and_window(content):
    worst = content["where"]["records"][0]
    assert (worst["sensor"]["name"], worst["band"]["frequency"], worst["window"]["time"]) == ("P8", 20.0, 3.0)
    assert content["where"]["forces"][0]["largest_at"] == 0.5
    assert content["where"]["forces"][0]["rms"] == pytest.approx(0.3)


def test_an_interval_without_end_is_null_and_not_infinity(rig):
    diagnosis = made_up_diagnosis(rig)
    loose = replace(diagnosis.added[0], estimates=(Estimate("damping", 18.5, float("inf"), "N s/m"),))
    text = json_text(diagnosis_json(replace(diagnosis, added=(loose,))))
    assert json.loads(text)["effects"][0]["parameters"]["damping"]["std"] is None


def test_without_records_kept_aside_the_holdout_is_empty(rig):
    assert diagnosis_json(replace(made_up_diagnosis(rig), holdout={}))["holdout"] == {}


def test_the_updated_rig_is_read_back_and_simulates_what_was_found(rig, tmp_path):
    updated = updated_rig(made_up_diagnosis(rig))
    write_rig(updated, tmp_path / "rig.updated.toml", like=REFERENCE)
    read = read_rig(tmp_path / "rig.updated.toml")
    assert read == updated
    assert read.structure.youngs_modulus == 211e9
    assert build_plant(read).effects[0].damping == 18.5
    assert "# Pa" in (tmp_path / "rig.updated.toml").read_text()


def test_a_benchmark_gets_the_json_of_the_diagnosis_it_asked_for(rig, monkeypatch):
    def fake(given, records, holdout, *, seed, jobs):
        assert (given, len(records), len(holdout), seed, jobs) == (rig, 1, 0, 3, 1)
        return made_up_diagnosis(given, records[0])

    module = pytest.importorskip("identification.diagnose")
    monkeypatch.setattr(module, "diagnose", fake)
    assert diagnose_to_json(rig, [made_up_record(rig)], seed=3, jobs=1)["verdict"] == "missing_effect"
