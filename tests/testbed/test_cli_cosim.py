"""``testbed cosim`` on a file: what it writes, prints and refuses."""

import json
import subprocess
import sys

import pytest
from cli_files import RIG_TOML

from testbed.cli.app import main
from testbed.cli.cosim import EXAMPLE

TABLE = '\n[[effects]]\nkind = "time_varying_damping"\nsleeve = "sleeve 2"\ntimes = [0.0, 1.0]\nvalues = [80.0, 60.0]\n'


@pytest.fixture(autouse=True)
def inside(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rig.toml").write_text(RIG_TOML + TABLE)


def test_it_writes_what_it_prints(tmp_path, capsys):
    assert main(["cosim", "rig.toml", "--seconds", "1", "--snr", "60", "--channel", "P2", "--seed", "3", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert content == json.loads((tmp_path / "results" / "rig" / "cosim.json").read_text())
    assert (tmp_path / "results" / "rig" / "figures" / "cosim.png").stat().st_size > 10_000
    assert (content["sleeve"], content["seed"], content["snr"]) == ("sleeve 2", 3, 60.0)
    assert [channel["sensor"] for channel in content["channels"]] == ["P2"]
    assert content["damping_error"]["identified"] < 0.05
    assert content["twin_error"]["told"] < content["twin_error"]["alone"]
    assert content["real_time_factor"] > 0.0
    assert content["effect"]["kind"] == "time_varying_damping"
    assert len({len(column) for column in content["damping"].values()}) == 1


def test_the_table_names_errors_lag_and_speed(capsys):
    assert main(["cosim", "rig.toml", "--seconds", "1", "--start", "40"]) == 0
    out = capsys.readouterr().out
    for words in (
        "sleeve 2 carries 13.2 N at rest",
        "damping as identified, rms error over ",
        "damping as fed back, rms error over time, from the first exchange at ",
        "damping the twin moved with, rms error over the whole run, with 40 N s/m until then",
        "lag, by the age",
        "seconds of motion",
        "cosim.png",
    ):
        assert words in out


def test_a_lag_that_is_not_told_has_its_reason(tmp_path, capsys):
    (tmp_path / "rig.toml").write_text(RIG_TOML)
    assert main(["cosim", "rig.toml", "--seconds", "1"]) == 0
    assert "not told: the true damping hardly changes" in capsys.readouterr().out


def test_a_rig_that_rests_on_nothing_is_refused(tmp_path, capsys):
    (tmp_path / "free.toml").write_text(RIG_TOML.replace("3e-4", "5e-3").replace("1.5e-4", "5e-3"))
    assert main(["cosim", "free.toml"]) == 2
    assert "of which none touches at rest" in capsys.readouterr().err


def test_help_shows_an_example():
    done = subprocess.run(
        [sys.executable, "-m", "testbed", "cosim", "--help"], capture_output=True, text=True, check=True
    )
    assert " ".join(EXAMPLE.split()) in " ".join(done.stdout.split())
