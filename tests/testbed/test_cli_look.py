"""``modes``, ``frf``, ``compare`` and ``check`` on files."""

import json
import re

import numpy as np
import pytest
from cli_files import make_files

from models.rig_file import read_rig
from testbed.cli.app import main
from testbed.figures.modes import modes_figure
from testbed.modes import rig_modes


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return make_files(tmp_path_factory.mktemp("look"))


@pytest.fixture(autouse=True)
def inside(folder, monkeypatch):
    monkeypatch.chdir(folder)


def test_modes_tell_the_rest_and_the_modes(folder, capsys):
    assert main(["modes", "rig.toml", "--up-to", "200", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content == json.loads((folder / "results" / "rig" / "modes.json").read_text())
    assert list(content) == ["sleeves", "modes"]
    inner, outer = content["sleeves"]
    assert (inner["touches"], outer["touches"]) == (False, True)
    assert inner["gap"] > 0.0
    assert outer["contact_force"] > 0.0
    assert list(content["modes"][0]) == ["natural_freq", "damping_ratio", "shape"]
    assert list(content["modes"][0]["shape"]) == ["P1", "P2", "P3"]
    assert (folder / "results" / "rig" / "figures" / "modes.png").stat().st_size > 1000


def test_an_oscillator_has_one_mode_and_no_figure(folder, capsys):
    (folder / "mass.toml").write_text(
        '[structure]\nkind = "oscillator"\nmass = 3.0\nstiffness = 1200.0\ndamping = 0.6\n[[sensors]]\nname = "a"\n'
    )
    assert main(["modes", "mass.toml", "--json"]) == 0
    mode = json.loads(capsys.readouterr().out)["modes"][0]
    assert mode["natural_freq"] == pytest.approx(20.0 / (2 * np.pi))
    assert mode["damping_ratio"] == pytest.approx(0.005)
    assert main(["modes", "mass.toml"]) == 0
    assert capsys.readouterr().out.rstrip().endswith("modes.json")


@pytest.mark.parametrize("more", [(), ("--rig", "rig.toml"), ("--excitation", "shaker")])
def test_frfs_of_a_record_with_and_without_its_rig(folder, capsys, more):
    assert main(["frf", "burst.csv", *more, "--resolution", "8", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert list(content) == ["record", "excitation_unit", "levels", "findings"]
    level = content["levels"][0]
    assert list(level) == ["level", "averages", "frequency", "channels"]
    assert [(c["sensor"], c["unit"]) for c in level["channels"]] == [(f"P{i}", "(m/s^2)/N") for i in (1, 2, 3)]
    assert list(level["channels"][0]) == ["sensor", "unit", "h1", "h2", "coherence"]
    assert len(level["channels"][0]["h1"]["imag"]) == len(level["frequency"])
    assert (folder / "results" / "burst" / "figures" / "burst.csv-P1-frf.png").exists()


def test_a_channel_without_unit_needs_the_rig(folder, capsys):
    text = (folder / "burst.csv").read_text().replace("P2 [m/s^2]", "P2")
    (folder / "plain.csv").write_text(text)
    assert main(["frf", "plain.csv"]) == 2
    assert "channel P2 has the unit" in capsys.readouterr().err
    assert main(["frf", "plain.csv", "--without", "P2"]) == 0


def test_an_excitation_that_is_not_there_is_told_with_the_channels(capsys):
    assert main(["frf", "burst.csv", "--excitation", "hammer"]) == 2
    assert "no channel 'hammer' for --excitation; its channels are shaker, P1, P2, P3; " in capsys.readouterr().err


def test_a_response_beside_a_force_is_no_excitation_but_one_without_is(capsys):
    assert main(["frf", "burst.csv", "--excitation", "P1"]) == 2
    told = capsys.readouterr().err
    assert "burst.csv: --excitation P1 beside shaker, a force; " in told
    assert told.rstrip().endswith("name shaker, or leave it out with --without 'shaker'")
    assert main(["frf", "burst.csv", "--excitation", "P1", "--without", "shaker"]) == 0


@pytest.mark.parametrize("command", ["frf", "budget", "identify"])
def test_beside_a_rig_the_excitation_is_the_rigs_own(command, capsys):
    assert main([command, "burst.csv", "--rig", "rig.toml", "--excitation", "zz"]) == 2
    message = "--excitation zz beside --rig; the rig's excitation is shaker, its sensors are P1, P2, P3; leave"
    assert message in capsys.readouterr().err


@pytest.mark.parametrize("command", ["frf", "budget"])
def test_without_names_a_channel_of_the_file(command, capsys):
    assert main([command, "burst.csv", "--without", "P9"]) == 2
    message = "--without P9; the channels of burst.csv are shaker, P1, P2, P3; name one of them"
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    "command", [["frf"], ["budget"], ["budget", "--rig", "rig.toml"], ["frf", "--rig", "rig.toml"]]
)
def test_a_record_of_few_samples_has_no_spectra(folder, command, capsys):
    lines = (folder / "burst.csv").read_text().splitlines()
    (folder / "short.csv").write_text("\n".join(lines[:202]) + "\n")
    assert main([*command, "short.csv"]) == 2
    assert "short.csv: 200 samples; spectra are averaged" in capsys.readouterr().err


@pytest.mark.parametrize("command", ["frf", "budget"])
def test_an_excitation_that_is_silent_is_told(folder, command, capsys):
    rate, names, *rows = (folder / "burst.csv").read_text().splitlines()
    cells = [row.split(",") for row in rows]
    silent = [",".join([time, "0", *responses]) for time, _, *responses in cells]
    (folder / "silent.csv").write_text("\n".join([rate, names, *silent]) + "\n")
    assert main([command, "silent.csv"]) == 2
    assert "silent.csv: the measured excitation, a force, is 0 throughout; " in capsys.readouterr().err


@pytest.mark.parametrize("resolution", ["0", "-1", "1.9", "17", "nan", "1e6"])
def test_a_spacing_of_lines_that_a_record_cannot_have_is_refused(resolution, capsys):
    assert main(["frf", "burst.csv", "--resolution", resolution]) == 2
    told = (
        "--resolution nan; a number is finite" if resolution == "nan" else f"--resolution {float(resolution):g} Hz for"
    )
    assert told in capsys.readouterr().err


@pytest.mark.parametrize("resolution", ["2", "16"])
def test_the_finest_and_the_coarsest_lines_are_estimated(resolution):
    assert main(["frf", "burst.csv", "--resolution", resolution, "--without", "P2", "--without", "P3"]) == 0


def test_the_bounds_of_the_spacing_are_told(capsys):
    assert main(["frf", "burst.csv", "--resolution", "100"]) == 2
    message = "--resolution 100 Hz for burst.csv, 1 s at 512 Hz; lines are 2 Hz apart or more, .*, and 16 Hz or less"
    assert re.search(message, capsys.readouterr().err)


def test_compare_writes_json_and_figures_and_prints_nothing_else(folder, capsys):
    assert main(["compare", "rig.toml", "sweep.csv", "--out", "seen", "--jobs", "1", "--json"]) == 0
    streams = capsys.readouterr()
    assert json.loads(streams.out) == json.loads((folder / "seen" / "compare.json").read_text())
    assert "sweep.csv" in streams.err
    figures = {path.name for path in (folder / "seen" / "figures").iterdir()}
    assert figures == {"sweep.csv-time.png", "sweep.csv-nrmse.png", "sweep.csv-frf.png"}


def test_compare_leaves_a_channel_out(capsys):
    assert main(["compare", "rig.toml", "sweep.csv", "--out", "less", "--without", "P2", "--json"]) == 0
    channels = json.loads(capsys.readouterr().out)["records"][0]["channels"]
    assert [channel["sensor"] for channel in channels] == ["P1", "P3"]


def test_check_says_all_and_its_status_is_2_for_an_error(folder, capsys):
    assert main(["check", "rig.toml", "sweep.csv"]) == 0
    said = capsys.readouterr().out
    assert said.count("fine: ") == 2
    assert [line.split()[3] for line in said.splitlines() if line.startswith("│ sweep.csv")] == [
        "shaker",
        "P1",
        "P2",
        "P3",
    ]
    (folder / "empty.csv").write_text("")
    assert main(["check", "rig.toml", "empty.csv", "gone.csv", "sweep.csv", "--json"]) == 2
    content = json.loads(capsys.readouterr().out)
    assert content["errors"] == 2
    assert [row["severity"] for row in content["findings"]] == ["fine", "error", "error", "fine"]
    assert [row["channel"] for row in content["channels"]] == ["shaker", "P1", "P2", "P3"]
    assert list(content["channels"][0]) == ["record", "channel", "label", "factor", "rms", "peak", "unit"]


def test_check_shows_the_factor_of_a_label_that_is_wrong_for_all(folder, capsys):
    (folder / "g.csv").write_text((folder / "sweep.csv").read_text().replace("[m/s^2]", "[g]"))
    assert main(["check", "rig.toml", "sweep.csv", "g.csv", "--json"]) == 0
    right, wrong = np.split(np.array([row["rms"] for row in json.loads(capsys.readouterr().out)["channels"]]), 2)
    np.testing.assert_allclose(wrong / right, [1.0, *[9.80665] * 3])


def test_the_marks_of_sleeves_in_the_figure_of_modes_are_explained(folder):
    found = rig_modes(read_rig(folder / "rig.toml"), 200.0)
    figure = modes_figure(found)
    (legend,) = figure.legends
    explained = {"sleeve open at rest", "sleeve that touches at rest", "sensor"}
    assert {text.get_text() for text in legend.get_texts()} == explained
    assert all(ax.get_ylabel() == "shape [-]" for ax in figure.axes)
    sensors = [line for line in figure.axes[0].lines if line.get_label() == "sensor"]
    assert sensors[0].get_xdata().tolist() == [0.3, 0.7, 1.2]
