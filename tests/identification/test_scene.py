"""Scenes without a time record: the motion under a unit excitation, whose level nobody knows."""

import numpy as np
import pytest
from rest_records import LINES, frfs_of, modes_of
from trial_records import REFERENCE, oscillator

from identification.evaluate import Evaluator
from identification.hypothesis import Hypothesis
from identification.rest_target import FrfTarget, ModesTarget
from identification.scene import CREST, scenes
from models.effects import Place


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
