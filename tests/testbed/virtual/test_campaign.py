"""Every kind of excitation becomes the runs that its keys ask for."""

from pathlib import Path

import numpy as np
import pytest

from models.errors import InputError
from models.excitations import DETECTION_GROUP, random_phase_multisine, stepped_sine
from models.rig_file import read_rig
from testbed.virtual.campaign import runs_of
from testbed.virtual.experiment import Experiment

REFERENCE = read_rig(Path(__file__).parents[2] / "data" / "reference_rig.toml")
FS = 2048.0


def planned(rig=REFERENCE, **excitation):
    return runs_of(Experiment.model_validate({"excitation": excitation}), rig)


def test_levels_and_realisations_are_records_of_their_own():
    runs = planned(kind="multisine", rms=(1.0, 2.0), realisations=2, period=0.5, periods=2)
    assert [run.name for run in runs] == ["multisine_1_1", "multisine_1_2", "multisine_2_1", "multisine_2_2"]
    assert [np.sqrt(np.mean(run.trial.excitation**2)) for run in runs] == pytest.approx([1.0, 1.0, 2.0, 2.0])
    assert not np.allclose(runs[0].trial.excitation, runs[1].trial.excitation)


def test_odd_lines_leave_the_even_ones_silent_and_detection_lines_some_of_the_odd():
    def lines(kind):
        wave = random_phase_multisine(np.random.default_rng(1), FS, 2048, 1, 5.0, 300.0, 1.0, kind)
        return np.flatnonzero(np.abs(np.fft.rfft(wave)) > 1e-6)

    full, odd, detection = lines("full"), lines("odd"), lines("odd_detection")
    assert set(full) == set(range(5, 301))
    assert set(odd) == set(range(5, 301, 2))
    assert set(detection) < set(odd)
    assert len(odd) - len(detection) == len(odd) // DETECTION_GROUP


def test_a_stepped_sine_runs_through_its_frequencies_without_a_jump():
    wave = stepped_sine(FS, 10.0, 100.0, 5, 20.0, 2.0)
    assert len(wave) == pytest.approx(FS * np.sum(20.0 / np.geomspace(10.0, 100.0, 5)), abs=1)
    assert np.abs(np.diff(wave)).max() < 2.0 * 2.0 * np.pi * 100.0 / FS * 1.01


def test_a_hammer_may_hit_twice():
    (once,) = planned(kind="hammer", blows=2, interval=1.0, start=0.1, width=5e-3, peak=100.0)
    (twice,) = planned(
        kind="hammer", blows=2, interval=1.0, start=0.1, width=5e-3, peak=100.0, double=0.5, rebound=0.05
    )
    more = twice.trial.excitation - once.trial.excitation
    hits = np.flatnonzero((more[1:] > 0.0) & (more[:-1] <= 0.0)) / FS
    assert hits == pytest.approx([0.15, 1.15], abs=2.0 / FS)
    assert more.max() == pytest.approx(50.0, rel=0.05)


def test_a_roving_hammer_goes_from_place_to_place():
    runs = planned(kind="roving_hammer", positions=(0.3, 0.9))
    assert [(run.name, run.trial.position) for run in runs] == [("hammer_at_300mm", 0.3), ("hammer_at_900mm", 0.9)]


def test_places_that_are_close_are_records_of_their_own():
    runs = planned(kind="roving_hammer", positions=(0.3001, 0.3004))
    assert [run.name for run in runs] == ["hammer_at_300.1mm", "hammer_at_300.4mm"]


@pytest.mark.parametrize(
    "excitation",
    [
        {"kind": "multisine", "rms": (10.0, 10.0)},
        {"kind": "multisine", "rms": (10.0, 10.0000001), "realisations": 2},
        {"kind": "roving_hammer", "positions": (0.3, 0.9, 0.3)},
    ],
)
def test_two_runs_of_one_name_are_refused(excitation):
    with pytest.raises(InputError, match=r"excitation: 2 runs are called .*; each run .*; give each level of rms and"):
        planned(**excitation)


def test_a_release_and_a_decay_have_no_excitation_channel():
    (release,) = planned(kind="release", position=1.2, force=-30.0, duration=1.0)
    assert (release.driven, release.trial.hold.force, np.any(release.trial.excitation)) == (False, -30.0, False)
    (decay,) = planned(kind="free_decay", frequency=25.0, cycles=10.0, duration=1.0)
    assert decay.first == round(10.0 / 25.0 * FS)
    assert np.abs(decay.trial.excitation[decay.first :]).max() < 1e-9


@pytest.mark.parametrize(
    ("rig", "excitation", "message"),
    [
        (
            {"excitation": None},
            {"kind": "sweep"},
            "on a rig without .excitation.; .*; add .excitation. to the rig file",
        ),
        (
            {},
            {"kind": "release", "position": 9.0, "force": 1.0},
            "position 9 m; a force acts on the beam, 0 to 1.469 m",
        ),
        ({"quantity": "base_acceleration"}, {"kind": "hammer"}, "on a driven base; a hammer is a force; take another"),
    ],
)
def test_what_the_rig_cannot_have_is_told(rig, excitation, message):
    if "quantity" in rig:
        driven = REFERENCE.excitation.model_copy(update={"quantity": rig["quantity"], "position": None})
        rig = {"excitation": driven}
    with pytest.raises(InputError, match=message):
        planned(REFERENCE.model_copy(update=rig), **excitation)


def test_a_force_acts_where_the_experiment_says():
    (run,) = planned(kind="multisine", position=0.65)
    (as_the_rig_says,) = planned(kind="multisine")
    assert (run.trial.position, as_the_rig_says.trial.position) == (0.65, None)
    with pytest.raises(InputError, match="a force acts on the beam"):
        planned(kind="hammer", position=2.0)


def test_a_driven_base_has_no_position():
    excitation = REFERENCE.excitation.model_copy(update={"quantity": "base_acceleration", "position": None})
    shaken = REFERENCE.model_copy(update={"excitation": excitation})
    with pytest.raises(InputError, match="a base moves as a whole"):
        planned(shaken, kind="sweep", position=0.65)
