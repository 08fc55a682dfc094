"""One effect added by hand is fitted, written and remembered; a wrong one is told before anything is computed."""

import json
from pathlib import Path

import numpy as np
import pytest
from cli_files import FILM, make_files

from models.effects import EFFECTS, Place, build_effect
from models.effects.protocol import Scene
from models.rig_file import read_rig
from testbed import demo
from testbed.add import trials_at
from testbed.cli.app import main
from testbed.cli.tables import print_diagnosis


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return make_files(tmp_path_factory.mktemp("add"))


@pytest.fixture(autouse=True)
def inside(folder, monkeypatch):
    monkeypatch.chdir(folder)


def test_the_grease_is_fitted_and_remembered(folder, capsys):
    arguments = [
        "add",
        "rig.toml",
        "squeeze_film",
        "--sleeve",
        "sleeve 2",
        "--fit",
        "burst.csv",
        "--out",
        "a",
        "--json",
    ]
    assert main(arguments) == 0
    content = json.loads(capsys.readouterr().out)
    assert content == json.loads((folder / "a" / "compare.json").read_text())
    rig = read_rig(folder / "a" / "rig.updated.toml")
    effect = build_effect(rig.effects[0], rig, EFFECTS)
    # Noise of 0.5 % in one second of record.
    assert effect.damping == pytest.approx(FILM.damping, rel=0.02)
    assert rig.structure.youngs_modulus == pytest.approx(210e9, rel=2e-3)
    assert content["nrmse"] < 0.006
    damping = content["added"]["parameters"]["damping"]
    assert damping["value"] == effect.damping
    assert abs(damping["value"] - FILM.damping) < 4.0 * damping["std"]
    (modulus,) = content["calibrated"].values()
    assert (modulus["label"], modulus["held"], modulus["given"]) == ("Young's modulus", False, 210e9)
    assert modulus["sigmas"] == pytest.approx(np.log(modulus["value"] / 210e9) / 0.01)
    models = json.loads((folder / "a" / "history" / "history.json").read_text())["entries"]
    assert [entry["model"] for entry in models] == ["as given", "+ squeeze_film at sleeve 2"]
    assert models[0]["nrmse"] > 20.0 * models[1]["nrmse"]


def test_the_fit_begins_where_it_leads_to_less(tmp_path, capsys):
    """Beside the numbers as given the best trial is too large, and leads to a damping at the end of its tolerance."""
    shipped = Path(demo.__file__).parent
    where = [str(shipped / "rig.toml"), "squeeze_film", "--sleeve", "sleeve 2"]
    record = str(shipped / "records" / "multisine_3N.uff")
    assert main(["add", *where, "--fit", record, "--out", str(tmp_path / "out"), "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    damping = content["added"]["parameters"]["damping"]
    assert abs(damping["value"] - 1.5) < 2.0 * damping["std"]
    assert content["nrmse"] <= content["noise_nrmse"]
    assert max(abs(row["sigmas"]) for row in content["calibrated"].values()) < 2.0


def test_a_number_at_the_end_of_what_a_fit_may_move_is_told(folder, capsys):
    (folder / "stiff.toml").write_text((folder / "rig.toml").read_text().replace("210e9", "170e9"))
    where = ["stiff.toml", "squeeze_film", "--sleeve", "sleeve 2", "--fit", "burst.csv", "--out", "s"]
    assert main(["add", *where]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "note: Young's modulus moved as far as a fit may, beyond what the owner allows" in told


def test_exchanged_sensors_have_no_number_to_fit(folder, capsys):
    pair = ["--sensor", "P3", "--other", "P1"]
    assert main(["add", "rig.toml", "sensor_swap", *pair, "--fit", "burst.csv", "--out", "swapped"]) == 0
    assert "sensor_swap on P1 and P3: on two channels only" in capsys.readouterr().out
    rig = read_rig(folder / "swapped" / "rig.updated.toml")
    assert build_effect(rig.effects[0], rig, EFFECTS).place == Place(sensor="P1", other="P3")


def test_an_effect_without_numbers_has_a_row_in_the_diagnosis(capsys):
    swap = {"kind": "sensor_swap", "sensor": "P1", "other": "P3", "probability": 1.0, "parameters": {}}
    empty = {
        "error": [],
        "holdout": {},
        "candidates": [],
        "candidates_beside": [],
        "indistinguishable": [],
        "where": {},
    }
    print_diagnosis(
        {**empty, "effects": [swap], "verdict": "missing_effect", "next_experiment": {"do": "-", "why": "-"}}
    )
    told = capsys.readouterr().out
    assert "sensor_swap on P1 and P3" in told
    assert "value +- 1 std" in told


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["squeeze_film", "--position", "1.0"],
            "squeeze_film with --position; it sits at one sleeve; give --sleeve NAME: sleeve 1, sleeve 2",
        ),
        (["youngs_modulus", "--position", "1.0"], "with --position; it has no place; leave --position out"),
        (["squeeze_fil", "--sleeve", "sleeve 2"], 'kinds is "squeeze_film"; write that one'),
        (["squeeze_film", "--sleeve", "sleeve 3"], 'the rig\'s sleeves are "sleeve 1", "sleeve 2"'),
        (["squeeze_film", "--sleeve", "sleeve 2", "--against", "ground"], "squeeze_film has damping"),
        (["point_mass", "--position", "-1"], "new effect.position = -1.0 m; an effect's position is above 0; measure"),
        (["sensor_gain"], "sensor_gain without a place; it sits at one sensor; give --sensor NAME: P1, P2, P3"),
    ],
)  # fmt: skip
def test_an_effect_that_does_not_fit_is_told(arguments, message, capsys):
    assert main(["add", "rig.toml", *arguments, "--fit", "burst.csv", "--out", "none"]) == 2
    assert message in capsys.readouterr().err


def test_a_kind_that_is_named_before_the_rig_is_told(capsys):
    assert main(["add", "squeeze_film", "rig.toml", "--fit", "burst.csv", "--out", "none"]) == 2
    expected = "squeeze_film: a kind of effect in the place of the rig; the rig file comes first, then the kind; write "
    assert f"{expected}testbed add rig.toml squeeze_film" in capsys.readouterr().err


def test_the_numbers_are_shown_with_their_deviations(capsys):
    assert main(["add", "rig.toml", "point_mass", "--position", "0.6", "--fit", "burst.csv", "--out", "mass"]) == 0
    told = capsys.readouterr().out
    assert "value +- 1 std" in told
    assert "fitted +- 1 std" in told
    assert "Young's modulus" in told


def test_trials_are_made_once_for_what_moves_there_and_carry_the_options(folder, monkeypatch):
    place = Place(position=0.31)
    friction = EFFECTS["coulomb_friction"](place, friction_force=1.0, slip_velocity=1.0)
    made = {}

    def trials(cls, scene):
        made["scene"] = scene
        yield friction
        yield friction

    monkeypatch.setattr(type(friction), "trials", classmethod(trials))
    monkeypatch.setattr("testbed.add.scenes", lambda _evaluator, _model, places: {p: _scene(p, 1.0) for p in places})
    found = trials_at(None, None, friction, {"against": "ground"})
    assert [(trial.against, trial.place) for trial in found] == [("ground", place)]
    assert made["scene"].place == place


def _scene(place, displacement):
    return Scene(place, None, None, displacement, 1.0, 1.0, 0.0, 1.0, driven_base=False)
