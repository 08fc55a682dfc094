"""Unknowns: what is set is read again, bounds hold, and 0 is what was known beforehand."""

import numpy as np
import pytest
from trial_records import FS, REFERENCE, measured, oscillator, sweep

from identification.hypothesis import (
    LARGEST_SIGMA,
    EffectUnknown,
    Hypothesis,
    OffsetUnknown,
    PlaceUnknown,
    RigUnknown,
    StartUnknown,
    at_coordinates,
    coordinates,
    effect_unknowns,
    rig_unknowns,
)
from models.effects import EFFECTS, Place
from models.effects.clearance import Clearance
from models.effects.contact_stiffness import ContactStiffness
from models.effects.coulomb_friction import CoulombFriction
from models.effects.point_mass import PointMass
from models.effects.protocol import Scene
from models.effects.sensor_gain import SensorGain
from models.effects.sensor_position import SensorPosition
from models.effects.squeeze_film import SqueezeFilm
from models.effects.time_varying_damping import TimeVaryingDamping
from models.simulate import Settings

SLEEVE = Place(sleeve="sleeve 2", position=1.0)
MASS = PointMass(Place(position=0.7), mass=0.3)
GAIN = SensorGain(Place(sensor="P3"), gain=0.9)
FILM = SqueezeFilm(SLEEVE, damping=18.5)
HYPOTHESIS = Hypothesis(REFERENCE, effects=(MASS, GAIN, FILM))
EVERY = (
    *rig_unknowns(REFERENCE),
    *effect_unknowns(HYPOTHESIS),
    *(StartUnknown(i, 4, 1e-3, "run") for i in range(4)),
    OffsetUnknown(2.0, "run"),
)


def named(unknown):
    return f"{type(unknown).__name__} {getattr(unknown, 'entry', '')}"


@pytest.mark.parametrize("unknown", EVERY, ids=named)
@pytest.mark.parametrize("x", [-0.7, 0.0, 0.4, 1.3])
def test_what_is_set_is_read_again_and_nothing_else_moves(unknown, x):
    x += unknown.get(HYPOTHESIS)

    there = unknown.set(HYPOTHESIS, x)

    assert unknown.get(there) == pytest.approx(x, abs=1e-9)
    others = [other for other in EVERY if other is not unknown]
    np.testing.assert_allclose(coordinates(there, others), coordinates(HYPOTHESIS, others), atol=1e-12)


def test_all_at_once_are_read_again():
    x = coordinates(HYPOTHESIS, EVERY) + np.random.default_rng(1).uniform(-0.5, 0.5, len(EVERY))

    np.testing.assert_allclose(coordinates(at_coordinates(HYPOTHESIS, EVERY, x), EVERY), x, atol=1e-9)


def test_the_rig_as_given_is_the_centre_of_the_prior():
    assert all(unknown.prior for unknown in rig_unknowns(REFERENCE))
    assert np.all(coordinates(Hypothesis(REFERENCE), rig_unknowns(REFERENCE)) == 0.0)


def test_one_unit_is_one_deviation_of_the_tolerance():
    unknown = next(u for u in rig_unknowns(REFERENCE) if u.parameter.path == "sleeves[1].clearance")

    updated = unknown.set(HYPOTHESIS, 2.0).updated_rig

    assert updated.sleeves[1].clearance == pytest.approx(1.5e-4 * np.exp(0.06))
    assert updated.sleeves[0] == REFERENCE.sleeves[0]


def test_a_number_of_the_rig_stays_near_its_tolerance_and_positive():
    loose = RigUnknown(next(iter(oscillator(mass=0.5).parameters())))

    assert loose.get(loose.set(Hypothesis(oscillator()), 9.0)) == LARGEST_SIGMA
    assert loose.set(Hypothesis(oscillator()), -9.0).values["mass"] == pytest.approx(2.0 * np.exp(-0.5 * LARGEST_SIGMA))


def test_a_log_number_begins_at_0_and_moves_in_spreads():
    mass = next(u for u in EVERY if isinstance(u, EffectUnknown) and u.effect == 0)

    assert (mass.get(HYPOTHESIS), mass.prior) == (0.0, True)
    assert mass.set(HYPOTHESIS, 1.0).effects[0].mass == pytest.approx(0.3 * np.exp(mass.about.spread))


def test_a_linear_number_is_counted_from_0_and_unknown_beforehand():
    gain = next(u for u in EVERY if isinstance(u, EffectUnknown) and u.effect == 1)

    assert (gain.get(HYPOTHESIS), gain.prior) == (1.0, False)
    assert gain.set(HYPOTHESIS, -1.0).effects[1].gain == pytest.approx(-0.9)


@pytest.mark.parametrize("x", [-1e6, 1e6])
def test_a_number_of_an_effect_keeps_its_bounds(x):
    for unknown in effect_unknowns(HYPOTHESIS, places=False):
        values = unknown.set(HYPOTHESIS, x).effects[unknown.effect].fitted_values()

        assert np.all(np.isfinite(values))
        assert unknown.about.lower <= values[unknown.entry] <= unknown.about.upper


def test_a_table_has_one_unknown_an_entry():
    plant = Hypothesis(REFERENCE).plant()
    scene = Scene(SLEEVE, plant.contacts[1], plant.structure, 1e-3, 0.1, 10.0, 1e-5, 4.0, driven_base=False)
    table = next(TimeVaryingDamping.trials(scene))

    unknowns = effect_unknowns(Hypothesis(REFERENCE, effects=(table,)), places=False)

    assert [u.entry for u in unknowns] == list(range(len(table.fitted_values())))
    assert len(unknowns) > 1


def test_only_a_free_position_is_an_unknown_place():
    places = [u for u in effect_unknowns(HYPOTHESIS) if isinstance(u, PlaceUnknown)]

    assert [u.effect for u in places] == [0]
    assert places[0].get(HYPOTHESIS) == pytest.approx(20.0 * 0.7 / 1.469)
    assert not any(isinstance(u, PlaceUnknown) for u in effect_unknowns(HYPOTHESIS, places=False))
    on_oscillator = Hypothesis(oscillator(), effects=(CoulombFriction(Place(), 1.0, 1e-3),))
    assert not any(isinstance(u, PlaceUnknown) for u in effect_unknowns(on_oscillator))


@pytest.mark.parametrize(("x", "position"), [(-3.0, 0.02 * 1.469), (25.0, 1.469)])
def test_a_place_stays_on_the_beam_and_off_the_clamp(x, position):
    place = next(u for u in EVERY if isinstance(u, PlaceUnknown))

    assert place.set(HYPOTHESIS, x).effects[0].place.position == pytest.approx(position)


def test_a_start_is_where_the_motion_begins():
    rig = oscillator("displacement")
    start = StartUnknown(0, 2, 1e-3, "run").set(Hypothesis(rig), 1.5)
    record, _ = measured(Hypothesis(rig), 0.0 * sweep(256), noise=0.0, name="run")
    mass, omega = rig.structure.mass, 2 * np.pi * 60.0

    read = start.simulated(record, Settings()).channels[0]

    # Modal displacements are in sqrt(kg) m; the decay of a damped oscillator released at rest.
    t, decay, rate = np.arange(256) / FS, 0.03 * omega, omega * np.sqrt(1 - 0.03**2)
    decaying = np.exp(-decay * t) * (np.cos(rate * t) + decay / rate * np.sin(rate * t))
    # The recorder's filter sees the release as a step and rings for a few samples at both ends.
    np.testing.assert_allclose(
        read[20:-20], (1.5e-3 / np.sqrt(mass) * decaying)[20:-20], atol=0.01 * 1.5e-3 / np.sqrt(mass)
    )


def test_a_start_belongs_to_its_record():
    rig = oscillator("displacement")
    start = StartUnknown(0, 2, 1e-3, "run").set(Hypothesis(rig), 1.5)
    other, _ = measured(Hypothesis(rig), 0.0 * sweep(256), noise=0.0, name="another")

    assert np.all(start.simulated(other, Settings()).channels == 0.0)


def test_an_offset_is_taken_from_what_the_channel_reads():
    rig = oscillator()
    record, _ = measured(Hypothesis(rig), sweep(512), noise=0.0, name="run")
    shifted, _ = measured(Hypothesis(rig), sweep(512) + 3.0, noise=0.0, name="run")
    corrected = OffsetUnknown(2.0, "run").set(Hypothesis(rig), 1.5)

    np.testing.assert_allclose(corrected.simulated(shifted, Settings()).channels, record.responses, atol=1e-9)


def test_the_registry_of_a_hypothesis_builds_the_effects_of_its_file():
    assert Hypothesis(REFERENCE).registry is EFFECTS
    assert Hypothesis(REFERENCE).with_effects(MASS).with_effects(GAIN).effects == (MASS, GAIN)


def test_a_displaced_sensor_stays_on_the_beam():
    """Beyond the free end nothing changes, and a difference taken there would call the place unknown."""
    length = REFERENCE.structure.length
    displaced = SensorPosition(Place(sensor="P3"), position=length)
    hypothesis = Hypothesis(REFERENCE, effects=(displaced,))
    (unknown,) = effect_unknowns(hypothesis)
    beyond = unknown.set(hypothesis, 2.0 * unknown.get(hypothesis))
    assert beyond.effects[0].position == length


def test_an_effect_taken_out_hands_its_number_back_to_its_sleeve():
    damping = next(p for p in REFERENCE.parameters() if p.path == "sleeves[1].damping")
    table = TimeVaryingDamping(SLEEVE, times=(0.0, 1.0), values=(1.1 * damping.value, 1.3 * damping.value))
    stiffer = ContactStiffness(SLEEVE, ratio=1.1)

    less = Hypothesis(REFERENCE, effects=(table, stiffer)).handed_back(0)

    assert less.effects == (stiffer,)
    assert less.values == {damping.path: pytest.approx(1.2 * damping.value)}
    wide = Hypothesis(REFERENCE, effects=(Clearance(SLEEVE, clearance=5.0 * REFERENCE.sleeves[1].clearance),))
    gap = next(p for p in REFERENCE.parameters() if p.path == "sleeves[1].clearance")
    assert gap.deviations(wide.handed_back(0).values[gap.path]) == pytest.approx(LARGEST_SIGMA)


def test_an_effect_that_stands_for_no_number_of_the_rig_hands_nothing_back():
    mass = Hypothesis(REFERENCE, {"density": 7900.0}, effects=(MASS,))

    less = mass.handed_back(0)

    assert (less.values, less.effects) == ({"density": 7900.0}, ())
