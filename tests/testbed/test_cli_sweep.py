"""``testbed sweep``: curves, table, figure, and what it refuses."""

import json
from pathlib import Path

import numpy as np
import pytest

from models.rig import Excitation
from models.rig_file import read_rig, write_rig
from testbed.cli.app import main

RIG = Path(__file__).parents[1] / "data" / "reference_rig.toml"
BAND = ["--from", "20", "--to", "32"]


def test_levels_bend_and_the_backbone_follows(tmp_path, capsys):
    sensor = read_rig(RIG).sensors[-1].name
    levels = ["--amplitude", "0.05", "--amplitude", "30"]
    assert main(["sweep", str(RIG), *levels, *BAND, "--out", str(tmp_path)]) == 0
    said = capsys.readouterr()
    content = json.loads((tmp_path / "sweep.json").read_text())
    assert content["sensor"] == sensor
    assert (tmp_path / "figures" / "sweep.png").stat().st_size > 10_000
    small, large = (max(c["peak"]) / c["amplitude"][0] for c in (content["curves"][0], content["curves"][1]))
    assert small == pytest.approx(large, rel=0.9)
    assert small != pytest.approx(large, rel=0.02)  # the sleeves are struck
    assert all(len(c["frequency"]) == len(c["peak"]) == len(c["stable"]) for c in content["curves"])
    spine = content["backbone"]
    assert np.all(np.diff(spine["amplitude"])[:3] > 0.0)
    assert "unstable" in said.out
    assert "sweep.json" in said.out


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--amplitude", "1", "--from", "9", "--to", "5"], "a band from 9 to 5 Hz"),
        (["--amplitude", "1", "--from", "5", "--to", "500"], "raise --up-to"),
        (["--amplitude", "0", *BAND], "amplitude above 0"),
        (["--amplitude", "1", "--amplitude", "inf", *BAND], "testbed sweep: --amplitude inf; a number is finite; "),
        (["--amplitude", "1", "--from", "nan", "--to", "5"], "testbed sweep: --from nan; a number is finite; "),
        (["--amplitude", "1", *BAND, "--sensor", "P99"], "P99"),
    ],
)
def test_what_is_no_sweep_is_refused_and_nothing_is_written(tmp_path, capsys, arguments, told):
    assert main(["sweep", str(RIG), *arguments, "--out", str(tmp_path / "out")]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "out" / "sweep.json").exists()


def test_a_band_without_resonance_says_so(tmp_path, capsys):
    assert main(["sweep", str(RIG), "--amplitude", "0.01", "--from", "0.5", "--to", "1.5", "--out", str(tmp_path)]) == 0
    assert "no backbone" in capsys.readouterr().out


def test_a_driven_base_will_do(tmp_path, capsys):
    rig = read_rig(RIG).model_copy(update={"excitation": Excitation(quantity="base_acceleration")})
    write_rig(rig, tmp_path / "table.toml")
    command = ["sweep", str(tmp_path / "table.toml"), "--amplitude", "0.2", *BAND, "--out", str(tmp_path), "--json"]
    assert main(command) == 0
    assert json.loads(capsys.readouterr().out)["level_unit"] == "m/s^2"
