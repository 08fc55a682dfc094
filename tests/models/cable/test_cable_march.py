import numpy as np
import pytest
from cable_scenes import EI, LENGTH, LINE_MASS, REFERENCE, bare_beam

from models.beam.clamped_free import wave_numbers
from models.cable.accounts import accounted
from models.cable.build import build_cable
from models.cable.course import Course
from models.cable.moving import march, settle
from models.cable.port_law import PortLaw
from models.effects import EFFECTS, build_effect
from models.errors import DivergenceError
from models.plant import build_plant
from models.rig import EffectEntry


def let_go(plant, step, n_steps, force=5.0):
    cable = build_cable(plant, 12, Course(step, np.zeros(n_steps + 1)), held_at=LENGTH)
    rest = settle(cable)
    cable.course.held = force
    settle(cable)
    return cable, march(cable, n_steps, step), rest


def test_order_in_time():
    """Of a beam that a smooth push of a tenth of a second bends: generalised-alpha is of second order."""
    plant, span, ends = build_plant(bare_beam(0.0)), 0.1, []
    for n_steps in (100, 200, 1600):
        push = 5.0 * np.sin(np.pi * np.arange(n_steps + 1) / n_steps) ** 2
        cable = build_cable(plant, 8, Course(span / n_steps, push))
        settle(cable)
        ends.append((march(cable, n_steps, span / n_steps).q @ cable.row(LENGTH))[:: n_steps // 100])
    errors = [np.abs(end - ends[2]).max() for end in ends[:2]]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.2)


def test_the_first_period_is_the_beams():
    """Seen from the tip, which the second mode moves by a hundredth of the first."""
    _, moved, _ = let_go(build_plant(bare_beam(0.0)), 2e-4, 2500)
    period = 2.0 * np.pi / (wave_numbers(1)[0] ** 2 * np.sqrt(EI / (LINE_MASS * LENGTH**4)))
    lines = np.abs(np.fft.rfft(moved.q[:, -3] * np.hanning(2501), 1 << 18))
    assert np.argmax(lines) * 5e3 / (1 << 18) == pytest.approx(1.0 / period, rel=2e-3)


def test_energy_is_accounted_for_where_a_beam_is_let_go_in_its_sleeves():
    cable, moved, rest = let_go(build_plant(REFERENCE), 2.5e-5, 6000, force=20.0)
    steps = accounted(cable, moved, rest, 10)
    assert np.abs(steps.forces).max() > 30.0
    assert steps.energy.stored[0] - steps.energy.stored[-1] > 1e-3
    assert steps.energy.fault < 2e-5


def test_a_clamp_that_turns_is_damped_as_the_balance_says():
    """With a hundred times the reference rig's damping by stiffness; without the clamp's share 6 % are left over."""
    entry = EffectEntry(kind="clamp_compliance", rotational_stiffness=4000.0)
    rig = bare_beam(0.0, rayleigh_damping=(0.0, 6e-4))
    cable, moved, rest = let_go(build_plant(rig, [build_effect(entry, rig, EFFECTS)]), 1e-4, 2000)
    energy = accounted(cable, moved, rest, 1).energy
    left = energy.stored - energy.stored[0] + energy.damped
    assert energy.damped[-1] > 0.1 * energy.stored[0]
    assert np.abs(left).max() < 2e-3 * energy.stored[0]


def test_forces_are_those_that_the_motion_asks_for():
    """As Exudyn felt them in the last iteration, within Newton's tolerance of the motion that it then keeps."""
    cable, moved, _ = let_go(build_plant(REFERENCE), 5e-5, 2000, force=20.0)
    for number, row in enumerate(cable.port_rows):
        law = PortLaw(cable.laws[number].forces, cable.course.step)
        expected = [law(0.0, q, v) for q, v in zip((moved.q @ row).tolist(), (moved.v @ row).tolist(), strict=True)]
        found = moved.forces[:, cable.of_port(number)].sum(axis=1)
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-3 * np.abs(expected).max())


def test_smaller_steps_that_exudyn_takes_are_brought_back_to_the_samples():
    """A film that jumps where nothing smooths it: Newton fails there, Exudyn halves its step, the grid is kept."""
    entry = EffectEntry(kind="coulomb_friction", position=1.2, friction_force=30.0, slip_velocity=1e-7)
    plant = build_plant(REFERENCE, [build_effect(entry, REFERENCE, EFFECTS)])
    _, moved, rest = let_go(plant, 1e-4, 300, force=40.0)
    assert moved.q.shape == (301, len(rest))
    assert np.isfinite(moved.q).all()


def test_a_motion_that_is_lost_is_one_error_that_says_what_to_change():
    plant = build_plant(REFERENCE)
    cable = build_cable(plant, 12, Course(1e-3, np.full(101, 1e9)))
    settle(cable)
    message = (
        r"exudyn: the motion was lost 0\.\d{4} s after the start with steps of 0\.001 s; take more steps per sample"
    )
    with pytest.raises(DivergenceError, match=message):
        march(cable, 100, 1e-3)
