import mujoco
import numpy as np
import pytest
from chain_scenes import REFERENCE

from models.chain.mjcf import ChainSettings
from models.chain.native_contact import SIDES
from models.chain.rig_chain import build_chain
from models.effects import EFFECTS, build_effect
from models.errors import InputError
from models.plant import build_plant
from models.rig import EffectEntry
from models.simulators import simulator
from models.simulators.protocol import Resolution, Trial

NATIVE = ChainSettings(2e-5, 1.0 / 12.0, rotary_inertia=False, native_contact=True)


@pytest.fixture(scope="module")
def chain():
    return build_chain(build_plant(REFERENCE), 24, NATIVE)


@pytest.mark.parametrize("side", SIDES)
def test_the_engines_contact_has_our_stiffness_damping_and_gap(chain, side):
    """Pressed in by hand, without elastic forces and weight; the impedance leaves a thousandth of inertia."""
    model, data = chain.model, mujoco.MjData(chain.model)
    contact, up = chain.plant.contacts[1], SIDES[side]
    ball = model.geom("sleeve 2 ball").id
    jacobian = np.zeros((3, model.nv))
    mujoco.mj_forward(model, data)
    mujoco.mj_jac(model, data, jacobian, None, data.geom_xpos[ball], int(model.geom_bodyid[ball]))
    lift = np.zeros(model.nv)
    lift[-20:] = 1.0
    lift /= jacobian[2] @ lift

    def force(penetration, rate):
        data.qpos[:] = -up * (contact.clearance + penetration) * lift
        data.qvel[:] = -up * rate * lift
        mujoco.mj_forward(model, data)
        if not data.ncon:
            return 0.0
        # What is left of the constraint where nothing accelerates: (S p + B v) / R.
        rows = [i for i in range(data.nefc) if data.contact[data.efc_id[i]].geom2 == ball]
        return sum(data.efc_aref[i] / data.efc_R[i] for i in rows)

    assert force(-1e-7, 0.0) == 0.0
    assert force(1e-4, 0.0) == pytest.approx(10.0, rel=2e-3)
    assert force(1e-4, 0.01) - force(1e-4, 0.0) == pytest.approx(0.8, rel=2e-3)


def test_the_engines_contact_moves_the_beam_as_ours_does():
    """The ball rides on a rigid segment, our law on the beam that it stands for: 1e-8 m, and 1 % after hits."""
    push = np.zeros(512)
    push[20:60] = 40.0 * np.sin(np.linspace(0.0, np.pi, 40)) ** 2
    plant, trial = build_plant(REFERENCE), Trial(2048.0, push)
    own, native = (simulator("mujoco").run(plant, trial, Resolution(native_contact=flag)) for flag in (False, True))
    assert np.sqrt(np.mean((native.channels - own.channels) ** 2) / np.mean(own.channels**2)) < 0.02
    of_both = [motion.contact_forces.sum(axis=1) / motion.fs for motion in (native, own)]
    np.testing.assert_allclose(of_both[0], of_both[1], rtol=0.01, atol=1e-3)
    assert native.energy.fault < 5e-4
    assert not np.array_equal(native.channels, own.channels)


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        ({"kind": "hunt_crossley", "dissipation": 2.0}, "sleeve 2: a hunt_crossley contact"),
        ({"kind": "clearance", "clearance": 0.0}, "sleeve 2: a contact without clearance"),
    ],
)
def test_a_contact_that_the_engine_does_not_have_is_refused_by_name(entry, words):
    effect = build_effect(EffectEntry(sleeve="sleeve 2", **entry), REFERENCE, EFFECTS)
    plant = build_plant(REFERENCE, [effect])
    with pytest.raises(InputError, match=rf"mujoco, native contact: {words}.*; .*push; take our own contact"):
        build_chain(plant, 24, NATIVE)
    assert "falls through" in simulator("mujoco").viewer_file(plant).replace("\n     ", " ")


def test_in_a_viewer_the_beam_falls_into_its_sleeves_and_stays_there():
    """From straight, under gravity: 0.16 mm of room, and a contact that gives some hundredths of a millimetre."""
    text = simulator("mujoco").viewer_file(build_plant(REFERENCE))
    assert "meets a plane on each side" in text
    model = mujoco.MjModel.from_xml_string(text)
    data, ball = mujoco.MjData(model), model.geom("sleeve 2 ball").id
    lowest = 0.0
    for _ in range(int(0.3 / model.opt.timestep)):
        mujoco.mj_step(model, data)
        lowest = min(lowest, float(data.geom_xpos[ball, 2]))
    assert -1e-3 < lowest < -1.5e-4
