"""Rivals whose difference is known, and groups that a quiet record cannot tell apart."""

from dataclasses import replace
from functools import cache

import numpy as np

from identification.evaluate import Evaluator, TimeTarget
from identification.evidence import Ranked, probabilities, with_evidence
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
from identification.next_experiment.bench import Bench
from identification.next_experiment.choose import Question
from identification.next_experiment.rivals import Rival, rivals_of
from identification.noise import Noise
from models.effects import Place
from models.effects.sensor_gain import SensorGain
from models.record import Record
from models.simulate import Settings
from testbed.virtual import Noise as Silence
from testbed.virtual import virtual_record
from tests.identification.trial_records import FS, REFERENCE, moved, multisine, oscillator

SIGMA = 0.01
"""Of an oscillator's only sensor, m/s^2."""


def bench_of(rig, sigma, rms=20.0, band=(10.0, 249.0), seconds=2.0):
    names = tuple(sensor.name for sensor in rig.sensors)
    return Bench(
        rig, FS, names, np.full(len(names), sigma), 0.0, np.full(len(names), 50.0), rms, 4.0 * rms, band, seconds
    )


def certain(hypothesis, chance=0.5):
    """A rival none of whose numbers can move."""
    return replace(free(hypothesis, chance), unknowns=(), axes=np.empty((0, 0)))


def free(hypothesis, chance=0.5):
    """A rival of whose rig no more is known than its tolerances."""
    unknowns = rig_unknowns(hypothesis.rig)
    n = len(unknowns)
    none = Fit(hypothesis, unknowns, 0.0, 0.0, 1, np.zeros(1), np.zeros((n, 1)), np.eye(n))
    effect = hypothesis.effects[-1] if hypothesis.effects else SensorGain(Place(sensor="top"), 1.0)
    return Rival(effect, none, hypothesis, chance, unknowns, np.eye(n))


def gains(one, other):
    """Two oscillators whose sensor reads one or another multiple of the truth."""
    rig = oscillator()
    return rig, [certain(Hypothesis(rig, effects=(SensorGain(Place(sensor="top"), g),))) for g in (one, other)]


@cache
def built():
    """The reference rig within its tolerances, and the sensors."""
    return moved(REFERENCE, 0.5, -0.4, 0.3, 0.5, -0.5, 0.4, -0.6, 0.3, -0.2), tuple(s.name for s in REFERENCE.sensors)


def quiet_record(rms, seconds=2, **about):
    """A record of the reference rig before anything was heard."""
    n = int(seconds * FS)
    return Record("quiet", FS, multisine(n, rms=rms, **about), built()[1], np.zeros((len(built()[1]), n)))


def heard(truth, silent, sigma, seed):
    """What finite elements say that the sensors hear, with white noise."""
    rig = truth.updated_rig
    if silent.excitation_position is not None:
        shaker = rig.excitation.model_copy(update={"position": silent.excitation_position})
        rig = rig.model_copy(update={"excitation": shaker})
    rng = np.random.default_rng(seed)
    record = virtual_record(rig, truth.effects, silent.excitation, silent.fs, Silence(0.0, 0.0), rng, silent.name)
    clean = record.responses
    record = replace(silent, responses=clean + sigma * rng.standard_normal(clean.shape))
    return TimeTarget.of(record, Noise(np.full(len(clean), sigma), 0.0, "known", "known"))


def ranked_on(evaluator, models, *, places=True):
    """The models fitted with all their numbers, by their evidence."""
    rows = []
    for model in models:
        unknowns = (*rig_unknowns(model.rig), *effect_unknowns(model, places=places))
        found = fit(evaluator, model, unknowns, precise=True, tolerance=1e-6, max_iterations=25)
        rows.append(Ranked.of(found))
    return with_evidence(rows)


def group(truth, others, silent, sigma, *, seed=1, places=True):
    """What a quiet record of the truth leaves open: its evaluator, its ranking, probabilities, and the question."""
    evaluator = Evaluator([heard(truth, silent, sigma, seed)], 1)
    ranked = ranked_on(evaluator, [replace(truth, effects=(effect,)) for effect in others], places=places)
    chances = probabilities([row.log_evidence for row in ranked])
    bench = Bench.of(REFERENCE, evaluator.timed)
    rivals = rivals_of(ranked, chances)
    return evaluator, ranked, chances, Question(bench, rivals, evaluator, max(1.0, ranked[0].fit.ratio))


def resolved(evaluator, ranked, question, test, truth, sigma, *, seed=9, places=True):
    """Kinds and probabilities of the rivals after the test was carried out on the truth and all were fitted again."""
    assert not test.is_held
    bench = question.bench if test.sensor is None else question.bench.with_sensor(test.sensor)
    target = heard(bench.at(truth), test.record("next", bench.sensors), sigma, seed)
    both = Evaluator([*evaluator.targets, target], 1, Settings())
    again = ranked_on(both, [bench.at(row.fit.hypothesis) for row in ranked], places=places)
    return again, probabilities([row.log_evidence for row in again])
