"""Scenes without a time record: the motion under a unit excitation, whose level nobody knows."""

import numpy as np
import pytest
from rest_records import LINES, frfs_of, modes_of
from trial_records import FS, REFERENCE, evaluator_of, measured, oscillator

from identification.evaluate import Evaluator
from identification.hypothesis import Hypothesis
from identification.rest_target import FrfTarget, ModesTarget
from identification.scene import CREST, places_near, places_of, scenes, sleeves_of
from models.effects import EFFECTS, Place
from models.rig import Excitation


def test_what_can_sit_anywhere_is_looked_for_at_positions_those_of_the_sleeves_among_them():
    anywhere, in_sleeves = (places_of(EFFECTS[kind], REFERENCE) for kind in ("coulomb_friction", "squeeze_film"))

    assert all(place.sleeve is None for place in anywhere)
    assert {sleeve.position for sleeve in REFERENCE.sleeves} < {place.position for place in anywhere}
    assert in_sleeves == sleeves_of(REFERENCE)
    assert places_near(EFFECTS["coulomb_friction"], REFERENCE, 0.98) == [Place(position=0.98)]
    assert places_near(EFFECTS["squeeze_film"], REFERENCE, 0.98) == [Place(sleeve="sleeve 2", position=1.0)]


def test_a_mass_moves_as_its_receptance_says():
    rig = oscillator()
    evaluator = Evaluator([FrfTarget.of(frfs_of(Hypothesis(rig)))], 1)

    scene = scenes(evaluator, Hypothesis(rig), [Place()])[Place()]

    omega, about = 2.0 * np.pi * LINES, rig.structure
    motion = 1.0 / np.abs(about.stiffness - about.mass * omega**2 + 1j * about.damping * omega)
    assert scene.displacement == pytest.approx(CREST * np.sqrt(np.mean(motion**2)), rel=1e-9)
    assert scene.velocity == pytest.approx(np.sqrt(np.mean((omega * motion) ** 2)), rel=1e-9)
    assert (scene.force, scene.penetration) == (1.0, 0.0)
    assert scene.duration == pytest.approx(1.0 / 0.75)


def test_modes_of_a_rig_without_excitation_are_shaken_at_the_free_end():
    rig = REFERENCE.model_copy(update={"excitation": None})
    evaluator = Evaluator([ModesTarget.of(modes_of(Hypothesis(rig)))], 1)
    sleeve, end = Place(sleeve="sleeve 2", position=1.0), Place(position=1.469)

    found = scenes(evaluator, Hypothesis(rig), [sleeve, end])

    assert found[end].displacement > found[sleeve].displacement > 0.0
    assert found[sleeve].contact is not None
    assert not found[sleeve].driven_base


def test_on_a_driven_base_a_law_sees_relative_motion_and_the_ground_the_absolute():
    rig = oscillator().model_copy(update={"excitation": Excitation(quantity="base_displacement")})
    slow = 0.01 * np.sin(2.0 * np.pi * 2.0 * np.arange(4096) / FS) * np.minimum(1.0, np.arange(4096) / 2048)
    evaluator = evaluator_of(measured(Hypothesis(rig), slow))

    scene = scenes(evaluator, Hypothesis(rig), [Place()])[Place()]

    # A 60 Hz oscillator on a base that moves at 2 Hz lags behind it by (2 / 60)^2 of the base's motion.
    assert scene.displacement == pytest.approx(0.01 * (2.0 / 60.0) ** 2, rel=0.15)
    assert scene.ground_velocity == pytest.approx(np.sqrt(np.mean(np.gradient(slow) ** 2)) * FS, rel=0.02)
    assert scene.velocity < 0.01 * scene.ground_velocity
    assert scene.driven_base


def test_on_a_driven_base_a_beam_presses_into_its_sleeves_relative_to_them():
    excitation = REFERENCE.excitation.model_copy(update={"quantity": "base_displacement", "position": None})
    rig = REFERENCE.model_copy(update={"excitation": excitation})
    slow = 0.01 * np.sin(2.0 * np.pi * 2.0 * np.arange(2048) / FS) * np.minimum(1.0, np.arange(2048) / 1024)
    sleeve = Place(sleeve="sleeve 2", position=1.0)

    scene = scenes(evaluator_of(measured(Hypothesis(rig), slow)), Hypothesis(rig), [sleeve])[sleeve]

    assert 0.0 < scene.penetration < 1e-3
    assert scene.displacement < 1e-3
