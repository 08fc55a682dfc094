import json

import numpy as np
import pytest
from cli_files import make_files

from models.linear import linearised, natural_modes
from models.modal import build_modal
from models.plant import build_plant
from models.rig_file import read_rig
from testbed.cli.app import main


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return make_files(tmp_path_factory.mktemp("files"))


@pytest.fixture(scope="module")
def identified(folder):
    """What the whole command writes, with the rig and a sleeve."""
    out = folder / "out"
    files = [str(folder / "decay.csv"), "--rig", str(folder / "rig.toml")]
    assert main(["identify", *files, "--sleeve", "sleeve 2", "--out", str(out)]) == 0
    return out, json.loads((out / "identification.json").read_text())


def test_the_modes_are_those_of_the_rig_at_rest(folder, identified):
    _, content = identified
    plant = build_plant(read_rig(folder / "rig.toml"))
    truth = natural_modes(linearised(build_modal(plant, 300.0)), plant.sensors, 200.0)
    (decay,) = content["decays"]
    # six deviations, and the few 1e-5 by which the modal model's steps shift a frequency
    for mode, freq, ratio in zip(decay["modes"], truth.natural_freqs, truth.damping_ratios, strict=True):
        assert abs(mode["natural_freq"] - freq) < 6.0 * mode["natural_freq_std"] + 5e-5 * freq
        assert abs(mode["damping_ratio"] - ratio) < 6.0 * mode["damping_ratio_std"] + 5e-4 * ratio


def test_the_sleeve_has_the_damping_that_its_file_says(identified):
    out, content = identified
    assert content["sleeve"]["value"][0] == pytest.approx(80.0, rel=0.01)
    (effect,) = read_rig(out / "rig.updated.toml").effects
    assert (effect.kind, effect.sleeve) == ("time_varying_damping", "sleeve 2")
    assert effect.values[0] == pytest.approx(80.0, rel=0.01)


def test_courses_have_intervals_and_figures_are_drawn(identified):
    out, content = identified
    for mode in content["decays"][0]["modes"]:
        for course in (mode["frequency"], mode["damping"]):
            assert all(low <= value <= high for low, value, high in zip(*map(course.get, ("low", "value", "high"))))  # noqa: B905
        assert mode["damping_depends_on"]["verdict"] == "steady"
        for course, name in ((mode["frequency"], "natural_freq"), (mode["damping"], "damping_ratio")):
            assert set(course["value"]) == {mode[name]}
            assert course["high"][0] - mode[name] == pytest.approx(1.96 * mode[f"{name}_std"], rel=1e-3)
    assert {file.stem for file in (out / "figures").iterdir()} == {"modes", "mode-1", "mode-2", "mode-3", "sleeve"}


def test_the_table_says_what_its_deviations_are(folder, capsys):
    assert main(["identify", str(folder / "decay.csv"), "--band", "55", "80", "--out", str(folder / "told")]) == 0
    told = capsys.readouterr().out
    assert "frequency +- 1 std [Hz]" in told
    assert "damping ratio +- 1 std [%]" in told


def test_json_is_alone_on_standard_output(folder, capsys):
    arguments = ["identify", str(folder / "decay.csv"), "--channel", "P3", "--json", "--out", str(folder / "alone")]
    assert main(arguments) == 0
    assert json.loads(capsys.readouterr().out)["channels"] == ["P3"]


def test_an_equivalent_mass_gives_a_dashpot(folder):
    out = folder / "mass"
    arguments = ["identify", str(folder / "decay.csv"), "--band", "55", "80", "--mass", "2.5", "--out", str(out)]
    assert main(arguments) == 0
    content = json.loads((out / "identification.json").read_text())
    (mode,) = content["decays"][0]["modes"]
    expected = 2.0 * mode["damping_ratio"] * 2.0 * np.pi * mode["natural_freq"] * 2.5
    assert np.median(content["damping"]["value"]) == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["sweep.csv"], "where it is loudest; frequency and damping of the rig itself show while it moves"),
        (
            ["decay.csv", "--excitation", "x"],
            "decay.csv: no channel 'x' for --excitation; its channels are shaker, P1",
        ),
        (["decay.csv", "--channel", "P9"], "no channel 'P9'; its channels are P1, P2, P3; name one of these"),
        (["decay.csv", "--from", "3", "--to", "2"], "a stretch from 3 to 2 s; it begins before it ends"),
        (["decay.csv", "--sleeve", "sleeve 2"], "--sleeve 'sleeve 2' without a rig; a sleeve's damping follows"),
        (["decay.csv", "--rig", "rig.toml", "--sleeve", "sleeve 1"], "sleeve 1"),
        (["decay.csv", "--band", "80", "20"], "a band from 80 to 20 Hz"),
    ],
)
def test_bad_input_is_one_message(folder, monkeypatch, capsys, arguments, message):
    monkeypatch.chdir(folder)
    assert main(["identify", *arguments, "--out", "bad"]) == 2
    assert message in capsys.readouterr().err
    assert not (folder / "bad" / "identification.json").exists()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            ["--from", "1", "--to", "1.1"],
            ["a stretch from 1 to 1.1 s: 0.1 s", "512 samples or more", "--from and --to"],
        ),
        (["--band", "50", "20"], ["a band from 50 to 20 Hz", "name its lower edge first"]),
    ],
)
def test_a_stretch_or_band_that_cannot_be_identified_is_told_with_its_record(folder, options, words, capsys):
    assert main(["identify", str(folder / "decay.csv"), *options, "--out", str(folder / "no")]) == 2
    message = capsys.readouterr().err.splitlines()[-1]
    assert message.startswith("decay.csv: ")
    assert [word for word in words if word not in message] == []


def test_a_record_too_short_for_any_decay_says_so(folder, capsys):
    lines = (folder / "decay.csv").read_text().splitlines()
    (folder / "cut.csv").write_text("\n".join(lines[:300]) + "\n")
    assert main(["identify", str(folder / "cut.csv"), "--out", str(folder / "no")]) == 2
    assert "512 samples or more" in capsys.readouterr().err.splitlines()[-1]


def test_noise_on_the_force_is_named_where_it_hides_the_blow(folder, capsys):
    """A blow of a hundredth of a second whose peak is ten times the noise of its channel."""
    time = np.arange(8192) / 2048.0
    rng = np.random.default_rng(0)
    force = 0.3 * np.exp(-(((time - 0.1) / 2e-3) ** 2)) + 0.02 * rng.standard_normal(time.size)
    ringing = np.where(time > 0.1, np.exp(-3.0 * (time - 0.1)) * np.sin(2.0 * np.pi * 60.0 * (time - 0.1)), 0.0)
    rows = np.column_stack([time, force, ringing + 1e-4 * rng.standard_normal(time.size)])
    record = folder / "soft.csv"
    np.savetxt(record, rows, delimiter=",", header="time [s],force [N],A1 [m/s^2]", comments="")
    assert main(["identify", str(record), "--excitation", "force", "--out", str(folder / "soft")]) == 2
    message = capsys.readouterr().err.splitlines()[-1]
    assert "noise on the force is what hides its end" in message
    assert "--from" in message
    begun = ["identify", str(record), "--excitation", "force", "--from", "0.12", "--out", str(folder / "soft")]
    assert main(begun) == 0
    (mode,) = json.loads((folder / "soft" / "identification.json").read_text())["decays"][0]["modes"]
    assert mode["natural_freq"] == pytest.approx(60.0, rel=1e-3)


def test_an_open_sleeve_is_told_before_a_decay_is_identified(folder, monkeypatch, capsys):
    monkeypatch.setattr("testbed.identify.run.identify", None)
    arguments = ["identify", str(folder / "decay.csv"), "--rig", str(folder / "rig.toml"), "--sleeve", "sleeve 1"]
    assert main([*arguments, "--out", str(folder / "no")]) == 2
    assert "sleeve 1: it is open at rest" in capsys.readouterr().err
