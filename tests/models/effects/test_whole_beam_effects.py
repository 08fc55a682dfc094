"""Axial load, damage, cracks, absorbers, drag and drift against closed forms, limits and invariants."""

from dataclasses import replace
from math import pi, sqrt

import numpy as np
import pytest
from effect_scenes import BEAM, OSCILLATOR, scene_at

from models.effects import Place
from models.effects.absorber import MOST_STEPS, Absorber
from models.effects.axial_load import AxialLoad
from models.effects.breathing_crack import BreathingCrack
from models.effects.clamp_compliance import ClampCompliance
from models.effects.local_damage import LocalDamage
from models.effects.point_damping import PointDamping
from models.effects.quadratic_drag import QuadraticDrag
from models.effects.stiffness_drift import StiffnessDrift
from models.effects.structural_damping import StructuralDamping
from models.effects.youngs_modulus import YoungsModulus
from models.errors import NoRestError
from models.fine import FineSettings, fine_response
from models.linear import linearised, natural_modes
from models.modal import build_modal
from models.plant import build_plant
from models.record import Record
from models.rig import Rig
from models.simulate import Settings, simulate
from models.structure import Structure

BARE = Rig(**{**dict(BEAM), "sleeves": ()})
WEIGHTLESS = BARE.model_copy(update={"structure": BARE.structure.model_copy(update={"gravity": 0.0})})
LIFTED = BARE.model_copy(update={"structure": BARE.structure.model_copy(update={"gravity": -9.81})})
STRUCTURE = Structure.of(BEAM.structure)
EI, LENGTH, LINE_MASS = STRUCTURE.bending_stiffness, STRUCTURE.length, STRUCTURE.line_mass
BUCKLING = EI * (0.5 * pi / LENGTH) ** 2
FS = 2048.0
MANY_MODES = Settings(n_modes=24)


def model(*effects, rig=BARE, n_modes=None):
    return build_modal(build_plant(rig, extra=effects), band=400.0, n_modes=n_modes)


def freqs(*effects, rig=BARE, n_modes=24):
    return natural_modes(linearised(model(*effects, rig=rig, n_modes=n_modes)), (), 700.0).natural_freqs


def pushed(rig, effects, force, settings=MANY_MODES):
    """(2, N) channels of the modal model under a force, from rest."""
    record = Record("test", FS, force, ("tip", "mid"), np.zeros((2, len(force))))
    return simulate(build_plant(rig, extra=effects), record, settings).channels


def burst(n=1024, seed=4):
    """(n,) noise that starts and ends at nothing."""
    wave = np.convolve(np.random.default_rng(seed).standard_normal(n + 15), np.ones(16) / 16.0, "valid")
    return wave * np.sin(np.pi * np.arange(n) / n) ** 2


def test_compression_softens_until_the_beam_buckles():
    """Euler's load of the cantilever: nothing is left of the first mode's stiffness."""
    near, nearer = (model(AxialLoad(Place(), force=-share * BUCKLING)).omega[0] for share in (0.998, 0.999))
    assert (nearer / near) ** 2 == pytest.approx(0.5, rel=3e-3)  # the mode's shape still changes
    with pytest.raises(NoRestError, match="axial_load"):
        model(AxialLoad(Place(), force=-1.001 * BUCKLING))


def test_tension_stiffens_by_the_work_of_the_load_on_the_slopes():
    """Rayleigh's quotient to first order: N int phi'^2 dx over the modal mass, from an independent quadrature."""
    plain, load = model(n_modes=16), 1e-4 * BUCKLING
    x = np.linspace(0.0, LENGTH, 4001)
    slopes = np.array([plain.rows(float(place), 1)[:4] for place in x])
    work = load * np.trapezoid(slopes**2, x, axis=0)
    grown = model(AxialLoad(Place(), force=load), n_modes=16).omega[:4] ** 2 - plain.omega[:4] ** 2
    np.testing.assert_allclose(grown, work, rtol=1e-4)


@pytest.mark.parametrize("place", [0.2, 0.75])
def test_a_damaged_beam_sags_by_the_kink_that_its_weight_makes(place):
    loss, width = 0.6, 0.06
    soft = loss * width / ((1.0 - loss) * EI)
    weight = LINE_MASS * STRUCTURE.gravity
    sound = weight * LENGTH**4 / (8.0 * EI)
    kink = soft * weight * (LENGTH - place) ** 2 / 2.0
    tip = model(LocalDamage(Place(position=place), loss=loss)).rest_deflection(np.array([LENGTH]))[0]
    assert tip == pytest.approx(-sound - kink * (LENGTH - place), rel=1e-9)


def test_no_loss_is_no_damage():
    assert build_plant(BEAM, extra=(LocalDamage(Place(position=0.5), loss=0.0),)).structure == STRUCTURE


@pytest.mark.parametrize("place", [0.2, 0.75])
def test_a_crack_that_the_weight_holds_open_is_a_damage(place):
    """The mean curvature is what tells open from closed, so small motion about it is linear."""
    at, loss = Place(position=place), 0.6
    expected = freqs(LocalDamage(at, loss=loss), rig=LIFTED)[:4]
    np.testing.assert_allclose(
        freqs(BreathingCrack(at, loss=loss), rig=LIFTED)[:4], expected, rtol=5e-5
    )  # modes left out
    np.testing.assert_allclose(freqs(BreathingCrack(at, loss=loss), rig=BARE)[:4], freqs(rig=BARE)[:4], rtol=1e-9)
    tip = [
        model(kind(at, loss=loss), rig=LIFTED, n_modes=60).rest_deflection(np.array([LENGTH]))[0]
        for kind in (BreathingCrack, LocalDamage)
    ]
    assert tip[0] == pytest.approx(tip[1], rel=1e-3)  # of a kink in smooth shapes


def test_a_crack_shows_at_every_level_alike():
    """Its law knows no scale: twice the force is twice the motion, though nothing about it is linear."""
    crack, force = (BreathingCrack(Place(position=0.3), loss=0.6),), burst()
    once, twice, down = (pushed(WEIGHTLESS, crack, factor * force) for factor in (1.0, 2.0, -1.0))
    np.testing.assert_allclose(twice, 2.0 * once, atol=1e-4 * np.abs(once).max())  # the steps' error
    assert np.linalg.norm(once + down) > 0.02 * np.linalg.norm(once)


def test_a_crack_moves_alike_in_modes_and_in_finite_elements():
    crack, force = (BreathingCrack(Place(position=0.3), loss=0.5),), burst()
    fine = fine_response(build_plant(WEIGHTLESS, extra=crack), force, FS, FineSettings(n_elements=60))
    apart = np.linalg.norm(pushed(WEIGHTLESS, crack, force) - fine) / np.linalg.norm(fine)
    assert apart < 0.005  # a kink in 24 smooth shapes
    assert np.linalg.norm(pushed(WEIGHTLESS, (), force) - fine) / np.linalg.norm(fine) > 0.05


def test_an_absorber_splits_a_resonance_as_two_masses_on_two_springs():
    mass, stiffness = OSCILLATOR.structure.mass, OSCILLATOR.structure.stiffness
    hung, tuned = 0.1 * mass, sqrt(stiffness / mass)
    expected = np.sqrt(np.linalg.eigvals([[1.1 * stiffness / mass, -0.1 * stiffness / mass], [-(tuned**2), tuned**2]]))
    effect = Absorber(Place(), mass=hung, frequency=tuned / (2 * pi), damping_ratio=0.0)
    np.testing.assert_allclose(model(effect, rig=OSCILLATOR).omega, np.sort(expected), rtol=1e-12)


@pytest.mark.parametrize("rigid", [(), (0.0,), (1e-6, 2e-6), (0.15,)], ids=["held", "free", "numbers", "softly hung"])
def test_absorbers_are_tried_in_half_octaves_of_the_modes_of_vibration(rigid):
    tried = [a.frequency for a in Absorber.trials(scene_at(Place(position=1.2), natural_freqs=(*rigid, 7.0, 44.0)))]
    assert tried[0] == pytest.approx(3.5)
    assert {7.0, 44.0} <= set(np.round(tried, 9))
    assert np.all(np.diff(np.log2(tried)) <= 0.5 + 1e-9)
    assert np.all(np.diff(tried) > 0.0)


def test_no_gap_between_modes_takes_more_than_a_handful_of_absorbers():
    cantilever = (9.25, 58.0, 162.0, 318.0, 525.0, 785.0)
    tried = [a.frequency for a in Absorber.trials(scene_at(Place(position=1.2), natural_freqs=cantilever))]
    assert tried[0] == pytest.approx(0.5 * cantilever[0])
    assert len(tried) < 20
    on_springs = [a.frequency for a in Absorber.trials(scene_at(Place(position=1.2), natural_freqs=(5.0, 900.0)))]
    assert len(on_springs) == 2 + MOST_STEPS + 1


def test_a_stiff_absorber_is_a_mass_and_a_weightless_one_is_none():
    tip = Place(position=LENGTH)
    stiff = Absorber(tip, mass=0.3, frequency=1e5, damping_ratio=0.0)
    sag = model(stiff).rest_deflection(np.array([LENGTH]))[0]
    weight = LINE_MASS * STRUCTURE.gravity * LENGTH**4 / (8.0 * EI) + 0.3 * STRUCTURE.gravity * LENGTH**3 / (3.0 * EI)
    assert sag == pytest.approx(-weight, rel=1e-6)
    assert build_plant(BARE, extra=(replace(stiff, mass=0.0),)).structure == STRUCTURE


def test_all_modes_have_half_the_loss_factor_as_their_damping_ratio():
    damped = model(StructuralDamping(Place(), loss_factor=0.03), rig=BARE)
    np.testing.assert_allclose(np.diag(damped.damping)[:-1], 0.03 * damped.omega[:-1], rtol=1e-9)  # the last is no mode


def test_drag_takes_what_the_integral_along_the_beam_says():
    """Power lost by each of the first modes, int c |v|^3 dx, against a fine quadrature."""
    drag = QuadraticDrag(Place(), coefficient=50.0)
    plain, x = model(n_modes=16), np.linspace(0.0, LENGTH, 4001)
    laws = drag.point_laws(None, STRUCTURE)
    for mode in range(4):
        v = np.array([plain.rows(law.port.position)[mode] for law in laws])
        found = sum(speed * law.force(0.0, 0.0, speed, 0.0, law.parameters) for speed, law in zip(v, laws, strict=True))
        fine = np.array([plain.rows(float(place))[mode] for place in x])
        # |v|^3 has kinks in its third derivative where the mode has nodes.
        assert found == pytest.approx(-50.0 * np.trapezoid(np.abs(fine) ** 3, x), rel=0.01)


def test_drag_is_nothing_beside_a_small_motion_and_damps_a_large_one():
    drag, force = (QuadraticDrag(Place(), coefficient=100.0),), burst()
    for level, low, high in ((1e-4, 0.0, 1e-4), (100.0, 0.02, 1.0)):
        plain, dragged = pushed(WEIGHTLESS, (), level * force), pushed(WEIGHTLESS, drag, level * force)
        assert low <= np.linalg.norm(dragged - plain) / np.linalg.norm(plain) < high


def test_rates_of_drift_add_up_and_no_law_stands_for_them():
    plant = build_plant(BEAM, extra=(StiffnessDrift(Place(), rate=0.02), StiffnessDrift(Place(), rate=-0.005)))
    assert plant.structure == replace(STRUCTURE, stiffness_rate=0.015)
    assert plant.laws == ()
    assert build_plant(BEAM, extra=(StiffnessDrift(Place(), rate=0.0),)).structure == STRUCTURE


@pytest.mark.parametrize(
    "beside",
    [
        (),
        (ClampCompliance(Place(), rotational_stiffness=4e4),),
        (AxialLoad(Place(), force=0.3 * BUCKLING), LocalDamage(Place(position=0.4), loss=0.3)),
        (Absorber(Place(position=1.2), mass=0.3, frequency=25.0, damping_ratio=0.05),),
    ],
)
def test_at_any_time_a_drifting_beam_is_a_beam_of_the_stiffness_it_then_has(beside):
    """In the modes of the start: clamp, axial load, hinge and absorber stay, what bends grows."""
    growth, drifting = 0.03, model(StiffnessDrift(Place(), rate=0.02), *beside, n_modes=24)
    later = build_plant(BARE, extra=(StiffnessDrift(Place(), rate=0.02), *beside)).structure.at(growth / 0.02)
    assert (later.stiffness_rate, later.bending_stiffness) == (0.0, pytest.approx(1.03 * EI))
    stiffness = np.diag(drifting.omega**2) + growth * drifting.bending
    expected = build_modal(replace(build_plant(BARE), structure=later), band=400.0, n_modes=24)
    # What the modes of the start lack beside a clamp that turns goes with the square of the 3 %.
    np.testing.assert_allclose(np.linalg.eigvalsh(stiffness)[:8], expected.omega[:8] ** 2, rtol=5e-5)


def test_a_drift_bends_more_what_the_weight_has_bent():
    """Moved as slowly as the sag is deep, the tip follows the static deflection of the softer beam."""
    rate, n = -0.05, 4096
    plant = build_plant(BARE, extra=(StiffnessDrift(Place(), rate=rate),))
    plant = replace(
        plant, sensors=tuple(sensor.model_copy(update={"quantity": "displacement"}) for sensor in plant.sensors)
    )
    tip = simulate(plant, Record("test", FS, np.zeros(n), ("tip",), np.zeros((1, n)))).channels[0]
    t = np.arange(n) / FS
    sag = -LINE_MASS * STRUCTURE.gravity * LENGTH**4 / (8.0 * EI)
    # What rings is the kink of the load's course at the start, rate / omega of the sag.
    np.testing.assert_allclose(tip, sag * (1.0 / (1.0 + rate * t) - 1.0), atol=2.0 * 0.05 / model().omega[0] * abs(sag))


@pytest.mark.parametrize("rate", [-0.02, 0.02])
def test_late_in_a_record_a_drifting_beam_rings_as_one_of_that_stiffness(rate):
    """Free decay of the first mode after a slow push: its mean frequency between zero crossings about 3 s."""
    n, hit = 8192, np.zeros(8192)
    hit[:256] = np.sin(np.pi * np.arange(256) / 256) ** 2
    tip = pushed(WEIGHTLESS, (StiffnessDrift(Place(), rate=rate),), hit)[0]
    t, late = np.arange(n) / FS, np.flatnonzero((tip[:-1] < 0.0) & (tip[1:] >= 0.0))
    crossings = np.array([t[i] - tip[i] / (tip[i + 1] - tip[i]) / FS for i in late])
    crossings = crossings[(crossings > 2.5) & (crossings < 3.5)]
    found = (len(crossings) - 1) / (crossings[-1] - crossings[0])
    middle = 0.5 * (crossings[0] + crossings[-1])
    expected = freqs(YoungsModulus(Place(), ratio=1.0 + rate * middle), rig=WEIGHTLESS)[0]
    assert found == pytest.approx(expected, rel=1e-3)  # the second mode shifts the crossings a little
    assert abs(found / freqs(rig=WEIGHTLESS)[0] - 1.0) > 0.02


BESIDE_A_DRIFT = {
    "a clamp that turns": (ClampCompliance(Place(), rotational_stiffness=4e4),),
    "a dashpot under tension": (PointDamping(Place(position=0.7), 15.0), AxialLoad(Place(), force=500.0)),
    "an absorber and one loss factor": (
        Absorber(Place(position=1.2), mass=0.3, frequency=25.0, damping_ratio=0.05),
        StructuralDamping(Place(), loss_factor=0.02),
    ),
}


@pytest.mark.parametrize("beside", BESIDE_A_DRIFT.values(), ids=BESIDE_A_DRIFT)
def test_a_drift_moves_alike_in_modes_and_in_finite_elements(beside):
    """With gravity and a sleeve; the finite elements find the modes of every segment anew."""
    drift, force = (StiffnessDrift(Place(), rate=-0.02), *beside), 20.0 * burst(4096)
    fine = fine_response(build_plant(BEAM, extra=drift), force, FS)
    modal = [pushed(BEAM, drift, force, Settings(n_modes=n, steps_per_sample=32)) for n in (6, 8, 10)]
    apart = [np.linalg.norm(channels - fine) / np.linalg.norm(fine) for channels in modal]
    assert apart[0] > 10.0 * apart[1] > 10.0 * apart[2]
    assert apart[2] < 1.2e-3  # 40 elements; with 80 and half the steps a fifth of it is left
    assert np.linalg.norm(pushed(BEAM, beside, force) - fine) / np.linalg.norm(fine) > 0.1


def test_a_drift_begins_with_the_record_and_slides_the_frequency():
    """The phase of a free oscillation runs ahead by the integral of half the growth of the stiffness."""
    rate, n = 0.01, 8192
    force = np.zeros(n)
    force[:64] = np.sin(np.pi * np.arange(64) / 64) ** 2
    plain, drifting = (pushed(WEIGHTLESS, effects, force)[0] for effects in ((), (StiffnessDrift(Place(), rate=rate),)))
    omega, t = model(rig=WEIGHTLESS).omega[0], n / FS
    turned = [np.angle(np.sum(x[-2048:] * np.exp(-1j * omega * np.arange(n)[-2048:] / FS))) for x in (plain, drifting)]
    middle = t - 1024 / FS
    assert (turned[1] - turned[0]) % (2 * pi) == pytest.approx(0.25 * omega * rate * middle**2, rel=0.03)  # other modes
    np.testing.assert_allclose(drifting[:200], plain[:200], atol=3e-3 * np.abs(plain[:200]).max())
