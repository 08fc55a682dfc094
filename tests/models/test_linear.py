"""The model linearised at rest: closed forms, limits, reciprocity, and the same answer as small motion in time."""

from dataclasses import replace

import numpy as np
import pytest

from models.effects import Place
from models.effects.bouc_wen import BoucWen
from models.effects.coulomb_friction import CoulombFriction
from models.effects.force_gain import ForceGain
from models.effects.point_damping import PointDamping
from models.effects.sensor_gain import SensorGain
from models.effects.squeeze_film import SqueezeFilm
from models.errors import InputError
from models.linear import frf, linearised, natural_modes
from models.modal import build_modal
from models.plant import build_plant
from models.record import Record
from models.rig import Beam, Excitation, Oscillator, Rig, Sensor, Sleeve
from models.simulate import simulate

LENGTH, E, DIAMETER, RHO = 1.5, 2e11, 0.02, 7850.0
EI, LINE_MASS = E * np.pi * DIAMETER**4 / 64, RHO * np.pi * DIAMETER**2 / 4
PLACES = (0.3, 0.7, 1.2, 1.5)


def beam_rig(*, sleeves=(), quantity="displacement", gravity=9.81, damping=(0.0, 0.0), **excitation):
    return Rig(
        structure=Beam(
            kind="beam", length=LENGTH, diameter=DIAMETER, youngs_modulus=E, density=RHO,
            rayleigh_damping=damping, gravity=gravity,
        ),
        sleeves=sleeves,
        excitation=Excitation(**(excitation or {"position": 1.2})),
        sensors=tuple(Sensor(name=f"x{p}", position=p, quantity=quantity) for p in PLACES),
    )  # fmt: skip


def oscillator_rig(quantity, excitation="force", effects=()):
    return Rig(
        structure=Oscillator(kind="oscillator", mass=3.0, stiffness=1200.0, damping=0.7),
        excitation=Excitation(quantity=excitation),
        sensors=(Sensor(name="mass", quantity=quantity),),
    )


def linear_of(rig, *effects, band=400.0):
    return linearised(build_modal(build_plant(rig, effects), band))


def names(rig):
    return [sensor.name for sensor in rig.sensors]


def sleeve(position=1.0, clearance=1e-4, stiffness=1e5, damping=80.0):
    return Sleeve(name="sleeve", position=position, clearance=clearance, stiffness=stiffness, damping=damping)


def test_a_cantilever_has_its_textbook_frequencies():
    rig = beam_rig()
    modes = natural_modes(linear_of(rig), rig.sensors, 400.0)
    beta_l = np.array([1.8751040687, 4.6940911330, 7.8547574382, 10.9955407349])
    expected = (beta_l / LENGTH) ** 2 * np.sqrt(EI / LINE_MASS) / (2 * np.pi)
    assert modes.natural_freqs[:4] == pytest.approx(expected, rel=1e-6)
    assert np.abs(modes.damping_ratios).max() < 1e-9


def test_rayleigh_damping_gives_each_mode_its_ratio():
    rig = beam_rig(damping=(1.2, 6e-6))
    modes = natural_modes(linear_of(rig), rig.sensors, 400.0)
    omega = 2 * np.pi * modes.natural_freqs
    assert modes.damping_ratios == pytest.approx(0.5 * (1.2 / omega + 6e-6 * omega), rel=1e-6)


def test_shapes_of_proportional_damping_are_real_and_their_largest_is_one():
    rig = beam_rig(damping=(1.2, 6e-6))
    shapes = natural_modes(linear_of(rig), rig.sensors, 400.0).shapes
    assert np.abs(shapes.imag).max() < 1e-8
    assert np.abs(shapes).max(axis=1) == pytest.approx(1.0)


def test_a_dashpot_in_one_place_makes_the_shapes_complex():
    rig = beam_rig()
    linear = linear_of(rig, PointDamping(Place(position=0.7), 20.0))
    assert np.abs(natural_modes(linear, rig.sensors, 400.0).shapes.imag).max() > 1e-3


@pytest.mark.parametrize(("quantity", "order"), [("displacement", 0), ("velocity", 1), ("acceleration", 2)])
def test_an_oscillator_under_force_has_its_textbook_frf(quantity, order):
    frequency = np.array([0.5, 3.0, 3.2, 10.0])
    s = 2j * np.pi * frequency
    found = frf(linear_of(oscillator_rig(quantity)), frequency, ["mass"])[0]
    assert found == pytest.approx(s**order / (3.0 * s**2 + 0.7 * s + 1200.0), rel=1e-9)


@pytest.mark.parametrize("excitation", ["base_displacement", "base_velocity", "base_acceleration"])
def test_a_driven_base_has_the_textbook_transmissibility_whatever_measures_it(excitation):
    frequency = np.array([0.5, 3.0, 3.2, 10.0])
    s = 2j * np.pi * frequency
    quantity = excitation.removeprefix("base_")
    found = frf(linear_of(oscillator_rig(quantity, excitation)), frequency, ["mass"])[0]
    assert found == pytest.approx((0.7 * s + 1200.0) / (3.0 * s**2 + 0.7 * s + 1200.0), rel=1e-9)


def test_friction_against_the_ground_does_not_follow_the_base():
    frequency = np.array([0.5, 3.2, 10.0])
    s = 2j * np.pi * frequency
    rig = oscillator_rig("acceleration", "base_acceleration")
    friction = CoulombFriction(Place(), friction_force=0.01, slip_velocity=1e-2, against="ground")
    total = 3.0 * s**2 + (0.7 + 1.0) * s + 1200.0
    assert frf(linear_of(rig, friction), frequency, ["mass"])[0] == pytest.approx((0.7 * s + 1200.0) / total, rel=1e-6)


def test_the_static_limit_of_the_receptance_is_the_deflection_curve():
    """Plain truncation to these modes would be 1e-3 off; the residual shapes make it exact."""
    rig, a = beam_rig(), 1.2
    found = frf(linear_of(rig, band=50.0), np.array([1e-4]), names(rig))[:, 0].real
    near, far = np.minimum(PLACES, a), np.maximum(PLACES, a)
    assert found == pytest.approx(near**2 * (3 * far - near) / (6 * EI), rel=1e-8)


def test_reciprocity():
    """Where force and sensor change places the FRF stays, a closed sleeve included."""
    frequency = np.linspace(1.0, 300.0, 50)
    linear = linear_of(beam_rig(sleeves=(sleeve(),), damping=(1.2, 6e-6)))
    there, back = frf(linear, frequency, ["x1.2"], 0.7), frf(linear, frequency, ["x0.7"], 1.2)
    assert there == pytest.approx(back, rel=1e-9)


def test_a_closed_sleeve_stiffens_and_an_open_one_does_not_act():
    open_rig, closed_rig, bare = beam_rig(sleeves=(sleeve(clearance=1.0),)), beam_rig(sleeves=(sleeve(),)), beam_rig()
    freqs = [natural_modes(linear_of(rig), rig.sensors, 100.0).natural_freqs[0] for rig in (bare, open_rig, closed_rig)]
    assert freqs[1] == pytest.approx(freqs[0], rel=1e-6)
    assert freqs[2] > 2.0 * freqs[0]
    assert [t.stiffness for t in linear_of(open_rig).tangents] == [0.0]


def test_a_very_stiff_sleeve_at_the_tip_is_a_pin():
    """Clamped-pinned: beta L = 3.9266, 7.0686 (Blevins); a sleeve without gap and weight is a spring both ways."""
    rig = beam_rig(sleeves=(sleeve(LENGTH, 0.0, 1e9, 0.0),), gravity=0.0)
    modes = natural_modes(linear_of(rig), rig.sensors, 400.0)
    expected = (np.array([3.92660231, 7.06858275]) / LENGTH) ** 2 * np.sqrt(EI / LINE_MASS) / (2 * np.pi)
    assert modes.natural_freqs[:2] == pytest.approx(expected, rel=1e-3)


def test_the_tangent_of_a_bilateral_sleeve_is_its_spring_and_dashpot():
    tangent = linear_of(beam_rig(sleeves=(sleeve(clearance=0.0),), gravity=0.0)).tangents[0]
    assert (tangent.stiffness, tangent.damping) == pytest.approx((1e5, 80.0), rel=1e-6)


def test_hysteresis_is_a_spring_before_it_slips():
    rig = oscillator_rig("displacement")
    tangent = linear_of(rig, BoucWen(Place(), 2.0, 1e-3, 1.0)).tangents[0]
    assert tangent.stiffness == pytest.approx(2000.0, rel=1e-6)
    assert tangent.damping == 0.0


def test_a_film_at_rest_has_the_damping_of_its_place_in_the_gap():
    rig = beam_rig(sleeves=(sleeve(clearance=4e-4),), gravity=0.0)
    tangent = linear_of(rig, SqueezeFilm(Place(sleeve="sleeve", position=1.0), damping=18.5)).tangents[0]
    assert tangent.damping == pytest.approx(18.5, rel=1e-6)


def test_gains_of_the_measurement_chain_are_in_the_frf():
    rig, frequency = beam_rig(), np.array([5.0, 50.0])
    true = frf(linear_of(rig), frequency, names(rig))
    effects = SensorGain(Place(sensor="x0.7"), gain=-1.0), ForceGain(Place(), gain=2.0)
    read = frf(linear_of(rig, *effects), frequency, names(rig))
    assert read == pytest.approx(true * np.array([0.5, -0.5, 0.5, 0.5])[:, None], rel=1e-9)


def test_small_motion_in_time_has_the_same_frf():
    """A closed sleeve, a film and damping under a multisine too weak to open the contact; period three is steady."""
    rig = beam_rig(sleeves=(sleeve(),), damping=(20.0, 6e-5), quantity="acceleration")
    film = SqueezeFilm(Place(sleeve="sleeve", position=1.0), damping=5.0)
    fs, n = 1024.0, 1024
    lines, rng = np.arange(5, 300), np.random.default_rng(0)
    spectrum = np.zeros(n // 2 + 1, complex)
    spectrum[lines] = np.exp(2j * np.pi * rng.random(len(lines)))
    excitation = np.tile(np.fft.irfft(spectrum, n) * 1e-2, 3)
    plant = build_plant(rig, [film])
    record = Record("multisine", fs, excitation, tuple(names(rig)), np.zeros((4, 3 * n)))
    steady = simulate(plant, record).channels[:, -n:]
    found = np.fft.rfft(steady)[:, lines] / np.fft.rfft(excitation[-n:])[lines]
    expected = frf(linearised(build_modal(plant, 0.43 * fs)), lines * fs / n, names(rig))
    # The stepper's own error at 8192 steps/s is 0.1 to 0.3 % of the response.
    assert np.linalg.norm(found - expected) < 0.01 * np.linalg.norm(expected)


def test_a_rig_without_excitation_is_told():
    rig = beam_rig().model_copy(update={"excitation": None})
    with pytest.raises(InputError, match=r"a rig without excitation; an FRF needs .*; add \[excitation\]"):
        frf(linear_of(rig), np.array([1.0]), names(rig))


def test_many_lines_are_solved_in_parts_and_agree_with_few():
    rig = beam_rig(damping=(1.2, 6e-6))
    linear, frequency = linear_of(rig), np.linspace(1.0, 300.0, 2500)
    whole = frf(linear, frequency, names(rig))
    assert whole[:, ::250] == pytest.approx(frf(linear, frequency[::250], names(rig)), rel=1e-12)


def test_a_roving_hammer_moves_the_force():
    rig = beam_rig(position=0.7)
    plant = build_plant(rig)
    moved = replace(plant, excitation=plant.excitation.model_copy(update={"position": 1.2}))
    frequency = np.array([5.0, 20.0])
    there = frf(linearised(build_modal(moved, 400.0)), frequency, names(rig))
    assert frf(linear_of(rig), frequency, names(rig), 1.2) == pytest.approx(there, rel=1e-3)
