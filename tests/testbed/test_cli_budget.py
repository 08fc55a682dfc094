"""The budget over files: what is written, with a rig and without, and records that do not repeat."""

import json

import pytest
from cli_files import make_files

from testbed.cli.app import main


@pytest.fixture
def folder(tmp_path, monkeypatch):
    make_files(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


EXPERIMENT = """
fs = 512.0
seed = 2
[excitation]
kind = "multisine"
rms = [1.0, 12.0]
low = 5.0
high = 150.0
period = 1.0
periods = 6
lines = "odd_detection"
[sensors.all]
noise_density = 2e-3
"""


def test_a_rig_that_is_right_leaves_nothing_to_gain(folder, capsys):
    (folder / "multisine.toml").write_text(EXPERIMENT)
    assert main(["simulate", "rig.toml", "multisine.toml", "--with", "modal", "--out", "records", "--jobs", "1"]) == 0
    capsys.readouterr()
    files = sorted(str(file) for file in (folder / "records").glob("*.uff"))
    assert main(["budget", *files, "--rig", "rig.toml", "--out", "out", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content == json.loads((folder / "out" / "budget.json").read_text())
    assert [record["repeats"] for record in content["records"]] == [True, True]
    for record in content["records"]:
        for channel in record["channels"]:
            model = channel["model"]
            assert model["possible"] < 0.5 * model["noise"]
            assert len(channel["by_line"]["response"]) == len(record["frequency"])
    assert {file.name for file in (folder / "out" / "figures").iterdir()} == {f"P{i}-budget.png" for i in (1, 2, 3)}
    assert main(["budget", *files, "--rig", "rig.toml", "--channel", "P2", "--out", "alone"]) == 0
    printed = capsys.readouterr().out
    assert "P2" in printed
    assert "P3" not in printed


def test_records_that_do_not_repeat_are_no_error(folder, capsys):
    assert main(["budget", "sweep.csv", "decay.csv", "--out", "out", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert [record["repeats"] for record in content["records"]] == [False, False]
    assert content["records"][0]["reason"] == "its excitation does not repeat"
    assert content["records"][0]["channels"][0]["rms_of"]["noise"] > 0.0
    assert content["records"][0]["channels"][0]["unit"] == "m/s^2"
    assert main(["budget", "sweep.csv", "decay.csv", "--out", "out"]) == 0
    out = capsys.readouterr().out
    assert "no figures, since no record can be split" in out
    assert "m/s^2" in out
    assert not (folder / "out" / "figures").exists()


@pytest.mark.parametrize("rig", [[], ["--rig", "rig.toml"]])
def test_a_channel_that_is_not_there_is_refused(folder, capsys, rig):
    assert main(["budget", "sweep.csv", *rig, "--channel", "P9", "--out", "out"]) == 2
    assert "no channel 'P9'; its channels are P1, P2, P3" in capsys.readouterr().err


def test_a_channel_of_one_of_the_records_may_be_left_out(folder, capsys):
    text = (folder / "sweep.csv").read_text().replace("P3 [", "Q3 [")
    (folder / "other.csv").write_text(text)
    assert main(["budget", "sweep.csv", "other.csv", "--without", "Q3", "--out", "out", "--json"]) == 0
    records = json.loads(capsys.readouterr().out)["records"]
    assert [len(record["channels"]) for record in records] == [3, 2]
