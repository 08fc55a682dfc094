"""Nonlinear FRFs: the linear limit, Duffing's closed form, folds, and the same motion as stepping in time."""

import numpy as np
import pytest
from balance_scenes import CUBIC, DAMPING, MASS, OSCILLATOR, STIFFNESS, names, sleeved

from models.effects import Place
from models.effects.cubic_stiffness import CubicStiffness
from models.errors import DivergenceError, InputError
from models.harmonic_balance import frf, from_both_ends, nonlinear_frf
from models.linear import frf as linear_frf
from models.linear import linearised
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
    expected = linear_frf(linearised(build_modal(plant, 400.0)), curve.freqs, names(rig)) * 1e-7
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


def off_when_stepped(plant, amplitude, curve, point):
    """How far first harmonics are off the curve's after four seconds begun on it, of their largest values."""
    freq, sensors = curve.freqs[point], [sensor.name for sensor in plant.sensors]
    time = np.arange(round(6.0 * FS)) / FS
    wave = amplitude * np.cos(2 * np.pi * freq * time)
    record = Record("sine", FS, wave, tuple(sensors), np.zeros((len(sensors), len(wave))))
    stepped = simulate(plant, record, Settings(steps_per_sample=12), curve.states()[point])
    late = (time > 4.0) & (time < 5.5)  # a recorder knows nothing beyond its ends
    turns = [np.cos, np.sin]
    basis = [turn(2 * np.pi * freq * k * time[late]) for k in range(1, 25) for turn in turns]
    fitted, *_ = np.linalg.lstsq(np.column_stack([np.ones(late.sum()), *basis]), stepped.channels[:, late].T)
    read = curve.read(sensors)[:, :, 1]
    return (np.abs(fitted[1] - 1j * fitted[2] - read[point]) / np.abs(read).max(axis=0)).max()


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
    assert len(calm) > 12
    for point in calm[:: max(1, len(calm) // 12)]:
        assert off_when_stepped(plant, amplitude, curve, point) < 2e-3


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
    """From 15 Hz down the beam is quiet until it strikes; from 6 Hz up it strikes all along, as stepping does."""
    plant = build_plant(sleeved())
    up, down = from_both_ends(plant, 1.5, (6.0, 15.0), 400.0)
    assert up.ended == ""
    assert "folds back" in down.ended
    assert down.freqs.min() < 12.0
    assert down.freqs[0] == pytest.approx(15.0)
    quiet, struck = (np.abs(curve.motion[end]).sum(axis=1) * 2.0 for curve, end in ((down, 0), (up, -1)))
    assert (quiet < [2e-4, 3e-4]).all()
    assert (struck > [2e-4, 3e-4]).any()
    calm = np.flatnonzero(up.is_stable & (up.freqs > 14.4) & (up.freqs < 14.9))
    assert calm.size
    assert off_when_stepped(plant, 1.5, up, calm[0]) < 5e-3


@pytest.mark.parametrize("amplitude", [1.348, 1.5, 1.8, 2.007])
def test_a_curve_that_passes_itself_closely_is_followed_on(amplitude):
    """One in five ran back from where a wall is just touched, on this machine or on that."""
    curve = nonlinear_frf(build_plant(sleeved()), amplitude, (6.0, 15.0), 400.0)
    assert curve.ended == ""
    assert curve.freqs[-1] > 15.0


def test_one_curve_is_enough_where_both_ends_lead_to_it():
    (curve,) = from_both_ends(build_plant(sleeved()), 0.05, (6.0, 16.0), 400.0)
    assert curve.ended == ""


@pytest.mark.parametrize("quantity", ["force", "base_acceleration"])
def test_no_motion_between_two_folds_is_called_stable(quantity):
    """On the way back exactly one multiplier lies beyond +1, also where a sleeve is hardly touched."""
    amplitude = 1.5 if quantity == "force" else 1.0
    curve = nonlinear_frf(build_plant(sleeved(excitation=quantity)), amplitude, (6.0, 16.0), 440.0, accuracy=1e-4)
    back = np.diff(curve.freqs) < 0.0
    inside = np.flatnonzero(back[1:] & back[:-1]) + 1
    far = inside[np.abs(curve.freqs[inside] - curve.freqs[inside - 1]) > 1e-3]
    assert len(far) > 10
    assert {curve.losses[point] for point in far} == {"fold"}


def test_a_curve_stands_where_the_upper_end_cannot_be_reached_from_rest(monkeypatch):
    told, begun = [], frf._begun

    def only_from_below(*args, downwards, **others):
        if downwards:
            raise DivergenceError("no way up")
        return begun(*args, downwards=downwards, **others)

    monkeypatch.setattr(frf, "_begun", only_from_below)
    (curve,) = from_both_ends(build_plant(sleeved()), 0.05, (6.0, 16.0), 400.0, told.append)
    assert curve.ended == ""
    assert "no way up" in told[0]


def test_a_linear_rig_is_sent_to_its_linear_frf():
    with pytest.raises(InputError, match="no law and no contact") as error:
        nonlinear_frf(build_plant(OSCILLATOR), 1.0, (5.0, 15.0), 100.0)
    assert "linear FRF" in error.value.mend
    assert "testbed frf" in error.value.mend


def test_a_curve_that_cannot_begin_says_where():
    with pytest.raises(DivergenceError, match="where the curve is to begin"):
        nonlinear_frf(build_plant(OSCILLATOR, [CubicStiffness(Place(), 1e30)]), 1e3, (9.9, 14.0), 100.0)
