"""The rig out of its plane: nothing prefers a direction but gravity, and the engines agree on where the beam goes."""

from dataclasses import replace
from math import radians

import numpy as np
import pytest
from simulator_scenes import FS, REFERENCE, noise

from models.chain.mjcf import ChainSettings
from models.chain.rig_chain import build_chain
from models.errors import InputError
from models.plant import build_plant
from models.rig import EffectEntry
from models.simulators import simulator
from models.simulators.mujoco import largest_step
from models.simulators.protocol import Resolution, Trial
from models.structure import Absorber

ENGINES = ("mujoco", "exudyn")
SPACE, PLANE = Resolution(spatial=True), Resolution()
ANGLE = radians(35.0)
PLANT = build_plant(REFERENCE)
WEIGHTLESS = replace(PLANT, structure=replace(PLANT.structure, gravity=0.0))
FORCE = noise(512, 30.0)


@pytest.fixture(scope="module", params=ENGINES)
def moved(request):
    """In the plane, and under the same force turned about the beam's axis, without gravity."""
    engine = simulator(request.param)
    turned = Trial(FS, FORCE, angle=ANGLE)
    return engine.run(WEIGHTLESS, Trial(FS, FORCE), PLANE), engine.run(WEIGHTLESS, turned, SPACE)


def test_without_gravity_the_motion_turns_with_the_force(moved):
    """Exactly, but for MuJoCo's hinges, of which one turns in the frame of the other: angles of 1e-3 squared."""
    flat, turned = moved
    assert np.abs(flat.contact_forces).max() > 10.0
    for one, other in (
        (turned.channels, flat.channels),
        (turned.places, flat.places),
        (turned.contact_forces, flat.contact_forces),
    ):
        assert one == pytest.approx(np.cos(ANGLE) * other, abs=1e-5 * np.abs(other).max())
    assert turned.across.places == pytest.approx(np.tan(ANGLE) * turned.places, abs=1e-5 * np.abs(flat.places).max())
    largest = np.abs(flat.contact_forces).max()
    assert turned.across.forces == pytest.approx(np.tan(ANGLE) * turned.contact_forces, abs=1e-5 * largest)
    assert turned.gaps == pytest.approx(flat.gaps, abs=1e-5 * np.abs(flat.gaps).max())


def test_energy_is_accounted_for_in_space(moved):
    flat, turned = moved
    assert turned.energy.fault < 1e-5
    assert turned.energy.supplied == pytest.approx(flat.energy.supplied, abs=1e-4 * np.ptp(flat.energy.supplied))


@pytest.mark.parametrize("name", ENGINES)
def test_a_force_in_the_plane_leaves_the_beam_there(name):
    trial = Trial(FS, FORCE[:256])
    flat, free = simulator(name).run(PLANT, trial, PLANE), simulator(name).run(PLANT, trial, SPACE)
    assert np.abs(free.across.places).max() < 1e-12
    assert free.channels == pytest.approx(flat.channels, abs=1e-6 * np.abs(flat.channels).max())


def test_the_engines_agree_on_the_way_in_the_sleeves():
    """Under gravity, at an angle: a millimetre across, from 24 segments and from 14 elements."""
    trial = Trial(FS, FORCE, angle=ANGLE)
    found = [simulator(name).run(PLANT, trial, SPACE) for name in ENGINES]
    times = np.arange(512) / FS
    ways = []
    for motion in found:
        own = np.arange(motion.places.shape[1]) / motion.fs
        rows = np.vstack([motion.places, motion.across.places])
        ways.append(np.array([np.interp(times, own, row) for row in rows]))
    assert np.abs(ways[0][2:]).max() > 1e-4
    assert ways[0] == pytest.approx(ways[1], abs=0.01 * np.abs(ways[1]).max())
    assert np.ptp(np.arctan2(found[0].across.places[1], found[0].places[1])) > 1.0, "it does not stay on a line"


@pytest.mark.parametrize("name", ENGINES)
def test_without_sleeves_every_frequency_comes_twice(name):
    bare = replace(WEIGHTLESS, contacts=(), laws=())
    flat = simulator(name).natural_freqs(bare, 3, PLANE)
    assert simulator(name).natural_freqs(bare, 6, SPACE) == pytest.approx(np.repeat(flat, 2), rel=1e-7)


def test_a_beam_on_the_bottom_of_a_round_sleeve_swings_across_it():
    """The push of a closed sleeve turns with the place: a spring of force over radius, softer than the wall's."""
    flat = [simulator(name).natural_freqs(PLANT, 2, PLANE) for name in ENGINES]
    free = [simulator(name).natural_freqs(PLANT, 4, SPACE) for name in ENGINES]
    for own, all_four in zip(flat, free, strict=True):
        assert all_four[[1, 3]] == pytest.approx(own, rel=1e-6)
        assert all_four[0] < 0.95 * own[0]
    assert free[0] == pytest.approx(free[1], rel=1e-3)


@pytest.mark.parametrize("gravity", [0.0, 9.81])
def test_a_sleeve_without_a_gap_is_a_bushing(gravity):
    """As stiff across as in the plane, also where the beam sits at its centre, and damped alike in all directions."""
    plant = replace(
        PLANT,
        structure=replace(PLANT.structure, gravity=gravity),
        contacts=tuple(replace(contact, clearance=0.0) for contact in PLANT.contacts[1:]),
    )
    flat = simulator("mujoco").natural_freqs(plant, 2, PLANE)
    for name in ENGINES:
        assert simulator(name).natural_freqs(plant, 4, SPACE) == pytest.approx(np.repeat(flat, 2), rel=2e-3)
    across = Trial(FS, FORCE, angle=radians(90.0))
    upright = simulator("mujoco").run(replace(plant, structure=WEIGHTLESS.structure), Trial(FS, FORCE), PLANE)
    for name in ENGINES:
        lying = simulator(name).run(plant, across, SPACE)
        every = lying.fs / upright.fs
        own = np.arange(lying.places.shape[1]) / every
        expected = np.interp(own, np.arange(upright.places.shape[1]), upright.places[0])
        assert lying.across.places[0] == pytest.approx(expected, abs=0.02 * np.abs(expected).max())


def test_two_sleeves_that_are_alike_push_alike():
    twins = replace(PLANT, contacts=(PLANT.contacts[1], replace(PLANT.contacts[1], sleeve="its twin")))
    for name in ENGINES:
        motion = simulator(name).run(twins, Trial(FS, FORCE[:128], angle=ANGLE), SPACE)
        assert motion.contact_forces[0] == pytest.approx(motion.contact_forces[1])
        assert np.abs(motion.contact_forces).max() > 1.0


def test_a_stiff_clamp_costs_no_shorter_step_in_space():
    stiff = replace(PLANT, structure=replace(PLANT.structure, clamp_stiffness=1e7))
    steps = [
        largest_step(build_chain(stiff, 24, ChainSettings(1e-4, 0.0, rotary_inertia=False, spatial=spatial)))
        for spatial in (False, True)
    ]
    assert steps[1] == pytest.approx(steps[0], rel=1e-6)


def test_an_absorber_and_a_rig_without_sleeves():
    hung = replace(PLANT, structure=replace(PLANT.structure, absorbers=(Absorber(1.2, 0.3, 20.0, 0.05),)))
    for name in ENGINES:
        with pytest.raises(InputError, match=f"{name}: an absorber in space"):
            simulator(name).check(hung, SPACE)
        bare = replace(PLANT, contacts=(), laws=())
        assert simulator(name).run(bare, Trial(FS, FORCE[:64], angle=ANGLE), SPACE).across.places.shape[0] == 0


def test_what_does_not_go_together_is_refused_by_name():
    trial = Trial(FS, FORCE[:64])
    with pytest.raises(InputError, match=r"modal: motion in space; .*; leave --spatial out, or take mujoco or exudyn"):
        simulator("modal").run(PLANT, trial, SPACE)
    with pytest.raises(InputError, match=r"excitation.angle = 35 degrees; .*--spatial"):
        simulator("mujoco").run(PLANT, Trial(FS, FORCE[:64], angle=ANGLE), PLANE)
    with pytest.raises(InputError, match="mujoco: native contact in space"):
        simulator("mujoco").run(PLANT, trial, Resolution(spatial=True, native_contact=True))
    for effect in ({"kind": "hunt_crossley", "dissipation": 1.0}, {"kind": "gap_offset", "offset": 1e-5}):
        entry = EffectEntry(sleeve="sleeve 2", **effect)
        for name in ENGINES:
            simulator(name).check(build_plant(REFERENCE.model_copy(update={"effects": (entry,)})), SPACE)
    film = build_plant(
        REFERENCE.model_copy(update={"effects": (EffectEntry(kind="squeeze_film", sleeve="sleeve 2", damping=2.0),)})
    )
    for name in ENGINES:
        with pytest.raises(
            InputError, match=f"{name}: squeeze_film at sleeve 2, a law that knows the rig's plane only"
        ):
            simulator(name).run(film, trial, SPACE)
        simulator(name).check(film, PLANE)


@pytest.mark.parametrize(
    ("asked", "words"), [("rotary_inertia", "rotary inertia"), ("native_contact", "native contact")]
)
def test_cables_refuse_what_only_a_chain_has(asked, words):
    with pytest.raises(InputError, match=f"exudyn: {words}"):
        simulator("exudyn").check(PLANT, replace(PLANE, **{asked: True}))
