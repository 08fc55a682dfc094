"""Contradictions of calibrations whose truth is known, and none where nothing is wrong."""

from dataclasses import replace

import numpy as np
import pytest

from identification.calibrate import calibrate, strained, unknowns_of
from identification.consistency.find import calibration_findings, pushed_out
from identification.consistency.modes import frequency_of, missed_modes, mode_bands
from identification.consistency.noise_seen import Scatter
from identification.evaluate import Evaluator, TimeTarget, carry_noise
from identification.fit import fit
from identification.hypothesis import Hypothesis, rig_unknowns
from models.effects import Place
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.stiffness_drift import StiffnessDrift
from models.record import Record
from tests.identification.trial_records import (
    FS,
    REFERENCE,
    evaluator_of,
    measured,
    moved,
    multisine,
    oscillator,
    sweep,
)

RIG = oscillator()
STIFFNESS = RIG.structure.stiffness
BEAM = REFERENCE.model_copy(update={"sleeves": (), "tolerances": {"youngs_modulus": 0.01, "rayleigh_damping": 0.05}})


def records_of(truth, *levels, n=1024, seed=0, low=5.0, **noise):
    return [
        measured(truth, multisine(n, rms=rms, low=low, seed=seed + k), seed=seed + k, name=f"r{k}", **noise)
        for k, rms in enumerate(levels)
    ]


def findings_of(rig, pairs, carried_by=None):
    evaluator = evaluator_of(*pairs)
    rng = np.random.default_rng(0)
    if carried_by is not None:
        evaluator = evaluator.with_targets(carry_noise(evaluator, carried_by, rng))
    given = Hypothesis(rig)
    return calibration_findings(evaluator, calibrate(evaluator, given, unknowns_of(given, evaluator)), rng)


def of(kind, findings):
    return [finding for finding in findings if finding.what == kind]


@pytest.mark.parametrize("hardening", [0.003, 0.3])
def test_a_spring_that_hardens_is_a_stiffness_that_grows_with_the_level(hardening):
    """Its stiffness in the mean over a motion of standard deviation s is k + 3 k3 s^2: it grows by the shares below."""
    cubic = CubicStiffness(Place(), stiffness=hardening * STIFFNESS / 1e-3**2)

    found = findings_of(RIG, records_of(Hypothesis(RIG, effects=(cubic,)), 3.0, 10.0, 30.0, n=2048))

    (drift,) = (f for f in of("records", found) if f.number == "stiffness")
    assert drift.where == ("at 3 N", "at 10 N", "at 30 N")
    assert list(drift.values) == sorted(drift.values)
    assert drift.sigma > 10.0
    assert "it grows with the level" in drift.words
    assert "a drift of mass would explain nearly as much" in drift.words
    (apart,) = of("record apart", found)
    assert apart.words.startswith("r2 held out")
    assert not of("times", found)
    assert [f.sigma for f in found] == sorted((f.sigma for f in found), reverse=True)


def test_a_stiffness_that_drifts_in_time_differs_between_halves_and_not_between_records():
    truth = Hypothesis(BEAM, effects=(StiffnessDrift(Place(), rate=0.001),))

    found = findings_of(BEAM, records_of(truth, 5.0, 5.0, n=2048, low=10.0))

    assert {f.what for f in found} == {"times"}
    assert {f.number for f in found} == {"youngs_modulus"}
    early, late = found[0].values
    # The centres of the halves of 1 s lie 0.5 s apart; the energy does not lie evenly in them.
    assert late / early - 1.0 == pytest.approx(0.5 * 0.001, rel=0.5)
    assert "it grows with time" in found[0].words


def test_wrong_numbers_within_their_tolerances_are_no_finding():
    assert findings_of(RIG, records_of(moved(RIG, 1.5, -1.5, 1.5), 3.0, 10.0)) == ()


def test_a_number_six_tolerances_off_has_left_its_tolerance():
    truth = Hypothesis(RIG.with_values({"stiffness": STIFFNESS * np.exp(6 * 0.03)}))

    found = of("tolerance", findings_of(RIG, records_of(truth, 3.0, 10.0)))

    (stiffness,) = (f for f in found if f.number == "stiffness")
    assert stiffness.values[0] > 1.1 * STIFFNESS
    assert "left its tolerance of 0.03" in stiffness.words
    assert "where the fit held it back" in stiffness.words


@pytest.mark.parametrize(("moved", "has_left"), [(0.0, True), (1.0, True), (3.0, False)])
def test_a_number_has_left_its_tolerance_beyond_what_the_forces_noise_explains(monkeypatch, moved, has_left):
    """Six tolerances off, held back at four; what counts is where it would be."""
    truth = Hypothesis(RIG.with_values({"stiffness": STIFFNESS * np.exp(6 * 0.03)}))
    evaluator, given = evaluator_of(*records_of(truth, 3.0, 10.0)), Hypothesis(RIG)
    found = calibrate(evaluator, given, unknowns_of(given, evaluator))
    assert "stiffness" in {unknown.parameter.path for unknown in strained(found)}
    monkeypatch.setattr(Scatter, "moved", lambda self, fit: np.full(len(fit.unknowns), moved))

    out = pushed_out(evaluator, found, np.random.default_rng(0))

    assert ("stiffness" in {unknown.parameter.path for unknown in out}) == has_left


@pytest.mark.parametrize(("information", "has_left"), [(5.0, False), (5e4, True)])
def test_what_the_records_hardly_tell_has_not_left_its_tolerance(monkeypatch, information, has_left):
    """A clearance whose other wall is not touched went to the end of its tolerance for a 2000th of what was left."""
    truth = Hypothesis(RIG.with_values({"stiffness": STIFFNESS * np.exp(6 * 0.03)}))
    evaluator, given = evaluator_of(*records_of(truth, 3.0, 10.0)), Hypothesis(RIG)
    found = calibrate(evaluator, given, unknowns_of(given, evaluator))
    told = np.sum(found.jacobian**2, axis=1)
    faint = found.jacobian * np.sqrt(information / told)[:, None]
    monkeypatch.setattr(Scatter, "moved", lambda self, fit: np.zeros(len(fit.unknowns)))

    out = pushed_out(evaluator, replace(found, jacobian=faint), np.random.default_rng(0))

    assert ("stiffness" in {unknown.parameter.path for unknown in out}) == has_left


def test_a_record_from_another_set_up_is_named_without_a_level():
    pairs = records_of(Hypothesis(RIG), 10.0, 10.0)
    pairs += [measured(moved(RIG, 0.0, 0.3, 0.0), multisine(1024, rms=10.0, seed=9), seed=9, name="odd")]

    found = findings_of(RIG, pairs)

    (drift,) = (f for f in of("records", found) if f.number == "stiffness")
    assert drift.where == ("in r0", "in r1", "in odd")
    # A tolerance is 3 %; one linear step is right to a few per cent of it.
    assert np.log(drift.values[2] / drift.values[0]) == pytest.approx(0.3 * 0.03, rel=0.1)
    assert of("record apart", found)[0].where[-1] == "odd, held out"


def stitched(low, high, edge, n=4096):
    """A record that follows one model below a frequency and another one above."""
    force = multisine(n, rms=5.0, low=10.0, high=600.0)
    (first, noise), (second, _) = (measured(truth, force, seed=1, name="r0") for truth in (low, high))
    spectra = [np.fft.rfft(record.responses) for record in (first, second)]
    above = np.fft.rfftfreq(n, 1.0 / FS) > edge
    return replace(first, responses=np.fft.irfft(np.where(above, spectra[1], spectra[0]), n)), noise


def test_a_modulus_that_fits_modes_1_to_4_and_not_those_beyond_is_found():
    found = findings_of(BEAM, [stitched(moved(BEAM, 0.0, 0.0, 0.0), moved(BEAM, 0.2, 0.0, 0.0), 294.0)])

    (drift, *_) = (f for f in of("modes", found) if f.number == "youngs_modulus")
    # A tolerance is 1 %; one linear step is right to some per cent of it.
    assert np.log(drift.values[1] / drift.values[0]) == pytest.approx(0.2 * 0.01, rel=0.1)
    assert drift.where[0].startswith("from modes 1 to 4 (below 29")
    assert not of("times", found)


def test_modes_that_are_met_worse_than_the_first_four_are_named():
    evaluator = evaluator_of(measured(Hypothesis(BEAM), multisine(2048, low=10.0, high=600.0)))
    base = fit(evaluator, Hypothesis(BEAM), rig_unknowns(BEAM), precise=True)
    bands = mode_bands(evaluator, base.hypothesis)
    frequency = frequency_of(evaluator.timed[0])
    fifth = (frequency > bands.edges[4]) & (frequency <= bands.edges[5])

    missed = missed_modes(evaluator, replace(base, residual=np.where(fifth, 3.0, 1.0) * base.residual), bands)

    assert missed_modes(evaluator, base, bands) is None
    assert missed.modes == (5,)
    assert missed.low == pytest.approx(1.0, abs=0.05)
    assert missed.beyond == pytest.approx(3.0, abs=0.15)
    assert missed.sigma > 10.0


def test_a_small_misfit_that_no_drift_explains_is_told_as_none():
    """A channel that reads wrong is wrong alike in all records, times and modes."""
    rig = RIG.model_copy(
        update={"sensors": tuple(RIG.sensors[0].model_copy(update={"name": name}) for name in ("a", "b"))}
    )
    pairs = []
    for record, noise in records_of(Hypothesis(rig), 10.0, 10.0, n=2048):
        wrong = record.responses * np.array([[1.0], [1.03]])
        pairs.append((Record(record.name, FS, record.excitation, record.sensors, wrong), noise))

    assert findings_of(rig, pairs) == ()


def test_in_a_decay_time_and_amplitude_are_not_told_apart():
    cubic = CubicStiffness(Place(), stiffness=0.05 * STIFFNESS / 1e-3**2)
    truth = Hypothesis(RIG, effects=(cubic,))
    blow = np.where(np.arange(4096) < 8, 300.0, 0.0)
    record, noise = measured(truth, blow, noise=0.002, name="decay")
    free = Record("decay", FS, None, record.sensors, record.responses[:, 16:], moving_start=True)
    evaluator = Evaluator([TimeTarget.of(free, noise)], 1)
    given = Hypothesis(RIG)

    base = calibrate(evaluator, given, unknowns_of(given, evaluator))
    (drift, *_) = of("times", calibration_findings(evaluator, base, np.random.default_rng(0)))

    assert "with time, or with the amplitude as it dies away" in drift.words


@pytest.mark.slow
@pytest.mark.parametrize("force_noise", [0.0, pytest.param(0.02, marks=pytest.mark.study)])
def test_where_nothing_is_wrong_there_is_no_finding_in_one_case_of_a_hundred(force_noise):
    """At 1 % four of 200 cases are exceeded once in 20 times; noise of the force is white in none of them."""
    rng, alarms = np.random.default_rng(4), 0
    for seed in range(200):
        truth = moved(RIG, *rng.uniform(-1.5, 1.5, 3))
        evaluator = evaluator_of(*records_of(truth, 3.0, 10.0, 3.0, n=512, seed=10 * seed, force_noise=force_noise))
        if force_noise:
            evaluator = evaluator.with_targets(carry_noise(evaluator, truth, rng))
        base = fit(evaluator, truth, rig_unknowns(RIG), precise=True)
        alarms += bool(calibration_findings(evaluator, base, rng))

    assert alarms <= 4


def test_noise_of_the_force_on_the_beam_in_its_sleeves_raises_no_alarm():
    """Through the contacts it reaches all lines and channels at once; as if independent it would read 20 sigma."""
    truth = moved(REFERENCE, 0.5, -0.4, 0.3, 0.5, -0.5, 0.4, -0.6, 0.3, -0.2)

    pairs = records_of(truth, 2.0, 10.0, 30.0, n=2048, low=10.0, force_noise=0.02)

    assert findings_of(REFERENCE, pairs, truth) == ()


def test_without_tolerances_there_are_no_numbers_to_tell():
    rig = RIG.model_copy(update={"tolerances": {}})

    assert findings_of(rig, [measured(Hypothesis(rig), sweep(512), name="a")]) == ()
