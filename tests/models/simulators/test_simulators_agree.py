"""Three ways to the same motion: static shapes, chain, cable. Where they differ, the tolerance says by what."""

from dataclasses import replace

import numpy as np
import pytest
from simulator_scenes import FS, REFERENCE, SHAKEN, impulses, moved, noise, nrmse, with_effects

from models.effects import EFFECTS
from models.plant import build_plant
from models.simulators import simulator
from models.simulators.protocol import Hold, Resolution, Trial
from models.structure import Absorber
from testbed.hidden_effects.scores import FINE_ALONE

ENGINES = ("mujoco", "exudyn")

WAVEFORM = {"mujoco": 0.01, "exudyn": 0.02}
"""Over a quarter of a second: segments of 6 cm and damping by the engine; the second order of generalised-alpha."""

PLACE_AT_REST = {"mujoco": 3e-8, "exudyn": 2e-9}
"""m of 1e-4: beside a force the chain reads the deflection from a cubic; the cable turns, if little."""

EXAMPLES = {
    "clearance": {"sleeve": "sleeve 2", "clearance": 0.0},
    "gap_offset": {"sleeve": "sleeve 2", "offset": 1e-4},
    "contact_stiffness": {"sleeve": "sleeve 1", "ratio": 0.5},
    "hertz_contact": {"sleeve": "sleeve 2", "stiffness": 1e7, "exponent": 1.5},
    "hunt_crossley": {"sleeve": "sleeve 2", "dissipation": 2.0},
    "squeeze_film": {"sleeve": "sleeve 2", "damping": 20.0},
    "coulomb_friction": {"position": 0.7, "friction_force": 5.0, "slip_velocity": 1e-3},
    "cubic_stiffness": {"position": 0.7, "stiffness": 1e11},
    "bouc_wen": {"position": 0.7, "force": 5.0, "yield_displacement": 1e-4, "exponent": 1.5},
    "point_stiffness": {"position": 0.7, "stiffness": 3e4},
    "point_damping": {"position": 0.7, "damping": 50.0},
    "point_mass": {"position": 0.7, "mass": 0.3},
    "absorber": {"position": 1.2, "mass": 0.2, "frequency": 40.0, "damping_ratio": 0.03},
    "clamp_compliance": {"rotational_stiffness": 8000.0},
    "axial_load": {"force": 300.0},
    "local_damage": {"position": 0.5, "loss": 0.5},
    "breathing_crack": {"position": 0.5, "loss": 0.5},
    "modal_damping": {"ratio": 3.0},
    "structural_damping": {"loss_factor": 0.05},
    "quadratic_drag": {"coefficient": 100.0},
    "youngs_modulus": {"ratio": 0.9},
    "time_varying_damping": {"sleeve": "sleeve 2", "times": (0.0, 0.1, 0.2), "values": (80.0, 400.0, 20.0)},
    "stiffness_drift": {"rate": 0.1},
    "wear": {"sleeve": "sleeve 2", "rate": 1e-3},
    "sensor_gain": {"sensor": "P3", "gain": -1.0},
    "sensor_delay": {"sensor": "P3", "delay": 1e-3},
    "sensor_position": {"sensor": "P3", "position": 0.8},
    "sensor_swap": {"sensor": "P3", "other": "P6"},
    "mains_hum": {"frequency": 50.0, "amplitude": 2.0},
    "force_gain": {"gain": 0.8},
    "base_motion": {"frequency": 30.0, "amplitude": 2.0},
}


def test_every_effect_of_a_beam_has_an_example():
    assert set(EXAMPLES) == {kind for kind, cls in EFFECTS.items() if "beam" in cls.structures}


def test_the_benchmark_knows_what_its_finite_elements_carry_alone():
    plants = {kind: with_effects({"kind": kind, **numbers}) for kind, numbers in EXAMPLES.items()}
    refused = {
        kind
        for kind, plant in plants.items()
        if any(simulator(name).cannot_carry(plant, Resolution()) for name in ENGINES)
    }
    assert refused == FINE_ALONE


@pytest.mark.parametrize("kind", EXAMPLES)
@pytest.mark.parametrize("name", ENGINES)
def test_every_effect_is_carried_or_refused_by_name(name, kind):
    plant = with_effects({"kind": kind, **EXAMPLES[kind]})
    trial = Trial(FS, noise(512, 30.0))
    missing = simulator(name).cannot_carry(plant, Resolution())
    if missing:
        assert all(missing)
        return
    found, expected = moved(name, plant, trial), moved("modal", plant, trial)
    assert nrmse(found.channels, expected.channels) < WAVEFORM[name]
    np.testing.assert_allclose(found.gaps[:, 0], expected.gaps[:, 0], rtol=0.0, atol=PLACE_AT_REST[name])
    assert found.energy.fault < 2e-4


@pytest.mark.parametrize(
    ("rig", "trial", "effects"),
    [
        (REFERENCE, Trial(FS, noise(512, 30.0), position=0.8), ()),
        (REFERENCE, Trial(FS, np.zeros(512), hold=Hold(1.3, 20.0)), ()),
        (SHAKEN, Trial(FS, noise(512, 10.0)), ()),
        (
            SHAKEN,
            Trial(FS, noise(512, 10.0)),
            ({"kind": "coulomb_friction", "against": "ground", **EXAMPLES["coulomb_friction"]},),
        ),
    ],
    ids=["the force elsewhere", "let go", "the base shaken", "the base shaken against friction on the ground"],
)
@pytest.mark.parametrize("name", ENGINES)
def test_every_kind_of_trial_is_carried_out(name, rig, trial, effects):
    plant = with_effects(*effects, rig=rig)
    found, expected = moved(name, plant, trial), moved("modal", plant, trial)
    assert nrmse(found.channels, expected.channels) < WAVEFORM[name]
    assert found.energy.fault < 2e-4


@pytest.mark.parametrize("name", ENGINES)
def test_an_absorber_is_carried(name):
    """A fifth of the beam's mass near its second mode, on the tip's side."""
    plant = build_plant(REFERENCE)
    hung = replace(plant, structure=replace(plant.structure, absorbers=(Absorber(1.2, 0.7, 40.0, 0.03),)))
    expected = simulator("modal").natural_freqs(hung, 5, Resolution(40))
    np.testing.assert_allclose(simulator(name).natural_freqs(hung, 5, Resolution()), expected, rtol=2e-4)
    trial = Trial(FS, noise(512, 30.0))
    found, answer = moved(name, hung, trial), moved("modal", hung, trial)
    assert nrmse(found.channels, answer.channels) < WAVEFORM[name]
    assert found.energy.fault < 2e-4
    shaken = replace(hung, excitation=SHAKEN.excitation)
    found, answer = (moved(each, shaken, Trial(FS, noise(512, 10.0))) for each in (name, "modal"))
    assert nrmse(found.channels, answer.channels) < WAVEFORM[name]


@pytest.mark.parametrize("name", ENGINES)
def test_a_force_elsewhere_is_another_test(name):
    plant, force = build_plant(REFERENCE), noise(256, 30.0)
    at_rig, elsewhere = moved(name, plant, Trial(FS, force)), moved(name, plant, Trial(FS, force, position=0.8))
    assert nrmse(elsewhere.channels, at_rig.channels) > 0.3


@pytest.mark.parametrize(("name", "bound"), [("mujoco", 1e-4), ("exudyn", 5e-5)])
def test_natural_frequencies_at_rest_on_the_sleeves(name, bound):
    """The chain's fourth order in the segment's length, the elements' fourth in theirs."""
    plant = build_plant(REFERENCE)
    expected = simulator("modal").natural_freqs(plant, 4, Resolution(40))
    np.testing.assert_allclose(simulator(name).natural_freqs(plant, 4, Resolution()), expected, rtol=bound)


@pytest.mark.parametrize("name", ["modal", *ENGINES])
def test_a_contact_never_pulls(name):
    """A sleeve so wide and so high that the beam only ever meets its lower side can only lift."""
    wide = {"kind": "clearance", "sleeve": "sleeve 2", "clearance": 2e-3}
    plant = with_effects({"kind": "gap_offset", "sleeve": "sleeve 2", "offset": 1e-3}, wide)
    lifting = moved(name, plant, Trial(FS, noise(512, 25.0))).contact_forces[1]
    assert lifting.min() == 0.0
    assert lifting[0] > 10.0
    assert np.diff(np.sign(lifting)).any()


@pytest.mark.slow
@pytest.mark.parametrize(("name", "waveform", "impulse"), [("mujoco", 0.015, 0.001), ("exudyn", 0.015, 0.001)])
@pytest.mark.parametrize("clearance", [5e-5, 1.5e-4, 2e-3])
def test_a_second_of_impacts(name, waveform, impulse, clearance):
    """The chain's error falls with its segments, the cable's with the square of the step."""
    sleeves = tuple(sleeve.model_copy(update={"clearance": clearance}) for sleeve in REFERENCE.sleeves)
    plant = build_plant(REFERENCE.model_copy(update={"sleeves": sleeves}))
    trial = Trial(FS, noise(2048, 30.0))
    found, expected = moved(name, plant, trial), moved("modal", plant, trial)
    assert nrmse(found.channels, expected.channels) < waveform
    np.testing.assert_allclose(impulses(found), impulses(expected), rtol=impulse, atol=impulse * 0.1)
    assert found.energy.fault < 2e-4
