"""Block by block against the whole record, laws that change on the way, and what is carried."""

from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest
from model_scenes import REFERENCE, burst, multisine, nrmse, record_of, rig_with, sensed

from models.band_limit import PAD
from models.contact.kelvin_voigt import KelvinVoigt
from models.contact.time_varying import TimeVarying
from models.effects import EFFECTS, Place
from models.errors import DivergenceError
from models.live import LONGEST_BLOCK, LiveModel
from models.live_band import CHANNEL_REACH, FORCE_REACH
from models.plant import build_plant
from models.ports import PointLaw, Port
from models.rig import Excitation, Oscillator, Rig, Sensor
from models.simulate import Settings, simulate
from models.stepping import march_on

FS, N, PEAK = 2048.0, 3072, 100.0
SLEEVE_2 = Place(sleeve="sleeve 2", position=1.0)
TABLE = EFFECTS["time_varying_damping"](SLEEVE_2, times=(0.2, 0.7, 1.3), values=(10.0, 300.0, 40.0))
FORCE = multisine(FS, N, 3.0, 250.0, 30.0)

CUT = 5e-5
"""What the end of the recorder's kernel costs channels with impacts: up to 106 / 64^3 = 4e-4 near 0.35 fs and 6 / 64^2
in the corners of the gain, where there is little to lose."""


def plant_with(*effects):
    return build_plant(REFERENCE, extra=effects)


def started(plant, **choices):
    return LiveModel.of(plant, FS, **{"peak": PEAK, **choices})


def advanced(live, force, size):
    """(n_sensors, n_samples) channels, late."""
    return np.hstack([live.advance(force[i : i + size]) for i in range(0, len(force), size)])


def compared(live, plant, force, size=200):
    """Channels from block to block and of the whole record, where neither knows of the record's ends."""
    late, whole = advanced(live, force, size), simulate(plant, record_of(plant, force, FS)).channels
    inside = slice(PAD, len(force) - live.latency - PAD)
    return late[:, live.latency :][:, inside], whole[:, : len(force) - live.latency][:, inside]


PLANTS = {
    "contact": plant_with,
    "a damping that varies": lambda: plant_with(TABLE),
    "an internal state": lambda: plant_with(EFFECTS["bouc_wen"](SLEEVE_2, 5.0, 5e-4, 2.0)),
    "a gap that opens": lambda: replace(
        plant_with(), contacts=tuple(replace(c, clearance_rate=1e-4) for c in plant_with().contacts)
    ),
}


@pytest.mark.parametrize("size", [1, 64, 1000])
@pytest.mark.parametrize("case", PLANTS)
def test_the_blocks_joined_are_the_whole_record(case, size):
    plant = PLANTS[case]()
    live = started(plant)
    assert live.latency == CHANNEL_REACH + FORCE_REACH
    found, expected = compared(live, plant, FORCE, size)
    assert nrmse(found, expected) < CUT
    assert live.time == (N - 1 - FORCE_REACH) / FS


@pytest.mark.parametrize("case", PLANTS)
def test_what_is_lost_is_lost_by_the_cut_alone(case):
    """It falls with the reach, to what the window on the force and the iteration's tolerance leave of the motion."""
    plant = PLANTS[case]()
    errors = [nrmse(*compared(started(plant, reach=reach), plant, FORCE)) for reach in (64, 128, 512)]
    assert errors[0] > 4.0 * errors[1] > 20.0 * errors[2]
    assert errors[2] < 1e-6


def test_the_motion_does_not_depend_on_the_blocks_at_all():
    ends = []
    for size in (1, 64, 1000, N):
        live = started(plant_with(TABLE))
        advanced(live, FORCE, size)
        ends.append((live._motion.state, *live._motion.memory, live._motion.fine))
    for end in ends[1:]:
        for found, expected in zip(end, ends[0], strict=True):
            np.testing.assert_array_equal(found, expected)


def test_a_force_that_begins_softly_is_followed_from_the_first_sample():
    plant, force = plant_with(), burst(FS, N, 60.0, 80.0)
    live = started(plant)
    found = advanced(live, force, 205)
    whole = simulate(plant, record_of(plant, force, FS)).channels
    lag = live.latency
    assert nrmse(found[:, lag:], whole[:, :-lag]) < CUT
    assert np.abs(found[:, : lag - CHANNEL_REACH]).max() < 1e-12 * np.abs(found).max()  # rounding of two FFTs


def test_every_quantity_is_read():
    quantities = ("displacement", "velocity", "acceleration", "angular_velocity")
    plant = build_plant(sensed(REFERENCE, *((1.2, quantity) for quantity in quantities)))
    found, expected = compared(started(plant), plant, FORCE)
    for row, other in zip(found, expected, strict=True):
        assert nrmse(row, other) < CUT


def test_an_oscillator_runs_too():
    rig = Rig(
        structure=Oscillator(kind="oscillator", mass=3.0, stiffness=1200.0, damping=6.0),
        excitation=Excitation(),
        sensors=(Sensor(name="a", quantity="acceleration"), Sensor(name="x", quantity="displacement")),
    )
    plant = build_plant(rig)
    found, expected = compared(started(plant), plant, FORCE)
    assert nrmse(found[0], expected[0]) < CUT
    assert nrmse(found[1], expected[1]) < CUT


def test_the_resolution_is_that_of_the_whole_record_or_what_is_asked_for():
    plant = plant_with()
    whole = simulate(plant, record_of(plant, FORCE, FS))
    live, coarse = started(plant), started(plant, n_modes=6, steps=2)
    assert (live.steps_per_sample, live.model.n) == (whole.steps_per_sample, whole.model.n)
    assert (coarse.steps_per_sample, coarse.fs) == (2, FS)
    late, asked = advanced(coarse, FORCE, 300), simulate(plant, record_of(plant, FORCE, FS), Settings(6, 2)).channels
    inside = slice(PAD, N - coarse.latency - PAD)
    assert nrmse(late[:, coarse.latency :][:, inside], asked[:, : -coarse.latency][:, inside]) < CUT


def test_the_measurement_chain_is_that_of_the_whole_record():
    gains = EFFECTS["force_gain"](Place(), 1.3), EFFECTS["sensor_gain"](Place(sensor="P3"), 0.7)
    plant, plain = plant_with(*gains), plant_with()
    found, expected = compared(started(plant), plant, FORCE)
    assert nrmse(found, expected) < CUT
    assert nrmse(found, compared(started(plain), plain, FORCE)[0]) > 0.1


def test_at_rest_nothing_moves():
    assert np.abs(started(plant_with()).advance(np.zeros(N))).max() < 1e-9  # what the search for rest leaves


def size_of(value):
    """Bytes of all arrays in a value."""
    if isinstance(value, np.ndarray):
        return value.nbytes
    if isinstance(value, tuple):
        return sum(size_of(part) for part in value)
    return sum(size_of(getattr(value, f.name)) for f in fields(value)) if is_dataclass(value) else 0


def test_what_is_carried_does_not_grow():
    live = started(plant_with())
    sizes = set()
    for n in (1, 205, 3 * LONGEST_BLOCK + 7, 40):
        live.advance(FORCE[:1].repeat(n))
        sizes.add(size_of(live._motion))
    assert len(sizes) == 1
    assert sizes.pop() < 100_000


def halves(plant, change, at):
    """Channels of a live model that is changed where its motion has come to sample ``at``, and the changed model."""
    live = started(plant)
    given = at + 1 + FORCE_REACH
    first = advanced(live, FORCE[:given], 100)
    assert live.time == at / FS
    other = change(live)
    assert other.time == live.time
    return np.hstack([first, advanced(other, FORCE[given:], 100)])[:, live.latency :], other


def instants(plant):
    """A sample at which sleeve 2 is open, and one at which it is closed, in the second half of a second."""
    trace = simulate(plant, record_of(plant, FORCE, FS), Settings(trace=True)).trace
    force = trace.contact_forces[1, :: round(trace.fs / FS)][1024:]
    assert (force == 0).any()
    assert (force != 0).any()
    return 1024 + int(np.flatnonzero(force == 0)[0]), 1024 + int(np.flatnonzero(force != 0)[0])


def test_a_damping_that_changes_on_the_way_is_a_step_in_its_table():
    """Where the sleeve is closed at that instant, the table has changed at the end of one step already, and the live
    model at the start of the next: a sixth of a step's impulse of the change."""
    plant = plant_with()
    open_at, closed_at = instants(plant)
    for at, tolerance in ((open_at, CUT), (closed_at, 1e-3)):
        late, live = halves(plant, lambda live: live.with_damping({"sleeve 2": 400.0}), at)
        assert live.model.plant.contacts[1].law == KelvinVoigt(1e5, 400.0)
        knots = (at / FS - 1e-7, at / FS)
        table = plant_with(EFFECTS["time_varying_damping"](SLEEVE_2, times=knots, values=(80.0, 400.0)))
        whole = simulate(table, record_of(table, FORCE, FS)).channels
        inside = slice(at - PAD, N - live.latency - PAD)
        assert nrmse(late[:, inside], whole[:, inside]) < tolerance
        unchanged = simulate(plant, record_of(plant, FORCE, FS)).channels
        assert nrmse(whole[:, inside], unchanged[:, inside]) > 0.1


def test_a_damping_that_is_set_to_what_it_was_changes_nothing():
    plant = plant_with()
    late, _ = halves(plant, lambda live: live.with_damping({"sleeve 1": 80.0, "sleeve 2": 80.0}), 1200)
    straight = started(plant)
    np.testing.assert_allclose(late, advanced(straight, FORCE, 100)[:, straight.latency :], rtol=0.0, atol=1e-9)


def test_a_law_that_takes_over_knows_the_time():
    """From Kelvin-Voigt to the table whose damping is the same until then."""
    table = EFFECTS["time_varying_damping"](SLEEVE_2, times=(0.6, 0.9), values=(80.0, 400.0))
    late, live = halves(plant_with(), lambda live: live.changed(plant_with(table)), 1100)
    assert isinstance(live.model.plant.contacts[1].law, TimeVarying)
    whole = simulate(plant_with(table), record_of(plant_with(table), FORCE, FS)).channels
    inside = slice(PAD, N - live.latency - PAD)
    assert nrmse(late[:, inside], whole[:, inside]) < CUT


def test_a_model_whose_motion_is_continued_otherwise_goes_on_as_it_was():
    plant = plant_with()
    live, alone = started(plant), started(plant)
    for model in (live, alone):
        model.advance(FORCE[:1000])
    other = live.with_damping({"sleeve 1": 500.0})
    changed = other.advance(FORCE[1000:2000])
    expected = alone.advance(FORCE[1000:2000])
    np.testing.assert_array_equal(live.advance(FORCE[1000:2000]), expected)
    assert nrmse(changed[:, 200:], expected[:, 200:]) > 0.01


def pushing(t, q, v, z, p):
    return p[0] * v


def test_a_motion_without_bound_says_when():
    live = started(replace(build_plant(rig_with()), laws=(PointLaw(Port(1.4), pushing, (5e3,)),)))
    with pytest.raises(DivergenceError, match=r"live: the motion grew without bound 0\.\d+ s after the start;"):
        live.advance(FORCE)


@pytest.mark.parametrize("size", [64, 205, 1000])
def test_every_step_is_marched_once_whatever_the_blocks(monkeypatch, size):
    """What a block costs is its own samples: no block is lengthened by what came before it."""
    marched = []

    def counted(*arguments):
        marched.append((arguments[6], arguments[8].shape[1] - 1))
        return march_on(*arguments)

    monkeypatch.setattr("models.live.march_on", counted)
    live = started(plant_with())
    advanced(live, FORCE, size)
    steps = (N - 1 - FORCE_REACH) * live.steps_per_sample
    assert [past for past, _ in marched] == list(np.cumsum([0] + [done for _, done in marched]))[:-1]
    assert sum(done for _, done in marched) == steps
    assert max(done for _, done in marched) <= size * live.steps_per_sample
