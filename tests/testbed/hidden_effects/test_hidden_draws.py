"""Rigs, forces and laws as they are drawn; the modal model alone, so that it stays quick."""

from dataclasses import replace

import numpy as np
import pytest

from models.effects import EFFECTS, Place
from models.effects.clearance import Clearance
from models.effects.contact_stiffness import ContactStiffness
from models.effects.hertz_contact import HertzContact
from models.effects.hunt_crossley import HuntCrossley
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain
from models.effects.sensor_position import SensorPosition
from models.effects.youngs_modulus import YoungsModulus
from models.plant import build_plant
from testbed.hidden_effects.engines import engine_for
from testbed.hidden_effects.hiding import draw_wanted, hide
from testbed.hidden_effects.imitation import Imitation
from testbed.hidden_effects.motion import blank_record, channels_of
from testbed.hidden_effects.outside import OUTSIDE_LAWS
from testbed.hidden_effects.places import draw_place, is_apart, scene_at
from testbed.hidden_effects.plan import KINDS, Task
from testbed.hidden_effects.rigs import draw_rig
from testbed.hidden_effects.sets import SETS, TUNING, VARIED, Batch
from testbed.hidden_effects.sizes import jittered, on_the_beam, sized
from testbed.hidden_effects.tolerated import tolerated
from testbed.hidden_effects.trials import HELD, LEARNT, draw_trial
from testbed.hidden_effects.truth import ENGINES, FINE, MODEL, Truth, measure
from testbed.hidden_effects.waves import (
    BLOW_AT,
    DECAY_SECONDS,
    LOW,
    Bursts,
    Multisine,
    Sweep,
    draw_blows,
    schroeder_multisine,
)
from testbed.virtual.noise import Noise

NOISE = Noise(0.007, 0.007, share_of="channel")


@pytest.fixture(scope="module")
def trial():
    return draw_trial(TUNING, chaotic=False, rng=np.random.default_rng(3))


@pytest.fixture(scope="module")
def built(trial):
    return trial.built


@pytest.mark.parametrize("case_set", SETS.values(), ids=SETS)
def test_the_same_seed_draws_the_same_rig_and_another_seed_another(case_set):
    first, again, other = (draw_rig(case_set, np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert first == again
    assert first != other
    assert len(first.sensors) in case_set.n_sensors
    assert {sensor.quantity for sensor in first.sensors} <= set(case_set.quantities)
    assert {sleeve.law for sleeve in first.sleeves} <= set(case_set.laws)


def test_a_trial_has_two_levels_a_blow_and_a_level_between(trial):
    rms = {name: float(np.sqrt(np.mean(force**2))) for name, force in trial.forces.items()}
    assert list(trial.forces) == [*LEARNT, HELD]
    assert rms["low"] < rms[HELD] < rms["high"]
    assert sum(len(trial.forces[name]) for name in LEARNT) == 40.0 * trial.fs
    assert not trial.chaotic


def test_a_trial_of_other_tests_is_driven_as_its_set_says():
    trial = draw_trial(VARIED, chaotic=False, rng=np.random.default_rng(0))
    seconds = {name: len(force) / trial.fs for name, force in trial.forces.items()}
    assert list(seconds) == [*LEARNT, HELD]
    assert 32.0 <= sum(seconds[name] for name in LEARNT) <= 48.0
    assert seconds[HELD] in {6.0, 8.0}
    assert trial.telling <= seconds["high"]
    assert not trial.chaotic


def test_schroeders_multisine_has_its_lines_and_a_low_crest():
    wave = schroeder_multisine(1024.0, 4096, 5.0, 200.0, "odd", np.random.default_rng(0))
    lines = np.abs(np.fft.rfft(wave))
    freq = np.arange(len(lines)) * 0.25
    excited = (freq >= 5.0) & (freq <= 200.0) & (np.arange(len(lines)) % 2 == 1)
    assert np.ptp(lines[excited]) < 1e-9 * lines.max()
    assert lines[~excited].max() < 1e-9 * lines.max()
    assert np.sqrt(np.mean(wave**2)) == pytest.approx(1.0)
    random = Multisine("random", "full", 2.0, 16.0).draw(1024.0, 200.0, np.random.default_rng(0))
    assert np.abs(wave).max() < 2.0 < np.abs(random).max()  # Schroeder's is about 1.7, random phases give 3 and more


def test_a_blow_is_short_has_the_peak_asked_for_and_leaves_a_decay():
    blow = draw_blows(2048.0, 4e-3, 1)
    assert len(blow) == 8 * 2048
    assert blow.max() == pytest.approx(1.0, abs=0.05)  # the recorder's band rounds it
    assert np.abs(blow[int(0.2 * 2048) :]).max() < 1e-6


def test_no_law_outside_is_in_the_library_and_there_are_enough_of_them():
    assert len(OUTSIDE_LAWS) >= 5
    kinds = {law.kind for law in OUTSIDE_LAWS}
    assert len(kinds) == len(OUTSIDE_LAWS)
    assert not kinds & set(EFFECTS)
    assert not set(OUTSIDE_LAWS) & set(EFFECTS.values())


@pytest.mark.parametrize("law", OUTSIDE_LAWS, ids=[law.kind for law in OUTSIDE_LAWS])
def test_a_law_outside_grows_with_its_size_and_keeps_the_motion_finite(law, trial, built):
    place = Place(position=0.7 * built.structure.length)
    (effect, *_) = law.trials(scene_at(place, trial))
    force = trial.forces["high"][: int(trial.fs)]
    plain = channels_of(built, force, trial.fs)
    changes = [
        np.linalg.norm(channels_of(built, force, trial.fs, (effect.scaled(factor),)) - plain) for factor in (1e-3, 1e-2)
    ]
    assert 0.0 < changes[0] < changes[1] < np.inf
    assert changes[1] == pytest.approx(10.0 * changes[0], rel=0.5)  # small changes are in proportion, impacts nearly


def test_nothing_shows_as_the_noise_and_an_effect_as_much_as_asked(trial, built):
    rng = np.random.default_rng(5)
    imitation = Imitation(trial, NOISE, rng)
    assert imitation.shown((), rounds=1) == pytest.approx(1.0)
    place = Place(position=0.8 * built.structure.length)
    start = next(iter(EFFECTS["point_mass"].trials(scene_at(place, trial))))
    found = sized(start, imitation, 8.0, rng)
    assert found is not None
    assert found[1] == pytest.approx(8.0, rel=0.25)
    assert imitation.shown((found[0],), rounds=0) >= found[1]  # numbers moved within tolerance imitate some of it


def test_an_effect_on_a_displacement_shows_beside_accelerations(trial):
    """A gain off by a half in one of n channels is 0.5 / sqrt(n) of the motion, whatever the units."""
    *others, last = trial.rig.sensors
    sensors = (*others, last.model_copy(update={"quantity": "displacement"}))
    rig, built = (each.model_copy(update={"sensors": sensors}) for each in (trial.rig, trial.built))
    imitation = Imitation(replace(trial, rig=rig, built=built), NOISE, np.random.default_rng(5))
    gain = SensorGain(Place(sensor=last.name), gain=1.5)
    off = 0.5 / np.sqrt(len(sensors)) / np.sqrt(1.0 + (1.5**2 - 1.0) / len(sensors))  # of the motion as it reads
    assert imitation.shown((gain,), rounds=0) == pytest.approx(
        np.hypot(off, imitation.floor) / imitation.floor, rel=1e-6
    )


def test_two_effects_are_of_two_kinds_at_two_places(trial, built):
    task = Task("tuning", 11, "two", 0)
    for seed in range(6):
        rng = np.random.default_rng(seed)
        hidden = hide(task, trial, NOISE, draw_wanted(task, rng), rng)
        if hidden is not None:
            one, other = hidden.effects
            assert one.kind != other.kind
            assert is_apart(one.place, other.place, built.structure.length)
            return
    pytest.fail("no pair was found on this rig")


def test_a_number_within_four_of_its_tolerances_is_nothing_that_is_missing(trial, built):
    sleeve = trial.rig.sleeves[0]
    at = Place(sleeve=sleeve.name, position=sleeve.position)
    there = built.sleeves[0]
    of_built = trial.rig.structure.youngs_modulus / built.structure.youngs_modulus
    for near, far in (
        (YoungsModulus(Place(), ratio=1.035 * of_built), YoungsModulus(Place(), ratio=1.045 * of_built)),
        (Clearance(at, clearance=0.9 * sleeve.clearance), Clearance(at, clearance=0.85 * sleeve.clearance)),
        (
            ContactStiffness(at, ratio=1.2 * sleeve.stiffness / there.stiffness),
            ContactStiffness(at, ratio=1.25 * sleeve.stiffness / there.stiffness),
        ),
    ):
        assert tolerated(near, trial.rig, built)
        assert not tolerated(far, trial.rig, built)
    assert not tolerated(Clearance(at, clearance=0.0), trial.rig, built)
    assert not tolerated(PointMass(Place(position=0.5), mass=1e-6), trial.rig, built)


def test_a_dissipation_within_tolerance_is_missing_only_where_the_sleeve_has_another_law(trial, built):
    sleeve = trial.rig.sleeves[0]
    rig, there = (
        each.model_copy(
            update={"sleeves": (each.sleeves[0].model_copy(update={"law": "hunt_crossley"}), *each.sleeves[1:])}
        )
        for each in (trial.rig, built)
    )
    near, far = (HuntCrossley(Place(sleeve=sleeve.name), ratio * sleeve.damping) for ratio in (1.3, 1.5))
    assert tolerated(near, rig, there)
    assert not tolerated(far, rig, there)
    assert not tolerated(near, trial.rig, built)


def test_a_third_of_the_sizes_is_small():
    rng = np.random.default_rng(0)
    wanted = np.array([draw_wanted(Task("tuning", 11, "point_mass", 0), rng)[0] for _ in range(3000)])
    assert np.mean(wanted < 5.0) == pytest.approx(1.0 / 3.0, abs=0.035)  # four standard deviations
    assert wanted.min() >= 2.0
    assert wanted.max() <= 30.0
    assert draw_wanted(Task("tuning", 11, "nothing", 0), rng) == ()


def test_a_place_is_of_the_kind_that_the_effect_takes(trial):
    rng = np.random.default_rng(0)
    for kind in KINDS.values():
        place = draw_place(kind, trial.rig, rng)
        has = [key for key in ("sleeve", "position", "sensor") if getattr(place, key) is not None]
        assert has == [] if not kind.places else has[0] in kind.places


def test_the_true_noise_is_what_a_perfect_model_leaves(trial, built):
    truth = Truth(built, (), MODEL, Noise(0.007, 1e-9, share_of="channel"))
    force = trial.forces["high"][: int(4 * trial.fs)]
    record, noise = measure(truth, "high", force, trial.fs, np.random.default_rng(1))
    assert noise == pytest.approx(0.007 * np.sqrt(2 * 0.35), rel=0.02)  # white noise below 0.35 fs
    louder = Truth(built, (), MODEL, Noise(0.007, 0.007, share_of="channel"))
    assert measure(louder, "high", force, trial.fs, np.random.default_rng(1))[1] > noise
    assert record.responses.shape == (8, len(force))


def test_a_change_of_the_measurement_is_applied_once(trial, built):
    gain = EFFECTS["sensor_gain"](Place(sensor="P3"), gain=1.5)
    force, none = trial.forces["low"][: int(trial.fs)], Noise(0.0, 0.0)
    for engine in (MODEL, FINE):
        plain, with_gain = (
            measure(Truth(built, hidden, engine, none), "low", force, trial.fs, np.random.default_rng(0))[0].responses
            for hidden in ((), (gain,))
        )
        np.testing.assert_allclose(with_gain[2], 1.5 * plain[2], rtol=1e-9, atol=1e-12)
        np.testing.assert_array_equal(with_gain[3], plain[3])


def test_what_an_engine_cannot_carry_is_moved_by_another_and_the_turns_go_round(trial, built, monkeypatch):
    seen = []

    class Refusing:
        def cannot_carry(self, plant, resolution):
            seen.append(len(plant.effects))
            return ("anything",)

    monkeypatch.setattr("testbed.hidden_effects.engines.simulator", lambda name: Refusing())
    truth = Truth(built, (EFFECTS["force_gain"](Place(), gain=2.0),), MODEL, Noise(0.007, 0.007))
    tasks = [Task("tuning", 11, "nothing", number) for number in range(3)]
    engines = [engine_for(task, trial, truth, np.random.default_rng(0))[0] for task in tasks]
    assert engines == [FINE] * 3
    assert set(seen) == {1}
    assert len(seen) == len(ENGINES)  # of three turns one begins with the elements, one passes one engine, one both


def test_a_batch_may_put_the_engines_turn_on(trial, built, monkeypatch):
    """Batches that hold one case of each kind would move it by the same engine otherwise."""
    truth = Truth(built, (EFFECTS["force_gain"](Place(), gain=2.0),), MODEL, Noise(0.007, 0.007))
    asked = []

    class Refusing:
        def cannot_carry(self, plant, resolution):
            return ("anything",)

    monkeypatch.setattr("testbed.hidden_effects.engines.simulator", lambda name: asked.append(name) or Refusing())
    ways = []
    for turned in range(3):
        monkeypatch.setitem(SETS["tuning"].batches, 11, Batch("any", turned=turned))
        asked.clear()
        engine_for(Task("tuning", 11, "nothing", 0), trial, truth, np.random.default_rng(0))
        ways.append(tuple(asked))
    assert len(set(ways)) == len(ENGINES)


def test_a_blank_record_has_the_rigs_channels(built):
    record = blank_record(built, np.zeros(16), 1024.0)
    assert record.responses.shape == (8, 16)
    assert build_plant(built).sensors[0].name == record.sensors[0]


@pytest.mark.parametrize("wave", [Sweep(8.0, 2), Bursts(8.0, 4, 0.5), Bursts(8.0, 1, 1.0)], ids=str)
def test_every_wave_lasts_as_asked_has_rms_1_and_stays_in_its_band(wave):
    force = wave.draw(1024.0, 200.0, np.random.default_rng(0))
    assert len(force) == 8192
    assert np.sqrt(np.mean(force**2)) == pytest.approx(1.0)
    assert np.abs(force[[0, -1]]).max() < 1e-3  # no blow at its ends
    power = np.abs(np.fft.rfft(force)) ** 2
    freq = np.fft.rfftfreq(8192, 1.0 / 1024.0)
    assert power[(freq < 0.6 * LOW) | (freq > 1.1 * 200.0)].sum() < 1e-3 * power.sum()


def test_bursts_are_silent_in_between_and_none_comes_again():
    force = Bursts(8.0, 4, 0.5).draw(1024.0, 200.0, np.random.default_rng(0)).reshape(4, 2, 1024)
    assert not force[:, 1].any()
    likeness = np.corrcoef(force[:, 0])
    assert np.abs(likeness[np.triu_indices(4, 1)]).max() < 0.5


def test_a_sweep_passes_every_frequency_as_often_as_asked():
    force = Sweep(8.0, 2).draw(1024.0, 200.0, np.random.default_rng(0)).reshape(2, -1)
    np.testing.assert_array_equal(*force)
    crossings = np.flatnonzero(np.diff(np.signbit(force[0])))
    pace = np.diff(crossings)
    assert (pace[:20].mean() > 4.0 * pace[-20:].mean()) or (pace[-20:].mean() > 4.0 * pace[:20].mean())


def test_a_rig_is_looked_at_until_its_wave_has_met_the_whole_band(trial):
    """A slow sweep says nothing of high modes in its first seconds."""
    assert Sweep(16.0).telling == 16.0
    assert Sweep(12.0, 3).telling == 4.0
    swept = replace(trial, telling=Sweep(16.0).telling)
    assert len(swept.first_seconds("high")) == 16.0 * trial.fs
    assert len(trial.first_seconds("high")) == 4.0 * trial.fs


def test_several_blows_share_the_time():
    blows = draw_blows(1024.0, 4e-3, 4).reshape(4, -1)
    assert blows.shape == (4, round(DECAY_SECONDS / 4 * 1024))
    np.testing.assert_allclose(blows.argmax(axis=1), (BLOW_AT + 2e-3) * 1024, atol=1.5)


def test_a_contact_that_stiffens_is_as_stiff_where_it_is_pressed_as_was_drawn():
    """k p^1.5 / p at 10 um lies in the span of stiffness; a dissipation is no dashpot."""
    rigs = [draw_rig(VARIED, np.random.default_rng(seed)) for seed in range(60)]
    sleeves = [sleeve for rig in rigs for sleeve in rig.sleeves]
    assert {sleeve.law for sleeve in sleeves} == set(VARIED.laws)
    for sleeve in sleeves:
        pressed = sleeve.stiffness * (1e-5**0.5 if sleeve.law == "hertz" else 1.0)
        assert 0.99 * VARIED.stiffness.low <= pressed <= 1.01 * VARIED.stiffness.high
        assert sleeve.law != "hunt_crossley" or sleeve.damping <= 6.0


def test_no_number_is_drawn_at_its_bound_where_it_would_be_another_kind():
    """A Hertz contact of exponent 1 is a stiffer spring."""
    rng, start = np.random.default_rng(0), HertzContact(Place(sleeve="sleeve 1"), 1e7, 1.5)
    exponents = np.array([jittered(start, rng, 1.5).exponent for _ in range(500)])
    assert exponents.min() > 1.0
    assert exponents.max() < 4.0
    assert np.median(exponents) == pytest.approx(1.5, rel=0.1)


@pytest.mark.parametrize(("drawn", "kept"), [(0.4, 0.4), (5.475, 1.091)])
def test_a_sensor_is_hidden_where_the_beam_is(drawn, kept):
    """Beyond the free end the plant reads the free end, so that is the truth to be told."""
    assert on_the_beam(SensorPosition(Place(sensor="P1"), drawn), 1.091).position == kept
