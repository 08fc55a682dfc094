"""The balance of harmonics: its slopes, and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest
from balance_scenes import LENGTH, REFERENCE, sleeved

from models.effects import Place
from models.effects.base_motion import BaseMotion
from models.effects.bouc_wen import BoucWen
from models.effects.coulomb_friction import CoulombFriction
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.stiffness_drift import StiffnessDrift
from models.effects.time_varying_damping import TimeVaryingDamping
from models.effects.wear import Wear
from models.errors import InputError
from models.harmonic_balance import nonlinear_frf
from models.harmonic_balance.equations import Equations
from models.modal import build_modal
from models.plant import build_plant
from models.rig import Excitation, Oscillator, Rig, Sensor

SLEEVED = sleeved(gravity=9.81)
FRICTION = CoulombFriction(Place(position=0.6 * LENGTH), 2.0, 0.02, "ground")


def equations_of(rig, *effects, harmonics=5):
    return Equations.of(build_modal(build_plant(rig, effects), 400.0), harmonics)


def some_motion(equations, size=2e-4):
    rng = np.random.default_rng(3)
    real, imaginary = rng.normal(size=(2, len(equations.model.ports), equations.n_harmonics + 1))
    x = size * (real + 1j * imaginary)
    x[:, 0] = x[:, 0].real
    return x


@pytest.mark.parametrize("quantity", ["force", "base_acceleration", "base_velocity", "base_displacement"])
def test_slopes_are_those_of_the_residual(quantity):
    equations = equations_of(sleeved(9.81, quantity), FRICTION)
    y, omega, amplitude = equations.packed(some_motion(equations)), 61.0, {"base_displacement": 1e-3}.get(quantity, 2.0)
    slopes = equations.slopes(y, omega, amplitude)

    def residual(y, omega=omega, amplitude=amplitude):
        return equations.residual(y, omega, amplitude)

    nudge = 1e-8
    found = np.column_stack([(residual(y + d) - residual(y - d)) / (2 * nudge) for d in nudge * np.eye(len(y))])
    assert slopes[:, :-2] == pytest.approx(found, abs=1e-3 * np.abs(found).max())  # a kink may lie within the nudge
    turned = (residual(y, omega=omega + 1e-4) - residual(y, omega=omega - 1e-4)) / 2e-4
    assert slopes[:, -2] == pytest.approx(turned, abs=3e-3 * np.abs(turned).max())  # of a sample's own length
    nudge = 1e-5 * amplitude
    louder = (residual(y, amplitude=amplitude + nudge) - residual(y, amplitude=amplitude - nudge)) / (2 * nudge)
    assert slopes[:, -1] == pytest.approx(louder, abs=1e-3 * np.abs(louder).max())


@pytest.mark.parametrize("quantity", ["force", "base_displacement"])
def test_the_residual_is_motion_less_what_its_forces_make_of_it(quantity):
    """Written out with numpy's transform and the receptances as matrices of complex numbers."""
    equations = equations_of(sleeved(9.81, quantity), FRICTION)
    x, omega, amplitude = some_motion(equations), 61.0, {"base_displacement": 1e-3}.get(quantity, 2.0)
    drive, y = equations.drive, equations.packed(x)
    over = equations.over_period(y, omega, amplitude)
    kept = equations.n_harmonics + 1
    load = np.zeros((kept, len(x) + 1), complex)
    load[:, :-1] = np.fft.rfft(over.forces, axis=1, norm="forward").T[:kept]
    load[1, -1] = 0.5 * amplitude * drive.input_at(omega)
    moved = np.einsum("koi,ki->ok", equations.receptance.at(1j * omega * np.arange(kept)), load)
    left = equations.packed(x - moved)
    assert equations.residual(y, omega, amplitude) == pytest.approx(left, abs=1e-12 * np.abs(left).max())


def test_packing_loses_nothing():
    equations = equations_of(SLEEVED)
    x = some_motion(equations)
    assert equations.unpacked(equations.packed(x)) == pytest.approx(x, abs=0.0)


def test_at_rest_nothing_is_left_over():
    equations = equations_of(SLEEVED)
    residual = equations.residual(np.zeros(equations.n_unknowns), 60.0, 0.0)
    assert np.abs(residual).max() < 1e-12  # m; the rest is found to 1e-13


@pytest.mark.parametrize(
    ("effect", "told"),
    [
        (BoucWen(Place(position=LENGTH), 5.0, 2e-4, 1.5), "bouc_wen"),
        (TimeVaryingDamping(Place(sleeve=SLEEVED.sleeves[0].name), (0.0, 5.0), (20.0, 60.0)), "changes with time"),
        (Wear(Place(sleeve=SLEEVED.sleeves[0].name), 1e-6), "changes with time"),
        (StiffnessDrift(Place(), 1e-3), "drifts"),
        (BaseMotion(Place(), 0.5, 7.0), "base_motion"),
    ],
)
def test_what_has_a_memory_or_a_clock_is_refused_by_name(effect, told):
    with pytest.raises(InputError, match=told) as error:
        nonlinear_frf(build_plant(SLEEVED, [effect]), 1.0, (5.0, 15.0), 400.0)
    assert "step the model in time" in error.value.mend


def test_a_rig_without_excitation_is_refused():
    with pytest.raises(InputError, match="without excitation"):
        nonlinear_frf(build_plant(REFERENCE.model_copy(update={"excitation": None})), 1.0, (5.0, 15.0), 400.0)


def test_a_body_that_nothing_holds_is_refused():
    rig = Rig(
        structure=Oscillator(kind="oscillator", mass=1.0, stiffness=1.0, damping=0.1),
        excitation=Excitation(),
        sensors=(Sensor(name="mass"),),
    )
    plant = build_plant(rig, [CubicStiffness(Place(), 1.0)])
    free = replace(plant, structure=replace(plant.structure, bending_stiffness=0.0, rayleigh=(0.0, 0.0)))
    with pytest.raises(InputError, match="without a spring"):
        nonlinear_frf(free, 1.0, (1.0, 2.0), 400.0)
