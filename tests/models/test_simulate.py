"""From a plant and an excitation to channels: against independent integration, and as a record needs it."""

from dataclasses import replace

import numpy as np
import pytest
from model_scenes import (
    EI,
    LENGTH,
    REFERENCE,
    burst,
    driven,
    multisine,
    nrmse,
    record_of,
    rig_with,
    sensed,
    sleeve,
)
from scipy.integrate import solve_ivp
from test_drive import FREQ, OMEGA, Tremor

from models.band_limit import record_channels
from models.contact.kelvin_voigt import KelvinVoigt
from models.contact.protocol import ContactLaw
from models.effects import EFFECTS, Place
from models.errors import DivergenceError, InputError
from models.modal import build_modal
from models.plant import build_plant
from models.ports import PointLaw, Port
from models.rest import contact_force, law_force
from models.rig import Excitation, Oscillator, Rig, Sensor
from models.simulate import STEP_RATE, Settings, most_steps, motion_at, simulate, steps_per_sample

FS, N = 1024.0, 1024
FINER = 8  # for the other integrator, so that its impacts are not folded into the band
QUANTITIES = ("displacement", "velocity", "acceleration")
OSCILLATOR = Rig(
    structure=Oscillator(kind="oscillator", mass=3.0, stiffness=1200.0, damping=6.0),
    excitation=Excitation(),
    sensors=tuple(Sensor(name=q, quantity=q) for q in QUANTITIES),
)


def pulse(time, peak=20.0):
    """A force that is 0 at the record's ends with all its derivatives, as good as; band-limited to 100 Hz."""
    middle = N / FS / 2
    return peak * np.cos(2.0 * np.pi * FREQ * (time - middle)) * np.exp(-((9.0 * (time - middle) * FS / N) ** 2))


def integrated(plant, model, sensors):
    """(n_sensors, N) recorded displacements by an integrator that knows nothing of steps, blocks or crossings."""
    rows, n = np.stack([model.rows(s.position) for s in sensors]), model.n
    time = np.arange((N - 1) * FINER + 1) / (FS * FINER)
    force_row = model.rows(plant.excitation.position)
    laws = [(model.ports.index(law.port), law) for law in plant.laws]
    contacts = [(model.ports.index(Port(c.position)), c) for c in plant.contacts]

    def rate(t, x):
        q, v = model.rest.position + model.port_rows @ x[:n], model.port_rows @ x[n:]
        push = force_row * pulse(t)
        for (i, law), held in zip(laws, model.rest.law_forces, strict=True):
            push = push + model.port_rows[i] * (law_force(law, q[i], v[i]) - held)
        for (i, contact), held in zip(contacts, model.rest.contact_forces, strict=True):
            push = push + model.port_rows[i] * (contact_force(contact, q[i], v[i]) - held)
        return np.concatenate([x[n:], push - model.damping @ x[n:] - model.omega**2 * x[:n]])

    found = solve_ivp(rate, (0.0, time[-1]), np.zeros(2 * n), "DOP853", time, rtol=1e-9, atol=1e-12, max_step=1e-3)
    return record_channels(rows @ found.y[:n], FINER, N, FS)


def displacement_rig(rig):
    return sensed(rig, (0.4, "displacement"), (1.2, "displacement"))


CLAMPED_BY = {
    "a dashpot": (rig_with(), [EFFECTS["point_damping"](Place(position=1.1), damping=40.0)], None, 1e-5),
    "a strong dashpot": (rig_with(), [EFFECTS["point_damping"](Place(position=1.1), damping=2e3)], None, 1e-5),
    "a spring and a mass": (
        rig_with(),
        [EFFECTS["point_stiffness"](Place(position=0.8), 3e4), EFFECTS["point_mass"](Place(position=1.4), 0.5)],
        None,
        1e-5,
    ),
    "a sleeve": (rig_with(sleeve(1.0)), [], 64, 2e-4),
    "a sleeve with friction": (
        rig_with(sleeve(1.0)),
        [EFFECTS["coulomb_friction"](Place(sleeve="at 1.0", position=1.0), 2.0, 1e-2)],
        64,
        2e-4,
    ),
}


@pytest.mark.parametrize("case", CLAMPED_BY)
def test_the_motion_is_that_of_an_adaptive_integrator(case):
    """In three modes, and static shapes: higher ones cost the other integrator steps."""
    rig, effects, steps, tolerance = CLAMPED_BY[case]
    plant = build_plant(displacement_rig(rig), extra=effects)
    record = record_of(plant, pulse(np.arange(N) / FS), FS)
    response = simulate(plant, record, Settings(3, steps))
    expected = integrated(plant, response.model, plant.sensors)
    assert nrmse(response.channels, expected) < tolerance


@pytest.mark.parametrize(("n_modes", "steps", "bound"), [(None, None, 3e-3), (12, 16, 1e-3)])
def test_the_reference_rig_is_converged(n_modes, steps, bound):
    """Against 40 modes and 64 steps a sample, all channels, under 30 N rms from 3 to 250 Hz."""
    plant = build_plant(REFERENCE)
    record = record_of(plant, multisine(2048.0, 4096, 3.0, 250.0, 30.0), 2048.0)
    exact = simulate(plant, record, Settings(40, 64)).channels
    assert nrmse(simulate(plant, record, Settings(n_modes, steps)).channels, exact) < bound


def test_a_driven_base_is_a_force_on_all_that_is_carried():
    """On an oscillator -m a; absolute where the sensors are, relative plus the base's own motion."""
    acceleration = burst(FS, N, 5.0, 2.0)
    base = build_plant(driven(OSCILLATOR, "base_acceleration"))
    force = build_plant(OSCILLATOR)
    absolute = simulate(base, record_of(base, acceleration, FS)).channels
    relative = simulate(force, record_of(force, -3.0 * acceleration, FS)).channels
    np.testing.assert_allclose(absolute[2] - relative[2], acceleration, atol=1e-6 * 2.0)
    velocity = np.cumsum(acceleration) / FS
    np.testing.assert_allclose(
        absolute[1] - relative[1], velocity - 0.5 * acceleration / FS, atol=1e-3 * np.ptp(velocity)
    )


@pytest.mark.parametrize("quantity", ["base_displacement", "base_velocity", "base_acceleration"])
def test_a_stiff_oscillator_rides_on_its_base(quantity):
    """200 Hz against 5 Hz: the mass moves with the base but for (5 / 200)^2."""
    rig = OSCILLATOR.model_copy(update={"structure": OSCILLATOR.structure.model_copy(update={"stiffness": 4.7e6})})
    plant = build_plant(driven(rig, quantity))
    signal = burst(FS, N, 5.0, 1.0)
    channels = simulate(plant, record_of(plant, signal, FS)).channels
    of_the_same_kind = channels[("base_displacement", "base_velocity", "base_acceleration").index(quantity)]
    np.testing.assert_allclose(of_the_same_kind, signal, atol=2e-3)


def test_a_slow_base_carries_the_whole_beam():
    plant = build_plant(
        driven(sensed(rig_with(gravity=0.0), (0.3, "acceleration"), (LENGTH, "acceleration")), "base_acceleration")
    )
    signal = burst(FS, 8 * N, 1.0, 1.0)
    channels = simulate(plant, record_of(plant, signal, FS)).channels
    np.testing.assert_allclose(channels, np.tile(signal, (2, 1)), atol=0.05)  # (1 Hz / 6.7 Hz)^2 at the tip


def test_friction_against_the_ground_feels_the_base_and_against_the_base_does_not():
    """A mass that rides with its base: no friction against the base, all of it against the ground."""
    rig = driven(
        OSCILLATOR.model_copy(update={"structure": OSCILLATOR.structure.model_copy(update={"stiffness": 4.7e6})}),
        "base_velocity",
    )
    signal = burst(FS, N, 5.0, 1.0)
    forces = {}
    for frame in ("base", "ground"):
        plant = build_plant(rig, extra=[EFFECTS["coulomb_friction"](Place(), 2.0, 0.05, frame)])
        forces[frame] = simulate(plant, record_of(plant, signal, FS), Settings(trace=True)).trace
    fast = np.abs(np.repeat(signal, len(forces["ground"].q[0]) // N)) > 0.5
    assert np.abs(forces["base"].law_forces).max() < 0.5
    assert np.abs(forces["ground"].law_forces[0, fast]).min() > 1.99
    np.testing.assert_allclose(forces["ground"].v[0, :: len(fast) // N], signal, atol=5e-3)


def test_a_shaking_floor_adds_what_a_driven_base_would():
    rig = sensed(rig_with(), (1.2, "acceleration"), (1.2, "velocity"), (1.2, "displacement"))
    shaken = build_plant(rig, extra=[Tremor(Place(), size=0.5)])
    still, moved = build_plant(rig), build_plant(driven(rig, "base_acceleration"))
    time, force = np.arange(N) / FS, burst(FS, N, 20.0, 3.0)
    both = simulate(shaken, record_of(shaken, force, FS), free={"phase": 0.0}).channels
    forced = simulate(still, record_of(still, force, FS)).channels
    shake = simulate(moved, record_of(moved, 0.5 * np.sin(OMEGA * time), FS)).channels
    assert nrmse(both, forced + shake) < 5e-3  # the measured base is interpolated beyond its ends, the other is known


def test_the_phase_of_a_record_is_its_own():
    plant = build_plant(rig_with(), extra=[Tremor(Place(), size=0.5)])
    record = record_of(plant, None, FS, N)
    one, other = (simulate(plant, record, free={"phase": phase}).channels for phase in (0.0, np.pi))
    np.testing.assert_allclose(one, -other, atol=1e-9 * np.abs(one).max())
    assert np.abs(one).max() > 0.1


def test_an_initial_state_rings_down_as_the_textbook_says():
    plant = build_plant(OSCILLATOR)
    start = np.array([0.01, 0.0]) * np.sqrt(3.0)
    channels = simulate(plant, record_of(plant, None, FS, N), start=start).channels
    time, sigma, omega = np.arange(N) / FS, 1.0, np.sqrt(399.0)
    expected = 0.01 * np.exp(-sigma * time) * (np.cos(omega * time) + sigma / omega * np.sin(omega * time))
    np.testing.assert_allclose(channels[0], expected, atol=2e-5)  # the recorder bends the cut-off ends a little
    np.testing.assert_allclose(channels[0, 50:-50], expected[50:-50], atol=1e-7)


def test_a_record_may_say_where_its_hammer_struck():
    rig = sensed(rig_with(), (0.5, "acceleration"))
    plant = build_plant(rig)
    force = burst(FS, N, 20.0, 3.0)
    elsewhere = simulate(plant, record_of(plant, force, FS, excitation_position=0.9)).channels
    moved = build_plant(rig.model_copy(update={"excitation": Excitation(position=0.9)}))
    np.testing.assert_array_equal(elsewhere, simulate(moved, record_of(moved, force, FS)).channels)
    assert nrmse(elsewhere, simulate(plant, record_of(plant, force, FS)).channels) > 0.1


def test_reciprocity_in_time():
    """A force here read there is a force there read here, with sleeves that are linear."""
    rig = rig_with(sleeve(0.45, 0.0), sleeve(1.0, 0.0))
    force, read = burst(FS, N, 20.0, 3.0), []
    for struck, seen in ((0.7, 1.3), (1.3, 0.7)):
        plant = build_plant(sensed(rig, (seen, "acceleration")))
        read.append(simulate(plant, record_of(plant, force, FS, excitation_position=struck)).channels)
    assert nrmse(read[0], read[1]) < 2e-4  # other static shapes, and the second order of the steps


def test_a_sleeve_without_clearance_is_a_spring_and_a_dashpot():
    sensors = [(0.4, "displacement"), (1.2, "displacement")]
    held = build_plant(sensed(rig_with(sleeve(1.0, 0.0, stiffness=3e4, damping=20.0)), *sensors))
    place = Place(position=1.0)
    linear = build_plant(
        sensed(rig_with(), *sensors),
        extra=[EFFECTS["point_stiffness"](place, 3e4), EFFECTS["point_damping"](place, 20.0)],
    )
    force = burst(FS, N, 20.0, 3.0)
    found, exact = (simulate(p, record_of(p, force, FS), Settings(8, 32)).channels for p in (held, linear))
    assert nrmse(found, exact) < 1e-4


def test_a_slow_force_deflects_the_beam_as_a_static_one():
    plant = build_plant(sensed(rig_with(), (1.3, "displacement"), (1.3, "angular_velocity"), (1.3, "velocity")))
    slow = burst(256.0, 16384, 0.05, 2.0)
    channels = simulate(plant, record_of(plant, slow, 256.0)).channels
    np.testing.assert_allclose(channels[0], slow * 1.3**3 / (3.0 * EI), atol=1e-3 * 2.0 / EI)  # (0.05 / 6.7)^2, lag
    rate = np.gradient(slow, 1.0 / 256.0)
    np.testing.assert_allclose(channels[1], rate * 1.3**2 / (2.0 * EI), atol=1e-3 * np.abs(rate).max() / EI)
    np.testing.assert_allclose(channels[2], rate * 1.3**3 / (3.0 * EI), atol=1e-3 * np.abs(rate).max() / EI)


def test_channels_come_in_the_order_of_the_record():
    plant = build_plant(REFERENCE)
    record = record_of(plant, burst(FS, N, 20.0, 3.0), FS)
    swapped = replace(record, sensors=("P8", "P1"), responses=np.zeros((2, N)))
    whole = simulate(plant, record).channels
    np.testing.assert_allclose(simulate(plant, swapped).channels, whole[[7, 0]], atol=1e-12)


def test_a_sensor_that_the_rig_does_not_have_is_named():
    plant = build_plant(REFERENCE)
    record = replace(record_of(plant, np.zeros(N), FS), sensors=("P1", "P9"), responses=np.zeros((2, N)))
    with pytest.raises(InputError) as caught:
        simulate(plant, record)
    assert caught.value.given == "test: sensor 'P9'"
    assert caught.value.expected == "the rig has P1, P2, P3, P4, P5, P6, P7, P8"
    assert caught.value.mend == "rename the channel"


def test_a_motion_without_bound_says_when_and_what_to_look_for():
    plant = replace(build_plant(rig_with()), laws=(PointLaw(Port(1.4), pushing, (5e3,)),))
    with pytest.raises(DivergenceError) as caught:
        simulate(plant, record_of(plant, burst(FS, N, 20.0, 3.0), FS))
    message = str(caught.value)
    assert message.startswith("test: the motion grew without bound 0.")
    assert "s after the start; a passive structure stays finite" in message
    assert "negative stiffness or damping" in message


def pushing(t, q, v, z, p):
    return p[0] * v


class Stiffening(KelvinVoigt):
    """k p^3 in place of k p, so that ``stiffness`` alone says nothing about the slope."""

    name = "stiffening"

    @staticmethod
    def normal_force(t, p, p_rate, z, c):
        return c[0] * p * p * p + c[1] * p_rate


@pytest.mark.parametrize(("law", "load", "slope"), [(KelvinVoigt(1e5), 7.0, 1e5), (Stiffening(1e13), 10.0, 1e9)])
def test_the_slope_of_a_contact_is_taken_under_its_load(law, load, slope):
    assert isinstance(law, ContactLaw)
    assert law.slope_under(load) == pytest.approx(slope, rel=0.0 if law.name == "kelvin_voigt" else 3.0)


def test_steps_follow_the_band_and_the_stiffest_contact():
    model = build_modal(build_plant(REFERENCE), 880.0)
    assert steps_per_sample(model, 2048.0, 30.0) == STEP_RATE / 2048.0
    assert steps_per_sample(model, 20000.0, 30.0) == 1
    assert steps_per_sample(build_modal(build_plant(rig_with()), 880.0), 1000.0, 30.0) == 7
    stiff = build_modal(build_plant(rig_with(sleeve(1.0, stiffness=2e7))), 880.0)
    assert 3 < steps_per_sample(stiff, 2048.0, 30.0) < most_steps(2048.0)
    endless = build_modal(build_plant(rig_with(sleeve(1.0, stiffness=1e12))), 880.0)
    assert steps_per_sample(endless, 2048.0, 30.0) == most_steps(2048.0)


def test_the_stepper_takes_the_laws_own_slope_and_not_its_coefficient():
    plant = build_plant(rig_with(sleeve(1.0)))
    contact = replace(plant.contacts[0], law=Stiffening(1e13))
    model = build_modal(replace(plant, contacts=(contact,)), 880.0)
    assert steps_per_sample(model, 2048.0, 1e-3) < steps_per_sample(model, 2048.0, 1e3)


def test_a_start_serves_a_model_with_another_port_too():
    plant = build_plant(REFERENCE)
    model = build_modal(plant, 0.43 * FS)
    start = np.zeros(2 * model.n)
    start[0], start[model.n + 1] = 1e-3, 0.05
    spring = EFFECTS["point_damping"](Place(position=0.77), damping=1e-9)

    plants = plant, build_plant(REFERENCE, [spring])
    alone, other = (simulate(p, record_of(p, None, FS, N), start=start).channels for p in plants)

    np.testing.assert_allclose(other, alone, atol=2e-3 * np.abs(alone).max())


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        ("stiffness_drift", {"rate": 0.02}),
        ("wear", {"rate": 2e-5}),
        ("time_varying_damping", {"times": (0.0, 2.0, 4.0), "values": (5.0, 200.0, 20.0)}),
    ],
)
def test_a_motion_and_the_time_that_ran_tell_how_it_goes_on(kind, values):
    """Beyond the samples that the recorder's filter spreads the new beginning over."""
    place = Place() if kind == "stiffness_drift" else Place(sleeve="sleeve 1")
    plant, half = build_plant(REFERENCE, [EFFECTS[kind](place, **values)]), 2 * N
    whole = record_of(plant, multisine(FS, 2 * half, 5.0, 200.0, 20.0), FS)
    rest = replace(whole, excitation=whole.excitation[half:], responses=whole.responses[:, half:])
    start, expected = motion_at(plant, whole, half), simulate(plant, whole).channels[:, half:]
    later, same = (simulate(each, rest, start=start).channels for each in (plant.later(half / FS), plant))
    judged = slice(32, N // 4)
    assert nrmse(later[:, judged], expected[:, judged]) < 0.005
    assert nrmse(same[:, judged], expected[:, judged]) > 0.05
