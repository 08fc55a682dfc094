"""The budget on the reference rig: in contact it is linear, beyond that gravity makes impacts uneven."""

from pathlib import Path

import numpy as np
import pytest

from identification.budget import budget_of
from models.excitations import random_phase_multisine
from models.plant import build_plant
from models.record import Record
from models.rig_file import read_rig
from models.simulate import simulate
from testbed.figures.budget import budget_figure

RIG = Path(__file__).parents[2] / "data" / "reference_rig.toml"
FS, PERIOD, PERIODS = 2048.0, 2048, 6


def measured(rms, seed):
    rig, rng = read_rig(RIG), np.random.default_rng(seed)
    drive = random_phase_multisine(rng, FS, PERIOD * PERIODS, PERIODS, 5.0, 300.0, rms, "odd_detection")
    names = tuple(sensor.name for sensor in rig.sensors)
    still = Record("still", FS, drive, names, np.zeros((len(names), len(drive))))
    channels = simulate(build_plant(rig), still).channels
    noise = 1e-3 * channels.std() * rng.standard_normal(channels.shape)
    return Record(f"rms {rms:g}", FS, drive + 1e-3 * rms * rng.standard_normal(len(drive)), names, channels + noise)


@pytest.fixture(scope="module")
def budget():
    return budget_of([measured(2.0, 1), measured(9.0, 2)], "N")


def test_a_beam_that_stays_on_its_sleeves_is_linear(budget):
    quiet = budget.splits[0]
    assert not any(quiet.shares[cause].found.any() for cause in ("odd", "even", "time_variation"))
    assert "rms 2 (rms 2 N, 5 periods): neither odd nor even distortion" in " ".join(budget.findings())


def test_impacts_on_one_side_make_both_parities(budget):
    loud = budget.splits[1]
    assert loud.shares["odd"].found[:, 1:].all()  # the first band lies below 5 Hz
    assert loud.shares["even"].found[:, 1:].all()
    assert not loud.shares["time_variation"].found.any()


def test_the_figure_has_a_panel_a_level_and_names_what_it_shows(budget):
    figure = budget_figure(budget.splits, "P3", "m/s^2", "N")
    (legend,) = figure.legends
    assert [ax.get_title(loc="left") for ax in figure.axes] == [
        "rms 2: rms 2 N, 5 periods",
        "rms 9: rms 9 N, 5 periods",
    ]
    assert {text.get_text() for text in legend.get_texts()} >= {
        "odd distortion",
        "even distortion",
        "response",
        "noise",
    }
