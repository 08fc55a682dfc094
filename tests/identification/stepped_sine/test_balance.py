"""The steady state under a sine: exact where linear, the backbone of Duffing, and a simulation in time."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from identification.hypothesis import Hypothesis
from identification.stepped_sine.balance import Balance
from identification.stepped_sine.record import SteppedSine
from models.effects.bouc_wen import BoucWen
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.protocol import Place
from models.errors import InputError
from models.record import Record
from models.rig import Beam, Excitation, Oscillator, Rig, Sensor
from models.simulate import Settings

M, K, C = 2.0, 5e5, 3.0
RIG = Rig(
    structure=Oscillator(kind="oscillator", mass=M, stiffness=K, damping=C),
    tolerances={"stiffness": 0.1},
    excitation=Excitation(name="force", quantity="force"),
    sensors=(Sensor(name="a", quantity="acceleration"),),
)
FREQUENCY = np.linspace(78.0, 82.0, 41)


def record_of(force=0.5, frequency=FREQUENCY, size=None):
    """A record whose responses only say in what range to look."""
    values = -((2.0 * pi * frequency) ** 2) * (1e-4 if size is None else size / force)
    return SteppedSine("made up", frequency, ("a",), values[None].astype(complex), force=np.full(len(frequency), force))


def test_a_linear_oscillator_is_exact():
    record, omega = record_of(), 2.0 * pi * FREQUENCY
    expected = -(omega**2) * record.force / (K - M * omega**2 + 1j * omega * C)
    found = Balance.of(Hypothesis(RIG), record).steady_state()[0]
    np.testing.assert_allclose(found, expected, rtol=1e-9)  # through the modal model and back


def test_duffings_backbone_to_the_first_harmonic():
    k3, a = 2e10, 1.5e-4  # below the fold, so that the line at the peak has one amplitude
    at_peak = np.sqrt((K + 0.75 * k3 * a**2) / M)
    record = record_of(force=C * at_peak * a, frequency=np.array([at_peak, 1.001 * at_peak]) / (2.0 * pi), size=a)
    found = Balance.of(Hypothesis(RIG).with_effects(CubicStiffness(Place(), k3)), record).steady_state()[0]
    assert found[0] == pytest.approx(-(at_peak**2) * a / 1j, rel=1e-4)  # the spline between 16 amplitudes a decade


def test_hysteresis_agrees_with_a_simulation_in_time():
    model = Hypothesis(RIG).with_effects(BoucWen(Place(), 8.0, 3e-4, 1.0))
    frequency, fs, n = 80.5, 40 * 80.5, 12000
    record = record_of(force=1.0, frequency=np.array([frequency, 80.6]), size=2e-4)
    time = np.arange(n) / fs
    moving = Record("sine", fs, np.cos(2.0 * pi * frequency * time), ("a",), np.zeros((1, n)))
    tail = model.simulated(moving, Settings()).channels[0, -2000:]
    first = 2.0 * np.mean(tail * np.exp(-2j * pi * frequency * time[-2000:]))
    # Harmonics beyond the first, which the balance leaves out, move it by less than 1 %.
    assert Balance.of(model, record).steady_state()[0][0] == pytest.approx(first, rel=1e-2)


def test_the_imbalance_vanishes_on_the_models_own_motion_and_tells_the_error_near_it():
    model = Hypothesis(RIG).with_effects(CubicStiffness(Place(), 1e11))
    record = record_of()
    own = replace(record, values=Balance.of(model, record).steady_state() / record.force)
    assert np.abs(Balance.of(model, own).imbalance()).max() < 1e-3 * np.abs(own.responses).max()
    near = model.rig.with_values({"stiffness": K * 1.00002})
    error = Balance.of(replace(model, rig=near), own).steady_state() - own.responses
    told = Balance.of(
        Hypothesis(near), replace(own, values=Balance.of(Hypothesis(RIG), own).steady_state() / own.force)
    )
    linear = told.steady_state() - told.record.responses
    np.testing.assert_allclose(told.imbalance(), linear, atol=0.05 * np.abs(linear).max())
    assert np.abs(error).max() > 0.0


def test_at_a_fold_the_branch_of_the_line_before_is_kept():
    """A softening joint under a strong force has two stable amplitudes; a sweep up stays on the low one, then jumps."""
    model = Hypothesis(RIG.with_values({"damping": 1.0})).with_effects(CubicStiffness(Place(), 1e12))
    lines = np.linspace(79.0, 84.0, 101)
    up = Balance.of(model, record_of(force=0.5, frequency=lines)).steady_state()[0]
    down = Balance.of(model, record_of(force=0.5, frequency=lines[::-1].copy())).steady_state()[0][::-1]
    apart = np.abs(up) > 1.5 * np.abs(down)
    assert 5 < apart.sum() < 80  # a hardening spring: high on the way up, low on the way down
    np.testing.assert_allclose(up[0], down[0], rtol=1e-6)


def test_a_beam_is_refused():
    beam = Rig(
        structure=Beam(
            kind="beam", length=1.0, diameter=0.01, youngs_modulus=2e11, density=7800.0, rayleigh_damping=(0.1, 1e-5)
        ),
        excitation=Excitation(name="force", quantity="force", position=0.5),
        sensors=(Sensor(name="a", quantity="acceleration", position=1.0),),
    )
    with pytest.raises(InputError, match="one degree of freedom"):
        Balance.of(Hypothesis(beam), record_of())
