"""The measures see what they are named after, and the core of the cross-check keeps its bounds."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.errors import InputError
from models.plant import build_plant
from models.rig_file import read_rig
from models.simulators import simulator
from models.simulators.protocol import EnergyBalance, Motion, Resolution, Trial
from testbed.cli.app import main
from testbed.crosscheck.measures import (
    FS,
    SEED,
    Measure,
    freq_differences,
    impulse_difference,
    impulses,
    motion_difference,
    multisine,
    predictable,
    rest_differences,
    variant,
)
from testbed.crosscheck.page import crosscheck_json, page_of
from testbed.crosscheck.study import CrossCheck, crosscheck

REFERENCE = read_rig(Path(__file__).parents[2] / "data" / "reference_rig.toml")


def made_up(force, channels=None):
    """A motion whose only sleeve is closed where it pushes."""
    force = np.asarray(force, float)[None]
    energy = EnergyBalance(*np.zeros((4, 4)))
    gaps = np.where(force > 0.0, -1e-6, 1e-4)
    return Motion(np.zeros((1, 8)) if channels is None else channels, 100.0, force, gaps, gaps, energy)


def test_impulses_are_sums_from_closing_to_opening():
    time, impulse = impulses(made_up([0, 1, 2, 1, 0, 0, 5, 0]), 0)
    np.testing.assert_allclose(impulse, [0.04, 0.05])
    np.testing.assert_allclose(time, [0.025, 0.065])


def test_impulses_that_both_saw_are_compared():
    one, other = made_up([0, 1, 2, 1, 0, 0, 5, 0]), made_up([0, 1, 2, 1.4, 0, 0, 5, 0])
    assert impulse_difference(one, one, 1.0) == 0.0
    assert impulse_difference(one, other, 1.0) == pytest.approx(100.0 * 0.4 / np.hypot(4.0, 5.0))
    assert impulse_difference(one, other, 0.01) == 0.0


def test_motion_is_compared_below_250_hz_only():
    time = np.arange(2048) / FS
    slow, fast = np.sin(2.0 * np.pi * 40.0 * time), np.sin(2.0 * np.pi * 400.0 * time)
    ours = made_up([0], slow[None])
    assert motion_difference(ours, made_up([0], (slow + fast)[None]), 1.0) == pytest.approx(0.0, abs=1e-9)
    assert motion_difference(ours, made_up([0], 1.02 * slow[None]), 1.0) == pytest.approx(2.0)


def test_a_bound_is_from_above_and_for_frac_from_below():
    assert Measure("r", "static sag", "exudyn", 0.005, 0.01, "%").holds
    assert not Measure("r", "static sag", "exudyn", 0.02, 0.01, "%").holds
    assert Measure("r", "FRAC of linear FRFs, worst point", "exudyn", 0.99999, 0.9998, "").holds
    assert not Measure("r", "FRAC of linear FRFs, worst point", "exudyn", 0.999, 0.9998, "").holds


def test_a_rig_without_contact_is_predictable_and_a_variant_has_another_clearance():
    far = build_plant(variant(REFERENCE, 0.5))
    assert predictable(simulator("modal"), far, multisine(30.0)) == 1.0
    assert {sleeve.clearance for sleeve in variant(REFERENCE, 2e-3).sleeves} == {2e-3}
    assert variant(REFERENCE, None) is REFERENCE


@pytest.mark.parametrize("name", ["mujoco", "exudyn"])
def test_frequencies_and_rest_agree(name):
    pair = simulator("modal"), simulator(name)
    measures = [*freq_differences(REFERENCE, "r", *pair), *rest_differences(REFERENCE, "r", *pair)]
    assert len(measures) == 5
    assert all(measure.holds for measure in measures), measures


@pytest.mark.parametrize("name", ["mujoco", "exudyn"])
def test_motion_with_impacts_agrees(name):
    plant, trial = build_plant(REFERENCE), Trial(FS, multisine(30.0, 0.25))
    ours = simulator("modal").run(plant, trial, Resolution(20, 12))
    theirs = simulator(name).run(plant, trial, Resolution())
    assert motion_difference(ours, theirs, 0.25) < 1.0
    assert impulse_difference(ours, theirs, 0.25) < 1.0
    assert theirs.energy.fault < 2e-4


def test_the_page_and_the_json_tell_what_was_missed():
    good = Measure("as given", "static sag", "exudyn", 0.005, 0.01, "%")
    found = CrossCheck((good, replace(good, value=0.5)), (), {}, {"as given": 1.0}, seed=7)
    page, content = page_of(found, "testbed crosscheck rig.toml"), crosscheck_json(found)
    assert "1 of 2 bounds are missed" in page
    assert page.count("**missed**") == 1
    assert json.loads(json.dumps(content))["holds"] is False
    assert (content["seed"], "with phases of seed\n7." in page) == (7, True)


def test_an_oscillator_has_nothing_to_cross_check(tmp_path, capsys):
    (tmp_path / "rig.toml").write_text('[structure]\nkind = "oscillator"\nmass = 1.0\nstiffness = 1e4\ndamping = 1.0\n')
    assert main(["crosscheck", str(tmp_path / "rig.toml"), "--out", str(tmp_path / "out")]) == 2
    assert "the cross-check is of beams in sleeves" in capsys.readouterr().err


def test_only_simulators_with_bounds_are_held_against_the_modal_model(tmp_path, capsys):
    rig = str(Path(__file__).parents[2] / "data" / "reference_rig.toml")
    assert main(["crosscheck", rig, "--against", "modal", "--out", str(tmp_path)]) == 2
    assert "--against modal; the modal model is held against exudyn or mujoco; name one" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.study
def test_the_whole_cross_check_keeps_its_bounds():
    told = []
    found = crosscheck(REFERENCE, ["mujoco", "exudyn"], told.append)
    assert [m for m in found.measures if not m.holds] == []
    orders = {(c.simulator, c.what.split(",")[0]): c.order for c in found.convergence}
    assert orders["mujoco", "segments"] > 3.0
    assert orders["exudyn", "elements"] > 3.0
    assert orders["exudyn", "steps per sample"] > 1.8
    assert orders["modal", "steps per sample"] > 1.8
    assert orders["mujoco", "steps per sample"] > 0.5  # from 0.07 % on, what the armature at the clamp leaves
    assert len(told) == 7


def test_seed_and_jobs_reach_the_cross_check(tmp_path, capsys, monkeypatch):
    asked = []

    def noted(*_, **options):
        asked.append(options)
        raise InputError("noted", "as asked", "go on")

    monkeypatch.setattr("testbed.crosscheck.run.crosscheck", noted)
    order = ["crosscheck", str(Path(__file__).parents[2] / "data" / "reference_rig.toml"), "--out", str(tmp_path)]
    assert [main(order), main([*order, "--seed", "3", "--jobs", "1"])] == [2, 2]
    assert asked == [{"seed": SEED, "jobs": 2}, {"seed": 3, "jobs": 1}]
    assert "noted" in capsys.readouterr().err
    assert np.abs(multisine(30.0, seed=3) - multisine(30.0)).max() > 10.0


@pytest.mark.slow
@pytest.mark.study
def test_another_seed_moves_the_rig_otherwise_and_no_job_changes_a_number():
    order = REFERENCE, ["mujoco"]
    alone, beside = (crosscheck(*order, lambda _: None, (5e-5, 2e-3), seed=1, jobs=jobs) for jobs in (1, 2))
    usual = crosscheck(*order, lambda _: None, (5e-5,))
    assert alone.measures == beside.measures
    assert alone.horizons == beside.horizons
    assert [fall.errors.tolist() for fall in alone.convergence] == [fall.errors.tolist() for fall in beside.convergence]
    assert (alone.seed, usual.seed) == (1, 7)
    assert alone.measures[: len(usual.measures)] != usual.measures
    assert not np.array_equal(alone.motions["mujoco"].channels, usual.motions["mujoco"].channels)
