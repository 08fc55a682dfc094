"""Diagnose, carry out what is proposed in another simulator, diagnose again: the group is told apart."""

from dataclasses import replace
from types import MappingProxyType

import numpy as np
import pytest

from identification.diagnose import diagnose
from identification.hypothesis import Hypothesis
from models.effects import EFFECTS, Place
from models.effects.coulomb_friction import CoulombFriction
from models.record import Record
from models.rig_file import write_rig
from models.simulate import Settings
from models.simulators.protocol import Resolution
from testbed.proposal import EXPERIMENT, write_experiment
from testbed.records.read import read_record
from testbed.simulate_run import Order, run_experiment
from tests.identification.trial_records import FS, REFERENCE, moved, multisine

FRICTION = CoulombFriction(Place(position=0.7), friction_force=0.3, slip_velocity=1e-2)
HIDDEN = """
[[truth.effects]]
kind = "coulomb_friction"
position = 0.7
friction_force = 0.3
slip_velocity = 1e-2
"""
KINDS = MappingProxyType({kind: EFFECTS[kind] for kind in ("coulomb_friction", "point_damping")})
BUILT = moved(REFERENCE, 0.5, -0.4, 0.3, 0.5, -0.5, 0.4, -0.6, 0.3, -0.2)
NOISE = 0.1
"""Of each channel, m/s^2: 5 % at this level."""


def quiet_record():
    """So quiet that the friction slides as slowly as a dashpot."""
    force, names = multisine(8192, rms=1.0, low=10.0), tuple(sensor.name for sensor in REFERENCE.sensors)
    silent = Record("quiet", FS, force, names, np.zeros((len(names), len(force))))
    clean = Hypothesis(REFERENCE, BUILT.values, effects=(FRICTION,)).simulated(silent, Settings()).channels
    return replace(silent, responses=clean + NOISE * np.random.default_rng(1).standard_normal(clean.shape))


@pytest.mark.slow
@pytest.mark.study
def test_the_file_that_a_diagnosis_writes_settles_what_it_left_open(tmp_path):
    old = quiet_record()
    before = diagnose(REFERENCE, [old], registry=KINDS, jobs=1)
    (group,) = before.indistinguishable
    assert {effect.kind for effect in group} == set(KINDS)
    proposal = before.next_experiment
    assert proposal.best.expected_probability > 0.95

    write_rig(BUILT.updated_rig, tmp_path / "built.toml")
    write_experiment(proposal, tmp_path / "built.toml", tmp_path)
    (tmp_path / EXPERIMENT).write_text((tmp_path / EXPERIMENT).read_text() + HIDDEN)
    order = Order(tmp_path / "built.toml", tmp_path / EXPERIMENT, "mujoco", Resolution(), ".h5")
    done = run_experiment(order, tmp_path / "records", jobs=1, progress=lambda _: None)
    rig = REFERENCE
    if proposal.rig is not None:
        rig = REFERENCE.model_copy(update={"sensors": proposal.rig.sensors})
    new = [read_record(tmp_path / "records" / row["record"], rig) for row in done["records"]]

    after = diagnose(rig, [old, *new], registry=KINDS, jobs=1)

    assert after.indistinguishable == ()
    assert [added.effect.kind for added in after.added] == ["coulomb_friction"]
    assert after.added[0].probability > 0.9
    # The test is chosen to tell the kinds apart, not to measure the force; what it says of that is told with its doubt.
    (force,) = [estimate for estimate in after.added[0].estimates if estimate.name == "friction_force"]
    assert abs(force.value - 0.3) < 3.0 * force.std
    assert force.std < 0.03
