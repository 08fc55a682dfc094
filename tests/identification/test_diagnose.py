"""Once round the loop on rigs whose truth is known: nothing, a wrong sensor, a hardening spring, and the unknown."""

from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest
from trial_records import REFERENCE, measured, moved, multisine, oscillator

from identification.diagnose import diagnose
from identification.established import NO_LAW
from identification.hypothesis import Hypothesis
from identification.outcome import UNTRIED, UNTRIED_MISSED
from identification.prepare import prepare
from identification.scene import scenes
from models.effects import EFFECTS, Place
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.force_gain import ForceGain
from models.effects.mains_hum import MainsHum
from models.effects.sensor_delay import SensorDelay
from models.effects.sensor_gain import SensorGain
from models.effects.sensor_position import SensorPosition
from models.effects.sensor_swap import SensorSwap
from models.effects.squeeze_film import SqueezeFilm
from models.errors import DivergenceError, InputError
from models.general_laws import Memory
from testbed.hidden_effects.outside import GrowingDamping

BUILT = moved(REFERENCE, 0.5, -0.4, 0.3, 0.5, -0.5, 0.4, -0.6, 0.3, -0.2)
"""The beam as it was built, within the tolerances of its description."""


def few(*kinds):
    return MappingProxyType({kind: EFFECTS[kind] for kind in kinds})


def learnt_from(truth, rig, *, rms, n=4096, low=10.0, registry=EFFECTS, holdout=()):
    record, _ = measured(truth, multisine(n, rms=rms, low=low), name="multisine")
    kept = [measured(truth, multisine(2048, rms=rms, low=low, seed=s), seed=s, name=f"kept {s}")[0] for s in holdout]
    return diagnose(rig, [record], kept, registry=registry, jobs=1)


def test_where_nothing_is_hidden_the_model_is_complete():
    rig = oscillator()

    found = learnt_from(moved(rig, 0.5, -0.8, 1.0), rig, rms=20.0, holdout=(7,))

    assert (found.verdict, found.added, found.candidates) == ("complete", (), ())
    assert [stage.label for stage in found.stages] == ["as given", "calibrated"]
    assert found.final.score.nrmse == pytest.approx(found.final.score.noise_nrmse, rel=0.2)
    assert found.holdout["updated"].nrmse < 0.3 * found.holdout["as given"].nrmse
    assert any("complete" in decision for decision in found.decisions)


P4 = Place(sensor="P4")
FAULTS = (
    SensorGain(P4, gain=0.8),
    SensorGain(P4, gain=-1.0),
    SensorDelay(P4, delay=3e-4),
    SensorPosition(P4, position=REFERENCE.sensor("P4").position + 0.04),
    ForceGain(Place(), gain=1.1),
    MainsHum(Place(), frequency=50.0, amplitude=0.3),
)
MEASUREMENT = few(*(kind for kind, cls in EFFECTS.items() if cls.family == "measurement"), "point_mass")


@pytest.mark.slow
@pytest.mark.parametrize("fault", FAULTS, ids=["weak", "upside down", "late", "displaced", "force", "hum"])
def test_a_fault_of_the_measurement_is_named_with_its_size(fault):
    truth = Hypothesis(REFERENCE, BUILT.values, effects=(fault,))

    found = learnt_from(truth, REFERENCE, rms=2.0, n=2048, registry=MEASUREMENT)

    assert found.verdict == "missing_effect"
    (added,) = found.added
    assert (added.effect.kind, added.effect.place.sensor) == (fault.kind, fault.place.sensor)
    ((name, about),) = list(fault.fitted_parameters())[:1]
    estimate = next(each for each in added.estimates if each.name == name)
    true = fault.fitted_values()[0]
    assert abs(estimate.value - true) < max(4.0 * estimate.std, 0.005 * abs(true)), about
    assert added.probability > 0.9
    assert found.candidates[0].effect.kind == fault.kind


@pytest.mark.slow
def test_two_sensors_that_were_exchanged_are_named():
    swap = SensorSwap(Place(sensor="P3", other="P5"))

    found = learnt_from(
        Hypothesis(REFERENCE, BUILT.values, effects=(swap,)), REFERENCE, rms=2.0, n=2048, registry=MEASUREMENT
    )

    assert [added.effect for added in found.added] == [swap]
    assert found.final.score.nrmse < 1.05 * found.final.score.noise_nrmse


@pytest.mark.slow
def test_a_sensor_that_hears_nothing_but_itself_is_named():
    record, _ = measured(BUILT, multisine(2048, rms=2.0, low=10.0), name="multisine")
    heard = record.responses.copy()
    k = record.sensors.index("P4")
    heard[k] = 1e-3 * heard[k].std() * np.random.default_rng(0).standard_normal(heard.shape[1])

    found = diagnose(REFERENCE, [replace(record, responses=heard)], registry=MEASUREMENT, jobs=1)

    (added,) = found.added
    assert (added.effect.kind, added.effect.place) == ("sensor_gain", P4)
    assert abs(added.effect.gain) < 1e-3
    assert any("P4 contradicts the other channels" in decision for decision in found.decisions)


@pytest.mark.study
@pytest.mark.parametrize(
    "fault",
    [SensorSwap(Place(sensor="P3", other="P5")), SensorGain(P4, gain=-1.0)],
    ids=["exchanged", "upside down"],
)
def test_a_fault_that_the_benchmark_never_hides_is_found_before_the_whole_library(fault):
    found = learnt_from(Hypothesis(REFERENCE, BUILT.values, effects=(fault,)), REFERENCE, rms=2.0, holdout=(7,))

    assert found.verdict == "missing_effect"
    assert [(added.effect.kind, added.effect.place) for added in found.added] == [(fault.kind, fault.place)]
    assert found.holdout["updated"].nrmse < 1.1 * found.holdout["updated"].noise_nrmse


@pytest.mark.study
def test_a_law_that_no_kind_of_the_whole_library_is_stays_unexplained_and_is_located():
    place, (record, _) = Place(position=0.95), measured(BUILT, multisine(4096, rms=4.0, low=10.0))
    evaluator = prepare(BUILT, [record], 1, np.random.default_rng(0))
    scene = next(iter(scenes(evaluator, BUILT, [place]).values()))
    truth = Hypothesis(REFERENCE, BUILT.values, effects=(next(GrowingDamping.trials(scene)),))

    found = learnt_from(truth, REFERENCE, rms=4.0, holdout=(7,))

    assert (found.verdict, found.added) == ("unexplained", ())
    assert found.located is not None
    low, high = found.located.interval
    assert low <= place.position <= high


@pytest.mark.study
def test_two_effects_are_found_one_after_the_other():
    film, gain = SqueezeFilm(Place(sleeve="sleeve 2"), damping=15.0), SensorGain(P4, gain=0.9)
    truth = Hypothesis(REFERENCE, BUILT.values, effects=(film, gain))
    kinds = few("squeeze_film", "point_damping", "point_mass", "sensor_gain", "gap_offset")

    found = learnt_from(truth, REFERENCE, rms=4.0, n=2048, registry=kinds, holdout=(7,))

    assert found.verdict == "missing_effect"
    numbers = {(a.effect.kind, a.effect.place.sleeve or a.effect.place.sensor): a.estimates[0] for a in found.added}
    assert set(numbers) == {("squeeze_film", "sleeve 2"), ("sensor_gain", "P4")}
    for (kind, _), true in zip(sorted(numbers), (0.9, 15.0), strict=True):
        (estimate,) = [each for key, each in numbers.items() if key[0] == kind]
        assert abs(estimate.value - true) < max(4.0 * estimate.std, 0.005 * true)
    assert found.holdout["updated"].nrmse < 1.2 * found.holdout["updated"].noise_nrmse


@pytest.mark.parametrize(
    "rms",
    [
        10.0,
        pytest.param(30.0, marks=pytest.mark.slow),
    ],
)
def test_a_hardening_spring_is_found(rms):
    rig = oscillator("displacement")
    stiffness = 0.3 * rig.structure.stiffness / 1e-3**2
    truth = Hypothesis(rig, effects=(CubicStiffness(Place(), stiffness=stiffness),))

    found = learnt_from(truth, rig, rms=rms, holdout=(7,))

    assert found.verdict == "missing_effect"
    assert [added.effect.kind for added in found.added] == ["cubic_stiffness"]
    (estimate,) = found.added[0].estimates
    assert abs(estimate.value - stiffness) < 4.0 * estimate.std
    assert found.holdout["updated"].nrmse < 1.5 * found.holdout["updated"].noise_nrmse
    assert found.stages[-1].label == "+ cubic_stiffness"


@pytest.mark.parametrize("gain", [-1.0, 1e-3], ids=["reversed", "in kN"])
def test_a_force_that_is_reversed_or_in_another_unit_is_found_and_told(gain):
    truth = Hypothesis(REFERENCE, effects=(ForceGain(Place(), gain=gain),))
    record, _ = measured(truth, gain * multisine(2048, 2, rms=5.0), name="loud")
    kept, _ = measured(truth, gain * multisine(1024, rms=3.0, seed=9), name="kept")

    found = diagnose(REFERENCE, [record], [kept], registry=MEASUREMENT, jobs=2)

    (added,) = found.added
    assert added.effect.kind == "force_gain"
    assert added.effect.gain == pytest.approx(gain, rel=0.01)
    assert found.holdout["updated"].nrmse < 1.2 * found.holdout["updated"].noise_nrmse
    assert any("loud: all 8 channels are" in finding for finding in found.all_findings)


def test_a_channel_that_reads_one_value_is_left_out_and_told():
    record, _ = measured(BUILT, multisine(2048, rms=2.0, low=10.0), name="multisine")
    dead = record.responses.copy()
    dead[record.sensors.index("P4")] = 0.3

    found = diagnose(REFERENCE, [replace(record, responses=dead)], registry=few("point_mass"), jobs=1)

    assert found.verdict == "complete"
    assert found.findings[0] == "multisine: channel P4 is dead; left out"
    assert "P4" not in found.final.score.of("multisine").record.sensors
    with pytest.raises(InputError, match="every channel reads one value throughout"):
        diagnose(REFERENCE, [replace(record, responses=np.ones_like(dead))], jobs=1)


def test_what_the_library_lacks_is_called_unexplained():
    rig = oscillator("displacement")
    stiffness = 0.3 * rig.structure.stiffness / 1e-3**2
    truth = Hypothesis(rig, effects=(CubicStiffness(Place(), stiffness=stiffness),))

    found = learnt_from(truth, rig, rms=10.0, registry=few("sensor_gain", "force_gain"))

    assert (found.verdict, found.added) == ("unexplained", ())
    assert found.final.label == "calibrated"
    assert not np.any([stage.hypothesis.effects for stage in found.stages])
    assert any("unexplained" in decision for decision in found.decisions)


@pytest.mark.parametrize(
    ("kinds", "verdict", "step"),
    [
        (("cubic_stiffness",), "missing_effect", "a look at laws beyond the library"),
        (("sensor_gain", "force_gain"), "unexplained", "a search in pieces of the records"),
    ],
)
def test_when_the_time_given_is_over_what_stands_is_concluded_and_what_was_not_begun_is_a_finding(kinds, verdict, step):
    rig = oscillator("displacement")
    truth = Hypothesis(rig, effects=(CubicStiffness(Place(), stiffness=0.3 * rig.structure.stiffness / 1e-3**2),))
    record, _ = measured(truth, multisine(4096, rms=10.0, low=10.0), name="multisine")

    found = diagnose(rig, [record], registry=few(*kinds), jobs=1, within=0.0)

    assert found.verdict == verdict
    (told,) = (finding for finding in found.findings if "the time given is over" in finding)
    assert step in told
    assert told in found.decisions


def test_what_the_records_kept_aside_refute_is_not_named(monkeypatch):
    rig = oscillator("displacement")
    stiffness = 0.3 * rig.structure.stiffness / 1e-3**2
    truth = Hypothesis(rig, effects=(CubicStiffness(Place(), stiffness=stiffness),))
    named = learnt_from(truth, rig, rms=10.0, registry=few("cubic_stiffness"), holdout=(7,))
    monkeypatch.setattr("identification.diagnose.refuted", lambda *_: True)

    found = learnt_from(truth, rig, rms=10.0, registry=few("cubic_stiffness"), holdout=(7,))

    assert (named.verdict, found.verdict, found.added) == ("missing_effect", "unexplained", ())
    assert found.final.label == "calibrated"
    assert found.candidates[0].effect.kind == "cubic_stiffness"
    assert found.holdout["updated"].nrmse > 5.0 * named.holdout["updated"].nrmse


def test_a_model_that_meets_what_it_was_fitted_to_is_not_complete_where_a_louder_record_refutes_it():
    rig = oscillator("displacement")
    truth = Hypothesis(rig, effects=(CubicStiffness(Place(), stiffness=0.3 * rig.structure.stiffness / 1e-3**2),))
    quiet, alike = (measured(truth, multisine(4096, rms=0.3, seed=s), seed=s, name=f"at rest {s}")[0] for s in (1, 2))
    loud, _ = measured(truth, multisine(4096, rms=10.0, seed=3), seed=3, name="loud")

    at_rest = diagnose(rig, [quiet], [alike], registry=few("cubic_stiffness"), jobs=1)
    found = diagnose(rig, [quiet], [alike, loud], registry=few("cubic_stiffness"), jobs=1)

    assert (at_rest.verdict, found.verdict) == ("complete", "unexplained")
    assert found.added == ()
    assert found.final.score.nrmse == pytest.approx(at_rest.final.score.nrmse)
    (told,) = [decision for decision in found.decisions if decision.startswith("unexplained")]
    assert told.startswith("unexplained after all: no numbers of the calibrated model were found that explain loud as")
    assert told.endswith("learn from it, too")


def test_two_laws_that_are_one_of_another_shape_are_not_named(monkeypatch):
    rig = oscillator("displacement")
    truth = Hypothesis(rig, effects=(CubicStiffness(Place(), stiffness=0.3 * rig.structure.stiffness / 1e-3**2),))
    monkeypatch.setattr("identification.diagnose.is_of_one_law", lambda *_: True)

    found = learnt_from(truth, rig, rms=10.0, registry=few("cubic_stiffness"))

    assert (found.verdict, found.added) == ("unexplained", ())
    assert found.final.label == "calibrated"
    assert found.candidates[0].effect.kind == "cubic_stiffness"


@pytest.mark.slow
def test_a_law_beyond_the_library_ends_the_search_before_a_second_effect_is_looked_for():
    relaxing = Memory(Place(position=0.86), stiffness=3e3, relaxation_time=8e-3)
    truth = Hypothesis(REFERENCE, BUILT.values, effects=(relaxing,))

    found = learnt_from(truth, REFERENCE, rms=2.0, n=2048, registry=few("point_stiffness"), holdout=(7,))

    assert (found.verdict, found.added) == ("unexplained", ())
    assert [stage.label for stage in found.stages] == ["as given", "calibrated"]  # the spring was never added
    assert {candidate.effect.kind for candidate in found.candidates} == {"point_stiffness"}
    (told,) = [decision for decision in found.decisions if decision.startswith("unexplained")]
    assert "unexplained after all: point_stiffness" in told
    assert "force with a memory at 0.8" in told


@pytest.mark.parametrize(
    ("explained", "verdict", "chance"),
    [
        (False, "unexplained", None),
        (None, "missing_effect", 1.0 - UNTRIED_MISSED),
        (True, "missing_effect", 1.0 - UNTRIED),
    ],
)
def test_a_record_that_is_missed_counts_by_whether_other_numbers_explain_it(explained, verdict, chance, monkeypatch):
    rig = oscillator("displacement")
    stiffness = 0.3 * rig.structure.stiffness / 1e-3**2
    truth = Hypothesis(rig, effects=(CubicStiffness(Place(), stiffness=stiffness),))

    def missed(session, last, kept):
        return replace(kept, missed={"kept 7": "it does not hold there"}, explained=explained)

    monkeypatch.setattr("identification.diagnose.with_other_numbers", missed)

    found = learnt_from(truth, rig, rms=10.0, registry=few("cubic_stiffness"), holdout=(7,))

    assert found.verdict == verdict
    assert [added.probability for added in found.added] == pytest.approx([chance] if chance else [], rel=1e-3)


def test_what_fails_in_the_rest_of_the_records_is_looked_for_once_more(monkeypatch):
    begun = []
    monkeypatch.setattr("identification.diagnose.fails_in_pieces", lambda _, __: True)
    monkeypatch.setattr("identification.diagnose.go_on", lambda _, base: begun.append(base) or True)
    rig = oscillator()

    found = learnt_from(moved(rig, 0.5, -0.8, 1.0), rig, rms=20.0)

    assert len(begun) == 1
    assert found.decisions.count("looking again with the rest of the records, in pieces") == 1
    assert [stage.label for stage in found.stages] == ["as given", "calibrated"]
    assert found.verdict == "complete"


def test_what_was_found_stands_where_the_motion_is_lost_in_pieces(monkeypatch):
    def lost(*_):
        raise DivergenceError("test: the motion grew without bound")

    monkeypatch.setattr("identification.diagnose.fails_in_pieces", lambda _, __: True)
    monkeypatch.setattr("identification.diagnose.go_on", lambda _, __: True)
    monkeypatch.setattr("identification.diagnose.fitted_again", lost)
    rig = oscillator()

    found = learnt_from(moved(rig, 0.5, -0.8, 1.0), rig, rms=20.0)

    assert found.verdict == "complete"
    assert [stage.label for stage in found.stages] == ["as given", "calibrated"]
    assert any("what was found before stands" in decision for decision in found.decisions)


def test_what_is_decided_is_told():
    told, rig = [], oscillator()
    record, _ = measured(Hypothesis(rig), multisine(4096))  # of 1 s, the noise is told 30 % too low

    found = diagnose(rig, [record], jobs=1, seed=5, progress=told.append)

    assert set(found.decisions) <= set(told)
    # The noise is reached: nothing is looked for.
    assert not [message for message in told if "screening" in message]
    assert found.seed == 5
    assert found.seconds > 0.0


def test_a_law_of_which_the_records_know_no_number_is_taken_out_and_still_shown():
    """A friction that never sticks does what more damping does, at any force that is large enough."""
    rig = oscillator()
    damping = rig.parameters()[2]
    truth = Hypothesis(rig, values={damping.path: 2.0 * damping.value})
    record, _ = measured(truth, multisine(4096), noise=0.03)

    found = diagnose(rig, [record], registry=few("coulomb_friction"), jobs=1)

    assert (found.verdict, found.added) == ("unexplained", ())
    assert any("coulomb_friction" in decision and NO_LAW in decision for decision in found.decisions)
    assert [stage.label for stage in found.stages][-1] == "calibrated"
    assert [candidate.effect.kind for candidate in found.candidates] == ["coulomb_friction"]
