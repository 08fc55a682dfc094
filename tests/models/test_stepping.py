"""The compiled stepper: the linear part exact, contacts and laws of second order, and energy where it belongs."""

from dataclasses import replace

import numpy as np
import pytest
from model_scenes import REFERENCE, burst, multisine, nrmse, record_of, rig_with, sleeve

from models.band_limit import STOP_EDGE
from models.contact.kelvin_voigt import KelvinVoigt
from models.drive import STILL, Drive
from models.effects import EFFECTS, Place
from models.modal import build_modal
from models.plant import build_plant
from models.ports import Contact, PointLaw, Port
from models.rig import Excitation, Oscillator, Rig
from models.simulate import STEP_RATE, Settings, simulate
from models.step_tables import items_of, linear_of
from models.stepping import Reading, march

FS, N = 1024.0, 512
LAST = Place(position=1.0)
ON_SLEEVE = Place(sleeve="at 1.0", position=1.0)


def beam(*effects, **changes):
    """The reference beam on sleeves of one kind."""
    return build_plant(rig_with(sleeve(0.45, **changes), sleeve(1.0, **changes)), extra=effects)


def free_beam(*effects):
    return build_plant(rig_with(), extra=effects)


def moved(plant, seconds, steps_per_second, velocity, one_by_one=False, tolerance=1e-9):
    """(time, q, v, port q, port forces, model) of a free motion from the modal velocities given.

    Args:
        plant: that moves.
        seconds: for so long.
        steps_per_second: of the stepper.
        velocity: at the start.
        one_by_one: each contact is iterated for by itself, whatever its law.
        tolerance: N.
    """
    model = build_modal(plant, STOP_EDGE * 2048.0)
    h, n = 1.0 / steps_per_second, int(seconds * steps_per_second)
    system, linear, inputs = linear_of(model, Drive(np.zeros(n), None, STILL, None), h)
    start = np.zeros(2 * model.n)
    start[model.n : model.n + len(velocity)] = velocity
    items, n_ports = items_of(model), len(model.ports)
    if one_by_one:
        items = items._replace(straight=np.zeros_like(items.straight))
    out, trace = np.empty((2 * model.n, n)), np.empty((n, 2 * n_ports + len(items.port)))
    read = Reading.of(system.to_modal)
    done = march(linear, items, inputs, STILL, system.from_modal @ start, read, out, trace, tolerance)
    assert done == n - 1
    q, v = np.split(out, 2)
    return np.arange(n) * h, q, v, trace[:, :n_ports].T, trace[:, 2 * n_ports :].T, model


def energy_of(plant, q, v, port_q, model):
    """Of a beam with elastic contacts: kinetic, bending, weight and contact, from the state at rest."""
    total = 0.5 * np.sum(v**2, axis=0) + 0.5 * np.sum((model.omega[:, None] * q) ** 2, axis=0)
    for i, contact in enumerate(plant.contacts):
        row = port_q[model.ports.index(Port(contact.position))]
        depth = np.maximum(np.abs(row - contact.offset) - contact.clearance, 0.0)
        held = np.maximum(model.rest.penetration[i], 0.0)
        total = total + 0.5 * contact.law.stiffness * (depth**2 - held**2)
        total = total + model.rest.contact_forces[i] * (
            row - model.rest.position[model.ports.index(Port(contact.position))]
        )
    return total


COARSE, FINE = (2, 4, 8), (8, 16, 32, 64)
ORDER = {
    "Kelvin-Voigt": (beam, 2, FINE),
    "a strong dashpot": (lambda: beam(damping=400.0), 2, FINE),
    "a spring alone": (lambda: beam(damping=0.0), 3, FINE),
    "Hunt-Crossley": (lambda: beam(law="hunt_crossley", damping=5.0), 3, FINE),
    "squeeze film": (lambda: beam(EFFECTS["squeeze_film"](ON_SLEEVE, damping=18.0)), 2, FINE),
    "Bouc-Wen": (lambda: free_beam(EFFECTS["bouc_wen"](LAST, 5.0, 5e-4, 2.0)), 2, FINE),
    "a bilateral sleeve": (lambda: beam(clearance=0.0), 4, COARSE),
    "one under Hunt-Crossley": (lambda: beam(clearance=0.0, law="hunt_crossley", damping=5.0), 2, FINE),
    "Coulomb": (lambda: free_beam(EFFECTS["coulomb_friction"](LAST, 3.0, 1e-2)), 4, COARSE),
    "cubic": (lambda: free_beam(EFFECTS["cubic_stiffness"](LAST, 1e9)), 4, COARSE),
}


@pytest.mark.parametrize("case", ORDER)
def test_the_observed_order_is_the_declared_one(case):
    """Four where the motion is smooth, until the iteration's tolerance shows; three for forces that have a corner where
    contact begins; two where they jump, or their slope in a sleeve without clearance, or have an internal state."""
    make, order, steps = ORDER[case]
    plant = make()
    record = record_of(plant, multisine(FS, N, 3.0, 150.0, 30.0, seed=3), FS)
    exact = simulate(plant, record, Settings(8, 512)).channels
    error = [nrmse(simulate(plant, record, Settings(8, r)).channels, exact) for r in steps]
    slope = -np.polyfit(np.log2(steps), np.log2(error), 1)[0]
    assert slope > order - 0.15
    assert error[-1] < 1e-4


@pytest.mark.parametrize("h", [1e-4, 1e-3, 0.02])
def test_the_linear_part_is_exact_for_any_step(h):
    """A constant force on a damped oscillator from rest, against the textbook's step response."""
    rig = Rig(structure=Oscillator(kind="oscillator", mass=3.0, stiffness=1200.0, damping=6.0), excitation=Excitation())
    model, n = build_modal(build_plant(rig), 100.0), int(1.0 / h) + 1
    system, linear, inputs = linear_of(model, Drive(np.full(n, 12.0), None, STILL, None), h)
    out, rows = np.empty((1, n)), Reading.of(system.displacement(model.rows(None)[None]))
    march(linear, items_of(model), inputs, STILL, np.zeros(len(system.from_modal)), rows, out, np.empty((0, 0)), 1e-9)
    time, sigma, omega = np.arange(n) * h, 1.0, np.sqrt(400.0 - 1.0)
    expected = 0.01 * (1.0 - np.exp(-sigma * time) * (np.cos(omega * time) + sigma / omega * np.sin(omega * time)))
    np.testing.assert_allclose(out[0], expected, atol=1e-14)


def test_a_band_limited_force_on_a_linear_beam_needs_no_small_step():
    plant = free_beam()
    record = record_of(plant, burst(FS, N, 100.0, 30.0), FS)
    exact = simulate(plant, record, Settings(8, 32)).channels
    for steps, tolerance in ((16, 1e-7), (8, 1e-6), (4, 1e-5)):  # what the straight lines' images beyond the band move
        assert nrmse(simulate(plant, record, Settings(8, steps)).channels, exact) < tolerance


def test_bouncing_on_springs_makes_no_energy():
    """Some hundred contacts a second: at the default step below 0.0003 % a second."""
    plant = build_plant(rig_with(sleeve(0.45, damping=0.0), sleeve(1.0, damping=0.0), rayleigh_damping=(0.0, 0.0)))
    drift = []
    for rate in (STEP_RATE, 4.0 * STEP_RATE):
        time, q, v, port_q, forces, model = moved(plant, 5.0, rate, (0.2, 0.1))
        energy = energy_of(plant, q, v, port_q, model)
        assert np.count_nonzero(np.diff((forces != 0).astype(int))) > 500
        assert np.abs(energy - energy[0]).max() < 1e-4 * energy[0]
        drift.append(abs(np.polyfit(time, energy, 1)[0]) / energy[0])
    assert drift[0] < 3e-6
    assert drift[1] < 0.1 * drift[0]


DISSIPATIVE = {
    "Kelvin-Voigt": beam,
    "a strong dashpot": lambda: beam(damping=2000.0),
    "Hunt-Crossley": lambda: beam(law="hunt_crossley", damping=20.0),
    "squeeze film": lambda: beam(EFFECTS["squeeze_film"](ON_SLEEVE, damping=18.0)),
    "Coulomb": lambda: beam(EFFECTS["coulomb_friction"](LAST, 3.0, 1e-3)),
}


@pytest.mark.parametrize("case", DISSIPATIVE)
def test_a_passive_rig_loses_energy_and_gains_none(case):
    plant = DISSIPATIVE[case]()
    _, q, v, port_q, _, model = moved(plant, 1.0, 32768.0, (0.2, 0.1))
    energy = energy_of(plant, q, v, port_q, model)
    assert np.diff(energy).max() < 1e-4 * energy[0]  # a step's share of the error of the method
    assert energy[-1] < 0.5 * energy[0]
    assert energy.min() > -1e-9 * energy[0]


@pytest.mark.parametrize("case", ["Kelvin-Voigt", "a strong dashpot", "Hunt-Crossley"])
def test_a_contact_never_pulls(case):
    plant = DISSIPATIVE[case]()
    response = simulate(plant, record_of(plant, multisine(FS, N, 3.0, 150.0, 60.0), FS), Settings(trace=True))
    trace = response.trace
    q = np.stack([trace.q[trace.ports.index(Port(c.position))] for c in plant.contacts])
    assert np.count_nonzero(trace.contact_forces) > 100
    assert (trace.contact_forces * q <= 0.0).all()
    assert not trace.contact_forces[np.abs(q) < plant.contacts[0].clearance].any()
    assert (q > 0).any()
    assert (q < 0).any()


@pytest.mark.parametrize("law", ["kelvin_voigt", "hunt_crossley", "hertz"])
def test_a_sleeve_without_clearance_holds_alike_from_below_and_from_above(law):
    held = {"clearance": 0.0, "law": law, "damping": 20.0, **({"stiffness": 1e7} if law == "hertz" else {})}
    plant = build_plant(rig_with(sleeve(0.45, **held), sleeve(1.0, **held), gravity=0.0))
    up, down = (moved(plant, 0.3, 16384.0, (side * 0.2, side * 0.1))[1] for side in (1.0, -1.0))
    # The stepper's iteration ends at 1e-9 of the motion, on either side.
    np.testing.assert_allclose(down, -up, atol=1e-6 * np.abs(up).max())
    assert np.abs(up[:, -1000:]).max() < 0.9 * np.abs(up[:, :1000]).max()


FIVE = [sleeve(0.2 * k, clearance=1e-4, damping=40.0) for k in range(1, 6)]
WEAR = EFFECTS["wear"](ON_SLEEVE, rate=1e-4)
TOGETHER = {
    "two sleeves": beam,
    "without clearance": lambda: beam(clearance=0.0),
    "off its axis": lambda: beam(EFFECTS["gap_offset"](ON_SLEEVE, offset=2e-4)),
    "that wears": lambda: beam(WEAR),
    "dashpots that would pull": lambda: beam(damping=400.0, clearance=5e-5),
    "a film beside them": lambda: beam(EFFECTS["squeeze_film"](ON_SLEEVE, damping=18.0)),
    "friction beside them": lambda: beam(EFFECTS["coulomb_friction"](LAST, friction_force=1.0, slip_velocity=1e-3)),
    "more than are joined": lambda: build_plant(rig_with(*FIVE)),
    "another law beside one": lambda: build_plant(rig_with(sleeve(0.45), sleeve(1.0, law="hunt_crossley"))),
}


@pytest.mark.parametrize("case", TOGETHER)
def test_straight_contacts_are_met_together_as_one_by_one(case):
    plant = TOGETHER[case]()
    (_, q, v, port_q, forces, _), one_by_one = (
        moved(plant, 0.2, 8192.0, (0.2, 0.1), one_by_one=alone) for alone in (False, True)
    )
    assert np.count_nonzero(forces) > 100
    for mine, other in zip((q, v, port_q, forces), one_by_one[1:5], strict=True):
        np.testing.assert_allclose(mine, other, atol=1e-6 * np.abs(other).max())


def test_contacts_that_always_hold_are_met_at_once_whatever_the_tolerance():
    plant = beam(clearance=0.0, damping=40.0)
    exact = moved(plant, 0.2, 8192.0, (0.2, 0.1))[1]
    joined, one_by_one = (
        np.abs(moved(plant, 0.2, 8192.0, (0.2, 0.1), one_by_one=alone, tolerance=1e3)[1] - exact).max()
        for alone in (False, True)
    )
    assert joined < 1e-10 * np.abs(exact).max() < 1e-6 * one_by_one


def test_a_contact_that_would_pull_where_a_step_begins_is_cut_there():
    """A kilogram that leaves the wall faster than the spring would push it, and is pushed back within the step."""
    rig = Rig(structure=Oscillator(kind="oscillator", mass=1.0, stiffness=1.0, damping=0.0), excitation=Excitation())
    wall = Contact("wall", None, KelvinVoigt(1e4, 20.0), 1e-4)
    model, h = build_modal(replace(build_plant(rig), contacts=(wall,)), 100.0), 1e-3
    system, linear, inputs = linear_of(model, Drive(np.full(2, 500.0), None, STILL, None), h)
    items, read, out = items_of(model), Reading.of(system.to_modal), np.empty((2, 2))
    ends = []
    for straight in (items.straight, np.zeros_like(items.straight)):
        each = items._replace(straight=straight)
        march(linear, each, inputs, STILL, system.from_modal @ [3e-4, -0.2], read, out, np.empty((0, 0)), 1e-9)
        ends.append(out[:, 1].copy())
    q, v = ends[0]
    assert 1e4 * (3e-4 - 1e-4) - 20.0 * 0.2 < 0.0 < min(q - 1e-4, 1e4 * (q - 1e-4) + 20.0 * v)
    np.testing.assert_allclose(ends[0], ends[1], rtol=1e-8)


def test_a_contact_that_would_pull_until_it_is_open_has_no_force():
    """A kilogram that leaves the wall, and is driven back to it so soon that it comes to rest beside it."""
    rig = Rig(structure=Oscillator(kind="oscillator", mass=1.0, stiffness=1.0, damping=0.0), excitation=Excitation())
    wall = Contact("wall", None, KelvinVoigt(4e5, 40.0), 1e-4)
    model, h = build_modal(replace(build_plant(rig), contacts=(wall,)), 100.0), 1.6e-4
    system, linear, inputs = linear_of(model, Drive(np.full(2, 35.0), None, STILL, None), h)
    items, read = items_of(model), Reading.of(system.to_modal)
    out, trace = np.empty((2, 2)), np.empty((2, 3))
    march(linear, items, inputs, STILL, system.from_modal @ [1e-4 + 1e-7, -3.5e-3], read, out, trace, 1e-12)
    assert 4e5 * 1e-7 - 40.0 * 3.5e-3 < 0.0
    assert out[0, 1] < 1e-4
    free = h * (-3.5e-3) + 0.5 * h**2 * 35.0
    assert out[0, 1] - 1e-4 - 1e-7 == pytest.approx(free, rel=1e-4)  # the spring's 1e-4 N beside 35 N
    assert not trace[:, 2].any()


def test_at_rest_nothing_moves():
    plant = build_plant(REFERENCE)
    response = simulate(plant, record_of(plant, np.zeros(N), FS), Settings(trace=True))
    assert np.abs(response.channels).max() < 1e-9
    still = response.trace.q - response.model.rest.position[:, None]
    assert np.abs(still).max() < 1e-13


def test_a_beam_thrown_through_the_gap_in_one_step_meets_the_other_side():
    plant = beam(clearance=1e-6)
    _, _, v, port_q, forces, _ = moved(plant, 0.05, 8192.0, (5.0,))
    assert np.isfinite(v).all()
    assert (np.sign(port_q[:, 1:]) != np.sign(port_q[:, :-1])).any()
    assert (forces != 0).any()


def test_a_law_that_makes_energy_is_noticed():
    plant = replace(free_beam(), laws=(PointLaw(Port(1.4), negative_dashpot, (5e3,)),))
    model = build_modal(plant, 800.0)
    n = 4000
    system, linear, inputs = linear_of(model, Drive(np.ones(n), None, STILL, None), 1e-3)
    state, out = np.zeros(len(system.from_modal)), np.empty((len(system.to_modal), n))
    done = march(
        linear, items_of(model), inputs, STILL, state, Reading.of(system.to_modal), out, np.empty((0, 0)), 1e-9
    )
    assert done < n - 1
    assert np.isfinite(out[:, : done + 1]).all()


def negative_dashpot(t, q, v, z, p):
    return p[0] * v


def test_a_step_of_any_length_is_taken_to_the_end():
    for n in (2, 3, 64, 101):
        model = build_modal(beam(), 800.0)
        system, linear, inputs = linear_of(model, Drive(np.ones(n), None, STILL, None), 1e-4)
        state, out = np.zeros(len(system.from_modal)), np.full((len(system.to_modal), n), np.nan)
        done = march(
            linear, items_of(model), inputs, STILL, state, Reading.of(system.to_modal), out, np.empty((0, 0)), 1e-9
        )
        assert done == n - 1
        assert np.isfinite(out).all()


@pytest.mark.parametrize("slip_velocity", [1e-3, 1e-6, 1e-9])
def test_friction_that_sticks_holds_still_however_steep_it_is(slip_velocity):
    """A free decay under dry friction: 4 F_c / k less with every cycle, then at rest where it stopped."""
    mass, stiffness, friction = 3.0, 1200.0, 1.0
    rig = Rig(structure=Oscillator(kind="oscillator", mass=mass, stiffness=stiffness, damping=0.0))
    plant = build_plant(rig, extra=[EFFECTS["coulomb_friction"](Place(), friction, slip_velocity)])
    omega = np.sqrt(stiffness / mass)
    time, q, v, _, forces, model = moved(plant, 2.5, 6144, [10.2 * friction / stiffness * omega * np.sqrt(mass)])
    q, v = q[0] * model.rows(None)[0], v[0] * model.rows(None)[0]
    turns = q[1:-1][(np.sign(v[1:-1]) != np.sign(v[2:])) & (time[1:-1] < 1.0)]
    sag = friction / stiffness
    first = np.hypot(10.2 * sag, sag) - sag  # about -sag, from where it begins at q = 0
    np.testing.assert_allclose(np.abs(turns), first - 2 * sag * np.arange(len(turns)), atol=3e-2 * sag)
    rest = time > 2.0
    assert np.abs(v[rest]).max() < max(slip_velocity, 1e-9)
    assert np.abs(np.diff(forces[0, rest])).max() < 1e-3 * friction
    np.testing.assert_allclose(forces[0, rest], stiffness * q[rest], rtol=1e-3, atol=1e-3)


def test_a_film_between_hard_walls_is_marched_through():
    """It damps less away from a wall, so more force may ask for more."""
    walls = {"clearance": 2e-5, "stiffness": 1e7, "damping": 1e5}
    film = EFFECTS["squeeze_film"](ON_SLEEVE, 300.0)
    plant = build_plant(rig_with(sleeve(0.45, **walls), sleeve(1.0, **walls)), extra=[film])
    record = record_of(plant, multisine(FS, N, 5.0, 200.0, 15.0), FS)
    assert np.isfinite(simulate(plant, record).channels).all()


def stiffening(t, q, v, z, p):
    return -p[0] * q - p[1] * q * q * q - p[2] * v


def test_many_ports_and_sensors_are_taken_eight_at_a_time():
    """Nine laws in either order, and seventeen rows that are read, each of which may be read alone."""
    laws = [PointLaw(Port(0.12 * k), stiffening, (50.0 + 20.0 * k, 1e6 * k, 0.3 * k)) for k in range(1, 10)]
    found = []
    for each in (laws, laws[::-1]):
        model = build_modal(replace(beam(), laws=tuple(each)), 800.0)
        system, linear, inputs = linear_of(
            model, Drive(burst(8192.0, 800, 30.0, 60.0), None, STILL, None), 1.0 / 8192.0
        )
        rows = np.vstack([system.velocity(np.eye(model.n)), system.displacement(np.eye(model.n))])
        assert len(model.ports) > 8
        for chosen in (rows[:17], *rows[:17, None]):
            out, start = np.empty((len(chosen), 800)), np.zeros(len(system.from_modal))
            march(linear, items_of(model), inputs, STILL, start, Reading.of(chosen), out, np.empty((0, 0)), 1e-12)
            found.append(out)
    for whole, *alone in (found[:18], found[18:]):
        np.testing.assert_array_equal(whole, np.vstack(alone))
    np.testing.assert_allclose(np.abs(found[0]), np.abs(found[18]), atol=1e-9 * np.abs(found[0]).max())
