"""A short beam on one sleeve, its modes damped 2 to 9 %, after blows that open the sleeve for some 30 ms."""

import json

import numpy as np
import pytest

from models.linear import linearised, natural_modes
from models.modal import build_modal
from models.plant import build_plant
from models.rig_file import read_rig
from testbed.cli.app import main

RIG = """
[structure]
kind = "beam"
length = 0.6
diameter = 0.010
youngs_modulus = 71e9
density = 2700.0
rayleigh_damping = [2.0, 1e-5]
[[sleeves]]
name = "collar"
position = 0.4
clearance = 1e-4
stiffness = 5e4
damping = 20.0
[excitation]
name = "F"
node = 10
position = 0.55
[[sensors]]
name = "A1"
node = 1
position = 0.2
[[sensors]]
name = "A3"
node = 3
position = 0.58
"""

BLOWS = """
fs = 4096.0
seed = 5
[excitation]
kind = "hammer"
peak = 3.0
width = 1e-3
blows = 2
interval = 1.0
[sensors.all]
preset = "PCB 352C66"
mass = 0.0
bits = 24
[sensors.excitation]
noise_density = 2e-4
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    home = tmp_path_factory.mktemp("heavy")
    (home / "rig.toml").write_text(RIG)
    (home / "blows.toml").write_text(BLOWS)
    assert main(["simulate", str(home / "rig.toml"), str(home / "blows.toml"), "--out", str(home)]) == 0
    return home


@pytest.mark.slow
@pytest.mark.parametrize(
    "options",
    [
        pytest.param(["--channel", "A1"], marks=pytest.mark.study),
        [],
        ["--mode", "81", "--mode", "160", "--mode", "373"],
    ],
)
def test_what_is_told_is_a_mode_of_the_rig_and_was_followed(folder, options):
    arguments = [str(folder / "hammer_3.uff"), "--rig", str(folder / "rig.toml"), *options]
    assert main(["identify", *arguments, "--out", str(folder / "out")]) == 0
    content = json.loads((folder / "out" / "identification.json").read_text())
    linear = linearised(build_modal(build_plant(read_rig(folder / "rig.toml")), 2000.0))
    modes = natural_modes(linear, linear.model.plant.sensors, 2000.0)
    told = [mode for decay in content["decays"] for mode in decay["modes"]]
    freqs = [mode["natural_freq"] for mode in told]
    assert np.abs(np.array(freqs) - modes.natural_freqs[0]).min() < 0.01
    for mode in told:
        nearest = int(np.argmin(np.abs(modes.natural_freqs - mode["natural_freq"])))
        # four standard deviations, and what parts small motion from none
        assert abs(mode["natural_freq"] - modes.natural_freqs[nearest]) < 4.0 * mode["natural_freq_std"] + 2e-3
        assert mode["damping_ratio"] == pytest.approx(modes.damping_ratios[nearest], rel=0.1)
        fall = 2.0 * np.pi * mode["natural_freq"] * mode["damping_ratio"] * mode["frequency"]["time"][-1]
        assert mode["natural_freq"] * mode["frequency"]["time"][-1] > 7.9 or fall > 3.3
        assert min(mode["frequency"]["low"]) > 0.0
        assert max(mode["ridge"]["amplitude"]) < 50.0  # m/s^2; the record's peak is 40
    assert any("begun" in finding and "later" in finding for finding in content["findings"])
