"""A virtual experiment over files: records that can be read, the truth apart, and a stop that costs nothing."""

import json
import tomllib
from copy import copy
from pathlib import Path

import numpy as np
import pytest

from models.effects import EFFECTS, build_effect
from models.errors import InputError
from models.rig import EffectEntry
from models.rig_file import read_rig, write_rig
from testbed.cli.app import main
from testbed.records.read import read_record

RIG = Path(__file__).parents[1] / "data" / "reference_rig.toml"
EXPERIMENT = """
fs = 1024.0
seed = 5
[excitation]
kind = "multisine"
rms = [2.0, 6.0]
period = 0.25
periods = 2
high = 200.0
[sensors.all]
noise_density = 1e-3
[sensors.P8]
mass = 0.01
position_error = -0.01
[truth]
perturbed = true
[[truth.effects]]
kind = "squeeze_film"
sleeve = "sleeve 2"
damping = 4.0
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    here = tmp_path_factory.mktemp("simulate")
    (here / "test.toml").write_text(EXPERIMENT)
    assert main(["simulate", str(RIG), str(here / "test.toml"), "--out", str(here / "out"), "--jobs", "1"]) == 0
    return here


def test_the_records_are_read_back(folder):
    rig = read_rig(RIG)
    loud = read_record(folder / "out" / "multisine_6.uff", rig)
    quiet = read_record(folder / "out" / "multisine_2.uff", rig)
    assert (loud.fs, loud.n_samples, len(loud.sensors)) == (1024.0, 512, 8)
    assert np.std(loud.excitation) == pytest.approx(3.0 * np.std(quiet.excitation), rel=0.3)
    assert not loud.moving_start


def test_the_truth_stands_in_a_file_of_its_own(folder):
    truth = tomllib.loads((folder / "out" / "truth.toml").read_text())
    rig = read_rig(RIG)
    assert truth["parameters"]["youngs_modulus"] != rig.structure.youngs_modulus
    effects = [build_effect(EffectEntry(**table), rig, EFFECTS) for table in truth["effects"]]
    assert [effect.kind for effect in effects] == ["squeeze_film", "point_mass"]
    assert truth["sensor_positions"]["P8"] == pytest.approx(rig.sensor("P8").position - 0.01)
    record = (folder / "out" / "multisine_6.uff").read_bytes()
    assert b"squeeze" not in record


def test_what_the_simulator_did_is_told(folder):
    content = json.loads((folder / "out" / "simulation.json").read_text())
    assert [row["record"] for row in content["records"]] == ["multisine_2.uff", "multisine_6.uff"]
    row = content["records"][1]
    assert row["energy_fault"] < 1e-3
    assert {contact["sleeve"] for contact in row["contacts"]} == {"sleeve 1", "sleeve 2"}
    assert any("steps of" in choice for choice in row["choices"])
    assert (folder / "out" / "figures" / "multisine_6.png").stat().st_size > 10_000


def test_what_is_there_is_kept_and_what_is_missing_made_again_alike(folder, capsys):
    path = folder / "out" / "multisine_2.uff"
    before = path.read_bytes()
    path.unlink()
    arguments = ["simulate", str(RIG), str(folder / "test.toml"), "--out", str(folder / "out"), "--jobs", "1", "--json"]
    assert main(arguments) == 0
    streams = capsys.readouterr()
    assert "1 of 2 records were there already; kept" in streams.err
    assert json.loads(streams.out)["records"][0]["record"] == "multisine_2.uff"
    assert path.read_bytes() == before


def test_a_release_is_a_free_decay(tmp_path):
    (tmp_path / "drop.toml").write_text(
        'fs = 1024.0\n[excitation]\nkind = "release"\nposition = 1.2\nforce = 20.0\nduration = 0.5\n'
    )
    assert (
        main(["simulate", str(RIG), str(tmp_path / "drop.toml"), "--out", str(tmp_path / "out"), "--format", "h5"]) == 0
    )
    record = read_record(tmp_path / "out" / "release.h5", read_rig(RIG))
    assert record.excitation is None
    assert np.abs(record.responses[-1, :50]).max() > np.abs(record.responses[-1, -50:]).max()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--with", "mujco"], "the simulators are modal, mujoco, exudyn; did you mean 'mujoco'?"),
        (["--with", "ansys"], "the simulators are modal, mujoco, exudyn; choose one of them; docs/extending.md"),
        (["--parts", "2"], "Invalid value for '--parts'"),
    ],
)
def test_a_wrong_choice_is_told(folder, arguments, message, capsys):
    assert main(["simulate", str(RIG), str(folder / "test.toml"), "--out", str(folder / "no"), *arguments]) == 2
    assert message in capsys.readouterr().err
    assert not (folder / "no").exists()


def test_a_sensor_that_the_rig_does_not_have_is_told(tmp_path, capsys):
    (tmp_path / "test.toml").write_text('[excitation]\nkind = "sweep"\n[sensors.P9]\nmass = 0.1\n')
    assert main(["simulate", str(RIG), str(tmp_path / "test.toml"), "--out", str(tmp_path / "out")]) == 2
    assert "test.toml: sensors.P9; the rig's sensors are P1" in capsys.readouterr().err


def test_a_hidden_effect_that_the_rig_cannot_have_is_told_with_its_file_and_place(tmp_path, capsys):
    effect = '[[truth.effects]]\nkind = "squeeze_film"\nsleeve = "sleeve 7"\ndamping = 1.0\n'
    (tmp_path / "test.toml").write_text('[excitation]\nkind = "sweep"\n' + effect)
    assert main(["simulate", str(RIG), str(tmp_path / "test.toml"), "--out", str(tmp_path / "out")]) == 2
    assert 'test.toml: truth.effects[0].sleeve = "sleeve 7"; the rig\'s sleeves are' in capsys.readouterr().err


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_force_out_of_the_plane_asks_for_space_in_one_message(folder, capsys, jobs):
    (folder / "angled.toml").write_text(EXPERIMENT.replace("[sensors.all]", "angle = 20.0\n[sensors.all]"))
    arguments = ["simulate", str(RIG), str(folder / "angled.toml"), "--with", "mujoco", "--jobs", jobs]
    assert main([*arguments, "--out", str(folder / "angled")]) == 2
    message = capsys.readouterr().err
    assert "angle = 20 degrees" in message
    assert "--spatial" in message


def test_an_error_comes_whole_out_of_another_process():
    error = copy(InputError("given", "expected", "mend"))  # by its parts, as processes hand errors over
    assert (str(error), error.mend) == ("given; expected; mend", "mend")


def test_records_of_another_experiment_are_not_left_beside_a_new_truth(folder, capsys):
    before = (folder / "out" / "truth.toml").read_bytes()
    (folder / "other.toml").write_text(EXPERIMENT.replace("rms = [2.0, 6.0]", "rms = [3.0]"))
    assert main(["simulate", str(RIG), str(folder / "other.toml"), "--out", str(folder / "out"), "--jobs", "1"]) == 2
    assert "multisine_2.uff of another experiment" in capsys.readouterr().err
    assert (folder / "out" / "truth.toml").read_bytes() == before


def test_a_place_that_the_format_cannot_tell_is_refused_before_anything_moves(folder, capsys):
    text = EXPERIMENT.replace(
        EXPERIMENT[EXPERIMENT.index("kind =") : EXPERIMENT.index("[sensors.all]")],
        'kind = "roving_hammer"\npositions = [0.777]\nduration = 0.2\n',
    )
    (folder / "rove.toml").write_text(text)
    assert main(["simulate", str(RIG), str(folder / "rove.toml"), "--out", str(folder / "rove")]) == 2
    assert "--format h5" in capsys.readouterr().err
    assert not (folder / "rove").exists()
    arguments = ["simulate", str(RIG), str(folder / "rove.toml"), "--out", str(folder / "rove"), "--format", "h5"]
    assert main(arguments) == 0


def test_a_folder_in_the_place_of_a_record_is_told_before_anything_moves(tmp_path, capsys):
    (tmp_path / "test.toml").write_text(EXPERIMENT)
    (tmp_path / "out" / "multisine_6.uff").mkdir(parents=True)
    assert main(["simulate", str(RIG), str(tmp_path / "test.toml"), "--out", str(tmp_path / "out"), "--jobs", "1"]) == 2
    assert "multisine_6.uff is a folder" in capsys.readouterr().err
    assert not (tmp_path / "out" / "multisine_2.uff").exists()


@pytest.mark.parametrize(
    ("table", "error", "message"),
    [
        ("P8", 0.5, "test.toml: sensors.P8.position_error = 0.5 m puts P8 at 1.9"),
        ("all", -0.5, "test.toml: sensors.all.position_error = -0.5 m puts P1 at -0."),
    ],
)
def test_a_sensor_beside_the_beam_is_told_before_anything_moves(tmp_path, capsys, table, error, message):
    text = f'[excitation]\nkind = "sweep"\n[sensors.{table}]\nposition_error = {error}\n'
    (tmp_path / "test.toml").write_text(text)
    assert main(["simulate", str(RIG), str(tmp_path / "test.toml"), "--out", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    assert message in told
    assert "; a sensor sits on the beam, 0 to 1.469 m; " in told
    assert not (tmp_path / "out").exists()


def test_a_choice_of_mujoco_is_explained_once_in_plain_words(tmp_path, capsys):
    (tmp_path / "short.toml").write_text(EXPERIMENT.replace("periods = 2", "periods = 1"))
    order = ["simulate", str(RIG), str(tmp_path / "short.toml"), "--with", "mujoco", "--out", str(tmp_path / "out")]
    assert main([*order, "--jobs", "1"]) == 0
    streams = capsys.readouterr()
    assert streams.out.count("short enough for the shortest wave of the record's band") == 1
    assert "as long as the engine" not in streams.err


LOUD = """
fs = 1024.0
[excitation]
kind = "multisine"
rms = 300.0
period = 0.25
periods = 2
high = 200.0
[sensors.P8]
range = 300.0
[sensors.excitation]
range = 1e5
"""


def test_a_record_that_is_clipped_is_told_with_channel_share_and_what_to_do(tmp_path, capsys):
    (tmp_path / "loud.toml").write_text(LOUD)
    order = ["simulate", str(RIG), str(tmp_path / "loud.toml"), "--out", str(tmp_path / "out"), "--jobs", "1"]
    assert main(order) == 0
    warning = next(line for line in capsys.readouterr().out.splitlines() if line.startswith("warning"))
    row = json.loads((tmp_path / "out" / "simulation.json").read_text())["records"][0]
    (clipped,) = row["clipped"]
    samples = read_record(tmp_path / "out" / "multisine_300.uff", read_rig(RIG), without=["P8"])
    assert samples.n_samples == 512
    assert (clipped["channel"], clipped["range"], clipped["unit"]) == ("P8", 300.0, "m/s^2")
    assert 0.05 < clipped["share"] < 1.0
    share = f"{clipped['share']:.1%}"
    assert f"multisine_300.uff: P8 is clipped at 300 m/s^2 in {share} of its samples; check" in warning
    assert "lower the excitation's level" in warning
    with pytest.raises(InputError, match=r"P8.*is clipped"):
        read_record(tmp_path / "out" / "multisine_300.uff", read_rig(RIG))


def test_without_sleeves_no_table_and_no_figures_are_announced(tmp_path, capsys):
    beam = read_rig(RIG).model_copy(update={"sleeves": ()})
    write_rig(beam.model_copy(update={"tolerances": {}}), tmp_path / "beam.toml")
    (tmp_path / "test.toml").write_text(EXPERIMENT.partition("[truth]")[0])
    order = ["simulate", str(tmp_path / "beam.toml"), str(tmp_path / "test.toml"), "--out", str(tmp_path / "out")]
    assert main([*order, "--jobs", "1"]) == 0
    out = capsys.readouterr().out
    assert "figures" not in out
    assert "in the sleeves" not in out
    assert not (tmp_path / "out" / "figures").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            EXPERIMENT.replace("noise_density = 1e-3", 'preset = "none"'),
            'sensors.all.preset = "none"; the presets are ',
        ),
        (
            EXPERIMENT.replace("[2.0, 6.0]", '"loud"'),
            "excitation.rms = 'loud'; it should be a valid number, or a list of them; ",
        ),
        (EXPERIMENT.replace("sensors.P8", "sensors.tip"), "excitation the force's own; name one of them, or remove it"),
        (EXPERIMENT.replace("sensors.P8", "sensors.P88"), "excitation the force's own; did you mean P8?"),
    ],
)
def test_a_mistake_is_told_at_the_key_where_it_stands(text, message, tmp_path, capsys):
    (tmp_path / "test.toml").write_text(text)
    assert main(["simulate", str(RIG), str(tmp_path / "test.toml"), "--out", str(tmp_path / "out")]) == 2
    assert message in capsys.readouterr().err


NEXT = """
fs = 1024.0
seed = 8
[excitation]
kind = "multisine"
rms = 6.0
period = 0.25
periods = 2
high = 200.0
"""


def test_the_next_test_is_carried_out_on_the_very_rig_of_an_earlier_one(folder, tmp_path):
    (tmp_path / "next.toml").write_text(NEXT)
    truth = folder / "out" / "truth.toml"
    order = ["simulate", str(RIG), str(tmp_path / "next.toml"), "--jobs", "1", "--prefix", "next_"]
    assert main([*order, "--truth", str(truth), "--out", str(tmp_path / "same")]) == 0
    assert main([*order, "--out", str(tmp_path / "drawing")]) == 0
    told, before = (tomllib.loads(path.read_text()) for path in (tmp_path / "same" / "truth.toml", truth))
    for key in ("parameters", "effects", "sensor_positions"):
        assert told[key] == before[key]
    assert told["seed"] == 8
    same, drawing = (
        read_record(tmp_path / name / "next_multisine_6.uff", read_rig(RIG)) for name in ("same", "drawing")
    )
    # The same phases on both; the film and the numbers that are off show in the motion.
    assert np.linalg.norm(same.responses - drawing.responses) > 0.05 * np.linalg.norm(drawing.responses)


@pytest.mark.parametrize(
    ("truth", "text", "message"),
    [
        (None, NEXT, "No such file or directory; truth.toml, which testbed simulate writes, says what was tested"),
        ("seed = 3\n", NEXT, "effects is missing; "),
        (
            "effects = []\n[parameters]\nmass = 3.0\n",
            NEXT,
            "truth.toml: parameters.mass; the toleranced numbers of this",
        ),
        ("effects = []\n[parameters]\n", f"{NEXT}[truth]\nperturbed = true\n", "next.toml: [truth] beside --truth; "),
    ],
)
def test_a_truth_that_does_not_fit_is_told(truth, text, message, tmp_path, capsys):
    (tmp_path / "next.toml").write_text(text)
    if truth is not None:
        (tmp_path / "truth.toml").write_text(truth)
    order = ["simulate", str(RIG), str(tmp_path / "next.toml"), "--truth", str(tmp_path / "truth.toml")]
    assert main([*order, "--out", str(tmp_path / "out")]) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_seed_on_the_command_line_stands_for_the_experiments_own(folder, tmp_path):
    written = tmp_path / "test.toml"
    written.write_text(EXPERIMENT.replace("seed = 5", "seed = 6"))
    order = ["simulate", str(RIG), "--jobs", "1", "--format", "h5", "--out"]
    assert main([*order, str(tmp_path / "in_file"), str(written)]) == 0
    for seed in ("6", "7", "6"):  # the third time over records of another seed
        assert main([*order, str(tmp_path / "asked"), str(folder / "test.toml"), "--seed", seed]) == 0
        truth = tomllib.loads((tmp_path / "asked" / "truth.toml").read_text())
        same = tomllib.loads((tmp_path / "in_file" / "truth.toml").read_text())
        wanted, found = (
            read_record(tmp_path / each / "multisine_6.h5", read_rig(RIG)) for each in ("in_file", "asked")
        )
        assert truth["seed"] == int(seed)
        assert (truth == same) == (seed == "6")
        assert np.array_equal(found.excitation, wanted.excitation) == (seed == "6")
        assert np.array_equal(found.responses, wanted.responses) == (seed == "6")
