"""Nonlinear FRFs: the linear limit, Duffing's closed form, folds, and the same motion as stepping in time."""

import numpy as np
import pytest
from balance_scenes import CUBIC, DAMPING, MASS, OSCILLATOR, STIFFNESS, names, sleeved

from models.effects import Place
from models.effects.cubic_stiffness import CubicStiffness
from models.errors import DivergenceError, InputError
from models.harmonic_balance import nonlinear_frf
from models.linear import frf, linearised
from models.modal import build_modal
from models.plant import build_plant
from models.record import Record
from models.simulate import Settings, simulate

FS = 1024.0


@pytest.mark.parametrize("quantity", ["force", "base_acceleration", "base_velocity", "base_displacement"])
def test_small_motion_has_the_linear_frf(quantity):
    rig = sleeved(excitation=quantity)
    plant = build_plant(rig)
    curve = nonlinear_frf(plant, 1e-7, (5.0, 60.0), 400.0)
    expected = frf(linearised(build_modal(plant, 400.0)), curve.freqs, names(rig)) * 1e-7
    assert curve.ended == ""
    found = curve.read(names(rig))[:, :, 1].T
    assert found == pytest.approx(expected, rel=1e-6, abs=1e-9 * np.abs(expected).max())
    assert curve.is_stable.all()


def test_the_multipliers_of_a_linear_structure_are_those_of_its_poles():
    plant = build_plant(OSCILLATOR, [CubicStiffness(Place(), 1e-6 * CUBIC)])
    curve = nonlinear_frf(plant, 1e-3, (5.0, 15.0), 100.0)
    assert curve.largest_multiplier == pytest.approx(np.exp(-0.5 * DAMPING / MASS / curve.freqs), rel=1e-6)


def test_duffing_folds_where_one_harmonic_says():
    """Source: A. H. Nayfeh, D. T. Mook, Nonlinear Oscillations (1979), equation 4.1.18; a force of the first order."""
    plant = build_plant(OSCILLATOR, [CubicStiffness(Place(), CUBIC)])
    amplitude = 0.25
    curve = nonlinear_frf(plant, amplitude, (8.0, 12.0), 500.0)
    a = np.abs(curve.read(["mass"])[:, 0, 1])
    omega = 2 * np.pi * curve.freqs
    own = (STIFFNESS + 0.75 * CUBIC * a**2 - MASS * omega**2) ** 2 + (DAMPING * omega) ** 2
    assert own * a**2 == pytest.approx(amplitude**2, rel=0.02)  # the third harmonic has a hundredth of the motion
    back = np.diff(curve.freqs) < 0.0
    assert back.sum() >= 4
    unstable = ~curve.is_stable
    assert unstable[1:-1].any()
    assert (back[1:] & back[:-1]).sum() <= unstable.sum() <= back.sum() + 2  # between the folds, and only there
    assert {loss for loss in curve.losses if loss} == {"fold"}


@pytest.mark.parametrize("quantity", ["force", "base_acceleration"])
def test_stable_motion_in_the_sleeves_is_where_stepping_stays(quantity):
    """Begun on the curve, the stepped model stays; 1e-4 of the ports' motion was asked, small readings have more."""
    rig = sleeved(excitation=quantity)
    plant = build_plant(rig)
    amplitude = 1.5 if quantity == "force" else 1.0
    curve = nonlinear_frf(plant, amplitude, (6.0, 16.0), 0.43 * FS, accuracy=1e-4)
    moves = curve.peaks(names(rig))[:, 1]
    calm = np.flatnonzero(curve.is_stable & (curve.largest_multiplier < 0.95) & (moves > 0.3 * moves.max()))
    harmonics = curve.motion.shape[2] - 1
    assert harmonics >= 5  # the sleeves are struck
    for point in calm[:: max(1, len(calm) // 3)]:
        freq = curve.freqs[point]
        time = np.arange(round(6.0 * FS)) / FS
        wave = amplitude * np.cos(2 * np.pi * freq * time)
        record = Record("sine", FS, wave, tuple(names(rig)), np.zeros((3, len(wave))))
        stepped = simulate(plant, record, Settings(steps_per_sample=12), curve.states()[point])
        late = (time > 4.0) & (time < 5.5)  # a recorder knows nothing beyond its ends
        turns = [np.cos, np.sin]
        basis = [turn(2 * np.pi * freq * k * time[late]) for k in range(1, 25) for turn in turns]
        fitted, *_ = np.linalg.lstsq(np.column_stack([np.ones(late.sum()), *basis]), stepped.channels[:, late].T)
        first = fitted[1] - 1j * fitted[2]
        read = curve.read(names(rig))[:, :, 1]
        assert (np.abs(first - read[point]) < 5e-3 * np.abs(read).max(axis=0)).all()


def test_harmonics_are_spent_where_they_are_needed():
    rough, fine = (nonlinear_frf(build_plant(sleeved()), 1.5, (8.0, 14.0), 400.0, accuracy=e) for e in (1e-2, 1e-4))
    assert fine.motion.shape[2] > rough.motion.shape[2]
    assert rough.left_out.max() <= 1e-2
    shared = np.interp(rough.freqs[:3], fine.freqs, fine.peaks(["displacement"])[:, 0])
    assert rough.peaks(["displacement"])[:3, 0] == pytest.approx(shared, rel=0.02)  # before any fold


def test_work_done_by_the_shaker_is_what_is_dissipated():
    """Of one period: the sine against the speed of its place, and the laws' forces and the beam's own damping."""
    plant = build_plant(sleeved())
    curve = nonlinear_frf(plant, 1.5, (8.0, 14.0), 400.0, accuracy=1e-4)
    model = curve.model
    moved = curve._moved(np.eye(model.n))
    omega = 2 * np.pi * curve.freqs
    k = np.arange(moved.shape[2])
    speed = 1j * omega[:, None, None] * k * moved
    given = 0.5 * 1.5 * (speed[:, :, 1] @ model.rows(plant.excitation.position)).real
    own = 0.5 * np.einsum("pik,ij,pjk->p", speed.conj(), model.damping, speed).real
    ports = np.einsum("ri,pik->prk", model.port_rows, speed)
    taken = -np.einsum("prk,prk->p", np.conj(curve.forces[:, :, 1:]), ports[:, :, 1:]).real
    assert own + taken == pytest.approx(given, rel=1e-3)
    assert (taken > -1e-9).all()


def test_what_folds_back_is_found_from_both_ends():
    """Free of gravity the beam strikes at 14 Hz or not at all: the striking branch folds back as it came."""
    up, down = (nonlinear_frf(build_plant(sleeved()), 1.5, (6.0, 16.0), 400.0, downwards=way) for way in (False, True))
    assert "folds back" in up.ended
    assert up.freqs.max() < 15.5
    assert down.freqs[0] == pytest.approx(16.0)
    inside = np.abs(down.motion[0]).sum(axis=1) * 2.0
    assert (inside < [2e-4, 3e-4]).all()


def test_a_linear_rig_is_sent_to_its_linear_frf():
    with pytest.raises(InputError, match="no law and no contact") as error:
        nonlinear_frf(build_plant(OSCILLATOR), 1.0, (5.0, 15.0), 100.0)
    assert "linear FRF" in error.value.mend


def test_a_curve_that_cannot_begin_says_where():
    with pytest.raises(DivergenceError, match="where the curve is to begin"):
        nonlinear_frf(build_plant(OSCILLATOR, [CubicStiffness(Place(), 1e30)]), 1e3, (9.9, 14.0), 100.0)
