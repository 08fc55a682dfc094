"""The measurement is suspected where one channel, or a few lines, contradict all the rest, and only there."""

from dataclasses import replace

import numpy as np
import pytest
from rest_records import modes_of
from trial_records import REFERENCE, evaluator_of, fit_of, measured, moved, multisine

from identification.at_rest import linear_model
from identification.calibrate import calibrate, concerning, unknowns_of
from identification.carried import carried_through
from identification.evaluate import carry_noise
from identification.evidence import Ranked
from identification.faults import NO_SUSPICION, _left_in, _mended, _without_fault, suspicion
from identification.fit import fit
from identification.hypothesis import Hypothesis, with_own_number
from identification.reached import NOISE_REACHED
from identification.rest_target import ModesTarget
from identification.session import Session
from identification.together import off_by
from models.effects import EFFECTS, Place
from models.effects.base_motion import BaseMotion
from models.effects.coulomb_friction import CoulombFriction
from models.effects.force_gain import ForceGain
from models.effects.mains_hum import MainsHum
from models.effects.point_mass import PointMass
from models.effects.sensor_delay import SensorDelay
from models.effects.sensor_gain import SensorGain
from models.effects.sensor_position import SensorPosition
from models.effects.sensor_swap import SensorSwap
from models.linear import natural_modes
from models.rig import Excitation

P3 = REFERENCE.sensor("P3")
ON_P3 = Place(sensor="P3")


def looked_at(*effects, own=(), sigmas=None, sensors=None, beside=(), jobs=2):
    """What is suspected on two records of the rig with hidden effects, its numbers off within their tolerances.

    Only some sensors may be of the second record, and FRFs or modes lie beside.
    """
    n = len(REFERENCE.parameters())
    off = np.random.default_rng(2).standard_normal(n) if sigmas is None else sigmas
    truth = moved(REFERENCE, *off).with_effects(*effects)
    for name, value in own:
        for record in ("low", "high"):
            truth = with_own_number(truth, record, name, value)
    forces = {"low": multisine(2048, 2, rms=4.0), "high": multisine(2048, 2, rms=20.0, seed=2)}
    evaluator = evaluator_of(*(measured(truth, force, name=name) for name, force in forces.items()), jobs=jobs)
    if sensors is not None:
        low, high = evaluator.timed
        evaluator = evaluator.with_targets([low.only(sensors[0]), high.only(sensors[1])])
    evaluator = evaluator.with_targets([*beside, *evaluator.targets])
    given = Hypothesis(REFERENCE)
    base = calibrate(evaluator, given, unknowns_of(given, evaluator))
    there = fit(evaluator, base.hypothesis, base.unknowns, max_iterations=1)
    return suspicion(evaluator, there)


@pytest.mark.parametrize(
    "effect",
    [
        SensorGain(ON_P3, gain=-1.0),
        SensorGain(ON_P3, gain=1.03),
        SensorDelay(ON_P3, delay=2e-4),
        SensorPosition(ON_P3, position=P3.position + 0.03),
        SensorGain(ON_P3, gain=0.01),
    ],
    ids=["upside down", "3 % too much", "late", "displaced", "nearly dead"],
)
def test_a_channel_that_contradicts_the_others_is_named(effect):
    seen = looked_at(effect)
    assert seen.channels == (ON_P3,)
    assert effect.kind in seen.kinds(EFFECTS)
    assert all("sensor" in kind.places for kind in seen.kinds(EFFECTS).values())
    assert "P3 contradicts the other channels" in seen.words


def test_what_a_look_leaves_unlikely_is_not_fitted_in_full(monkeypatch):
    heard_in_full, heard = [], {sensor.name for sensor in REFERENCE.sensors}

    def counting(evaluator, *args, **kwargs):
        if kwargs.get("formed"):
            heard_in_full.append(frozenset(evaluator.timed[0].record.sensors))
        return fit(evaluator, *args, **kwargs)

    monkeypatch.setattr("identification.faults.fit", counting)
    assert looked_at(SensorGain(ON_P3, gain=-1.0), jobs=1).channels == (ON_P3,)
    assert set(heard_in_full) == {frozenset(heard), frozenset(heard - {"P3"})}


CHANNELS = tuple(Place(sensor=name) for name in ("P1", "P2", "P3"))


@pytest.mark.parametrize(
    ("whole", "looks", "slopes", "full", "left"),
    [
        (1000, (200, 800, 900), (1, 1, 1), {"P1": 500}, (0.2, 0.8, 0.9)),
        (1000, (600, 800, 900), (1, 1, 1), {"P1": 100}, (0.1, 0.8, 0.9)),
        (1000, (900, 800, 900), (1, 1, 0.3), {"P3": 50}, (0.9, 0.8, 0.05)),
        (1000, (900, 800, 950), (1, 1, 1), {"P2": 20}, (0.9, 0.02, 0.95)),
        (1000, (300, 800, 400), (1, 1, 1), {"P1": 290, "P3": 200}, (0.29, 0.8, 0.2)),
        (1000, (None, 800, 950), (1, 1, 1), {"P2": None}, (np.inf, 0.8, 0.95)),
        (-20, (-30, -40, -50), (1, 1, 1), {}, (1, 1, 1)),
        (50, (-30, 40, 45), (1, 1, 1), {}, (1, 1, 1)),
        (None, (None, None, None), (1, 1, 1), {}, (1, 1, 1)),
    ],
    ids=[
        "a look is enough",
        "a look promises",
        "slopes promise",
        "least of all",
        "two promise",
        "a fit diverges",
        "less than the noise",
        "hardly more",
        "all diverge",
    ],
)
def test_in_full_is_fitted_what_a_look_or_slopes_promise(monkeypatch, whole, looks, slopes, full, left):
    asked = []

    def fitted(_window, _grounds, faults):
        asked.append([(fault.sensor, is_look) for fault, is_look in faults])
        beyond = {None: whole, **dict(zip(("P1", "P2", "P3"), looks, strict=True))}
        ends = [
            beyond[fault.sensor] if is_look or fault == Place() else full[fault.sensor] for fault, is_look in faults
        ]
        return [None if end is None else fit_of(SensorGain(ON_P3, gain=1.0), 1000.0 + end) for end in ends]

    monkeypatch.setattr("identification.faults._grounds", lambda *_: [])
    monkeypatch.setattr("identification.faults._fitted_without", fitted)
    monkeypatch.setattr("identification.faults._left_beside", lambda *_: dict(zip(CHANNELS, slopes, strict=True)))

    found = _left_in(None, None, CHANNELS, ())

    assert [found[channel] for channel in CHANNELS] == pytest.approx(left)
    looks_first, *rest = asked
    assert looks_first == [(None, False), ("P1", True), ("P2", True), ("P3", True)]
    assert {one for batch in rest for one in batch} == {(name, False) for name in full}


@pytest.mark.parametrize("gain", [-1.0, 9.80665], ids=["upside down", "g"])
def test_a_force_that_makes_all_channels_contradict_the_model_alike_is_suspected(gain):
    seen = looked_at(ForceGain(Place(), gain=gain))
    assert set(seen.kinds(EFFECTS)) == {"force_gain"}
    assert "all 8 channels are" in seen.words


def test_where_the_base_is_driven_no_force_is_suspected():
    """Sensors in g on a shaker table: no gain of a force mends that."""
    rig = REFERENCE.model_copy(update={"excitation": Excitation(quantity="base_acceleration")})
    record, noise = measured(Hypothesis(rig), multisine(2048, 2, rms=2.0))
    in_g = replace(record, responses=record.responses / 9.80665), replace(noise, sensors=noise.sensors / 9.80665)
    evaluator, given = evaluator_of(in_g, rig=rig), Hypothesis(rig)
    there = fit(evaluator, given, unknowns_of(given, evaluator), max_iterations=1)
    assert off_by(in_g[0].responses, evaluator.responses(given)[0].channels)

    assert not suspicion(evaluator, there).of_force


@pytest.mark.parametrize(("one", "other"), [("P3", "P6"), ("P7", "P8")])
def test_two_channels_that_agree_when_exchanged_are_named(one, other):
    pair = Place(sensor=one, other=other)
    seen = looked_at(SensorSwap(pair))
    assert seen.channels == (pair,)
    assert set(seen.kinds(EFFECTS)) == {"sensor_swap"}
    assert pair in seen.beside(REFERENCE)
    assert f"{one} and {other} seem to be exchanged" in seen.words


def test_of_two_sensors_the_pair_alone_can_be_seen():
    pair = Place(sensor="P3", other="P6")
    assert looked_at(SensorSwap(pair), sensors=[("P3", "P6"), ("P3", "P6")]).channels == (pair,)
    assert looked_at(SensorGain(ON_P3, gain=1.03), sensors=[("P3", "P6"), ("P3", "P6")]) == NO_SUSPICION


def test_a_record_of_the_channel_that_is_left_out_is_left_out_with_it():
    every = [sensor.name for sensor in REFERENCE.sensors]
    seen = looked_at(SensorGain(ON_P3, gain=0.01), sensors=[every, ("P3",)])
    assert seen.channels == (ON_P3,)


def test_beside_modes_the_channels_of_the_time_records_are_asked():
    modes = ModesTarget.of(modes_of(Hypothesis(REFERENCE)))
    assert looked_at(SensorGain(ON_P3, gain=1.03), beside=[modes]).channels == (ON_P3,)


def test_exchanged_sensors_reach_the_noise_of_a_shaking_force():
    """Channels that are exchanged have exchanged shares of the force's noise, too, but not where they sit."""
    pair, given = Place(sensor="P3", other="P6"), Hypothesis(REFERENCE)
    forces = {"low": multisine(2048, 2, rms=4.0), "high": multisine(2048, 2, rms=20.0, seed=2)}
    records = [
        measured(given.with_effects(SensorSwap(pair)), force, force_noise=0.03, name=name)
        for name, force in forces.items()
    ]
    evaluator = evaluator_of(*records, jobs=2)
    evaluator = evaluator.with_targets(carry_noise(evaluator, given, np.random.default_rng(0)))
    session = Session(evaluator, evaluator, [], EFFECTS, lambda _: None, 0)
    base = fit(evaluator, given, unknowns_of(given, evaluator))
    assert suspicion(evaluator, base).channels == (pair,)
    swapped = fit(evaluator, base.hypothesis.with_effects(SensorSwap(pair)), base.unknowns)
    assert swapped.ratio > NOISE_REACHED

    (found,) = carried_through(session, [Ranked(SensorSwap(pair), swapped, refitted=True, log_evidence=0.0)])

    assert found.fit.ratio == pytest.approx(1.0, abs=0.1)
    assert session.fitting is not evaluator


def test_noise_is_carried_as_before_where_that_does_not_help():
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE), multisine(2048)))
    session = Session(evaluator, evaluator, [], EFFECTS, lambda _: None, 0)
    wrong = Hypothesis(REFERENCE).with_effects(SensorSwap(Place(sensor="P3", other="P6")))
    ranked = [Ranked(wrong.effects[0], fit(evaluator, wrong, ()), refitted=True, log_evidence=0.0)]
    assert carried_through(session, ranked) is ranked
    assert session.fitting is session.everything is evaluator


def test_exchanging_channels_twice_changes_nothing():
    (target,) = evaluator_of(measured(Hypothesis(REFERENCE), multisine(1024))).timed
    once = target.exchanged("P1", "P3")
    rows = [target.record.sensors.index(name) for name in ("P1", "P3")]
    np.testing.assert_array_equal(once.measured[rows], target.measured[rows[::-1]])
    np.testing.assert_allclose(once.density[rows], target.density[rows[::-1]])
    np.testing.assert_array_equal(once.exchanged("P3", "P1").measured, target.measured)
    assert target.exchanged("P1", "nobody") is target


@pytest.mark.parametrize(
    ("effect", "own"),
    [
        (MainsHum(Place(), frequency=50.02, amplitude=0.3), [(f"hum_phase_{h}", 0.4) for h in (1, 3, 5)]),
        (BaseMotion(Place(), frequency=83.3, amplitude=0.5), [("base_phase", 1.0)]),
    ],
    ids=lambda value: getattr(value, "kind", ""),
)
def test_lines_in_all_channels_are_no_physics_of_the_rig(effect, own):
    seen = looked_at(effect, own=own)
    assert seen.in_lines
    assert set(seen.kinds(EFFECTS)) == {"mains_hum", "base_motion"}
    assert "single lines" in seen.words


def test_a_line_at_a_resonance_may_be_physics():
    model = linear_model(Hypothesis(REFERENCE), 200.0)
    resonance = float(natural_modes(model, (), 200.0).natural_freqs[-1])
    away, there = (
        looked_at(BaseMotion(Place(), frequency=frequency, amplitude=0.5), own=[("base_phase", 1.0)])
        for frequency in (0.9 * resonance, resonance)
    )
    assert away.in_lines
    assert not there.in_lines


@pytest.mark.parametrize(
    "effects",
    [
        (),
        (CoulombFriction(Place(position=0.9), friction_force=2.0, slip_velocity=1e-3),),
        (PointMass(Place(position=P3.position), mass=0.1),),
        (
            SensorGain(ON_P3, gain=1.3),
            SensorGain(Place(sensor="P1"), gain=0.7),
            SensorGain(Place(sensor="P5"), gain=1.4),
        ),
    ],
    ids=["nothing", "friction", "a mass at the sensor", "three sensors"],
)
def test_what_all_channels_feel_is_no_fault_of_one(effects):
    assert looked_at(*effects) == NO_SUSPICION


def test_of_two_channels_none_is_outvoted():
    two = REFERENCE.model_copy(update={"sensors": REFERENCE.sensors[:2]})
    truth = Hypothesis(two, effects=(SensorGain(Place(sensor=two.sensors[0].name), gain=-1.0),))
    evaluator = evaluator_of(measured(truth, multisine(2048, 2)))
    there = fit(evaluator, Hypothesis(two), unknowns_of(Hypothesis(two), evaluator), max_iterations=1)
    assert suspicion(evaluator, there) == NO_SUSPICION


def test_without_a_channel_the_rest_of_a_target_stays():
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE), multisine(1024)))
    (target,) = evaluator.timed
    less = target.without("P3")
    assert less.record.sensors == tuple(name for name in target.record.sensors if name != "P3")
    row = target.record.sensors.index("P1")
    np.testing.assert_array_equal(less.measured[less.record.sensors.index("P1")], target.measured[row])
    assert target.without("nobody") is target
    wrong = replace(Hypothesis(REFERENCE), values={"youngs_modulus": 2.2e11})
    whole = target.residual(wrong, evaluator.settings)
    kept = np.repeat(np.array(target.record.sensors) != "P3", 2 * target.measured.shape[1])
    np.testing.assert_allclose(less.residual(wrong, evaluator.settings), whole[kept])


@pytest.mark.parametrize("fault", [ON_P3, Place(sensor="P3", other="P2"), Place()], ids=["channel", "pair", "nothing"])
def test_the_slopes_without_a_channel_are_those_of_a_fit_without_it(fault):
    """Formed anew they are differences over other steps, which here changes them by a few thousandths."""
    forces = {"low": multisine(1024, 2, rms=4.0), "high": multisine(1024, 2, rms=20.0, seed=2)}
    truth = moved(REFERENCE, *np.ones(len(REFERENCE.parameters())))
    window = evaluator_of(*(measured(truth, force, name=name) for name, force in forces.items()))
    low, high = window.timed
    window = window.with_targets([low.only(["P3"]), high] if fault.other is None else [low, high])
    given = Hypothesis(REFERENCE)
    ground = fit(window, given, unknowns_of(given, window), max_iterations=0)
    heard = window.with_targets([t for t in (_without_fault(t, fault) for t in window.timed) if t.record.sensors])
    unknowns = concerning(ground, heard)

    shared = _mended(window, ground, fault).jacobian[[ground.unknowns.index(unknown) for unknown in unknowns]]

    own = fit(heard, given, unknowns, max_iterations=0).jacobian
    assert shared.shape == own.shape
    assert np.linalg.norm(shared - own, axis=1) == pytest.approx(np.zeros(len(own)), abs=0.02 * np.linalg.norm(own))
    assert len(heard.timed) == (1 if fault == ON_P3 else 2)
