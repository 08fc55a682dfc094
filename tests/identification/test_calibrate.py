"""Calibration: a phase that has run away is brought back, and what stands at its end is named."""

import numpy as np
import pytest
from trial_records import FS, REFERENCE, evaluator_of, let_go, measured, moved, multisine, oscillator, sweep

from identification.calibrate import beginning, calibrate, set_in_motion, strained, unknowns_of
from identification.evaluate import AHEAD
from identification.fit import fit
from identification.hypothesis import Hypothesis, OffsetUnknown, RigUnknown, StartUnknown, rig_unknowns
from identification.prepare import MIN_SAMPLES, start_unknowns
from models.simulate import Settings


def test_the_unknowns_are_the_tolerances_and_the_moving_starts():
    rig = oscillator("displacement")
    pairs = [measured(Hypothesis(rig), sweep(512), name=name, moving_start=name == "a") for name in "ab"]

    unknowns = unknowns_of(Hypothesis(rig), evaluator_of(*pairs, rig=rig))

    assert [type(u) for u in unknowns] == [*3 * [RigUnknown], StartUnknown, StartUnknown, OffsetUnknown]
    assert {u.record for u in unknowns[3:]} == {"a"}


def test_a_beginning_holds_its_share_of_the_energy_and_its_seconds():
    late = np.concatenate([np.zeros(1024), sweep(1024)])
    early = np.concatenate([sweep(1024), np.zeros(1024)])
    pairs = [measured(Hypothesis(oscillator()), force, noise=0.0) for force in (late, early)]

    waits, hurries = (t.record for t in beginning(evaluator_of(*pairs), 0.5, 0.3).targets)
    energy = np.cumsum(pairs[0][0].responses ** 2)
    half = int(np.searchsorted(energy, 0.5 * energy[-1]))

    assert half <= waits.n_samples < 1.02 * half
    assert hurries.n_samples >= round(0.3 * FS)
    assert hurries.n_samples < 0.6 * waits.n_samples
    assert beginning(evaluator_of(*pairs), 0.0, 0.0).targets[0].record.n_samples == MIN_SAMPLES
    assert beginning(evaluator_of(*pairs), 1.0, 60.0).targets[0].record.n_samples == 2048 - AHEAD


def test_short_windows_first_bring_back_a_phase_that_ran_away():
    rig = oscillator(freq=100.0, damping_ratio=0.002, stiffness=0.04, damping=0.1)
    truth = moved(rig, 2.5, 0.0)
    blow = np.where(np.arange(4096) < 8, 100.0, 0.0)
    evaluator = evaluator_of(measured(truth, blow))
    unknowns = rig_unknowns(rig)

    found = calibrate(evaluator, Hypothesis(rig), unknowns, windows=((0.02, 0.1), (0.1, 0.3)))

    assert abs(unknowns[0].get(found.hypothesis) - 2.5) < 4.0 * found.std()[0]
    assert found.ratio == pytest.approx(1.0, abs=0.1)
    # 5 Hz off is ten turns at the end: the fit of the whole record alone stays in another valley.
    assert fit(evaluator, Hypothesis(rig), unknowns).ratio > 3.0


@pytest.mark.parametrize("rms", [2.0, 10.0, 40.0])
def test_the_beam_comes_back_from_a_wrong_start(rms):
    truth = moved(REFERENCE, 1.0, -1.5, 1.0, 1.2, -1.0, 1.5, -1.0, 0.8, -1.4)
    evaluator = evaluator_of(measured(truth, multisine(3072, rms=rms, low=10.0)))
    unknowns = unknowns_of(Hypothesis(REFERENCE), evaluator)

    near = calibrate(evaluator, Hypothesis(REFERENCE), unknowns)
    found = fit(evaluator, near.hypothesis, unknowns, tolerance=0.0, max_iterations=30)

    errors = [(u.get(found.hypothesis) - u.get(truth)) / s for u, s in zip(unknowns, found.std(), strict=True)]
    assert near.ratio == pytest.approx(1.0, abs=0.1)
    assert np.abs(errors).max() < 4.0


def test_without_unknowns_nothing_moves():
    rig = oscillator().model_copy(update={"tolerances": {}})
    evaluator = evaluator_of(measured(Hypothesis(rig), sweep(512)))

    found = calibrate(evaluator, Hypothesis(rig), unknowns_of(Hypothesis(rig), evaluator))

    assert found.hypothesis.values == {}
    assert found.n_data == evaluator.n_data


def test_a_number_pushed_to_its_end_is_named_and_no_other():
    rig = oscillator()
    truth = Hypothesis(rig.with_values({"stiffness": rig.structure.stiffness * 1.3}))
    evaluator = evaluator_of(measured(truth, sweep(1024)))

    found = calibrate(evaluator, Hypothesis(rig), rig_unknowns(rig))
    well = calibrate(evaluator_of(measured(moved(rig, 1.0, 1.0, 1.0), sweep(1024))), Hypothesis(rig), rig_unknowns(rig))

    assert "stiffness" in {u.parameter.path for u in strained(found)}
    assert strained(well) == []


@pytest.mark.parametrize("force", [20.0, -60.0, 150.0])
def test_the_state_of_a_beam_that_strikes_its_sleeves_is_found_on_the_first_samples(force):
    evaluator = evaluator_of(let_go(REFERENCE, force), settings=Settings(steps_per_sample=8))
    unknowns = start_unknowns(Hypothesis(REFERENCE), [target.record for target in evaluator.timed])

    begun = set_in_motion(evaluator, Hypothesis(REFERENCE), unknowns)
    found = calibrate(evaluator, Hypothesis(REFERENCE), unknowns)
    at_once = fit(evaluator, Hypothesis(REFERENCE), unknowns)

    assert set(begun.starts) == {"decay"}
    assert found.ratio < 1.1
    assert at_once.ratio > 5.0


def test_a_state_that_is_there_is_kept():
    evaluator = evaluator_of(let_go(REFERENCE, 20.0, n=1024))
    unknowns = start_unknowns(Hypothesis(REFERENCE), [target.record for target in evaluator.timed])
    known = set_in_motion(evaluator, Hypothesis(REFERENCE), unknowns)

    assert set_in_motion(evaluator, known, unknowns) is known
    assert set_in_motion(evaluator, Hypothesis(REFERENCE), rig_unknowns(REFERENCE)).starts == {}
