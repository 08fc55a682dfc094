"""Segments of constant stiffness against Airy's functions, and the tables of a segment against the general ones."""

import numpy as np
import pytest
from model_scenes import rig_with
from scipy.special import airy

from models.drift_tables import PHASE_ERROR, segments_of, steps_of_segment
from models.drive import STILL, Drive
from models.effects import EFFECTS, Place
from models.errors import DivergenceError
from models.marching import march_model
from models.modal import build_modal
from models.plant import build_plant
from models.propagator import exact_step, to_blocks
from models.step_tables import input_columns
from models.structure import check_drift

H, BAND = 1.0 / 6144.0, 880.0


def beam(rate, *beside, rayleigh=(0.0, 0.0), gravity=0.0):
    rig = rig_with(rayleigh_damping=rayleigh, gravity=gravity)
    return build_modal(build_plant(rig, [EFFECTS["stiffness_drift"](Place(), rate), *beside]), BAND)


def free(model, mode, seconds):
    """(M,) displacement of one mode let go at 1."""
    n, row = round(seconds / H), np.eye(model.n)[mode : mode + 1]
    out, start = np.empty((1, n)), np.append(row[0], np.zeros(model.n))
    drive = Drive(np.zeros(n), None, STILL, None)
    read = lambda system: system.displacement(row)  # noqa: E731
    assert march_model(model, drive, H, BAND, start, read, out, np.empty((0, 0)), 1e-9) == n - 1
    return out[0]


def airys(omega, rate, t):
    """Q(t) of q'' + omega^2 (1 + rate t) q = 0 from 1: of x = -(omega / rate)^(2/3) (1 + rate t)."""
    scale = (omega / abs(rate)) ** (2.0 / 3.0)
    a, slope_a, b, slope_b = airy(-scale)
    part = np.linalg.solve([[a, b], [slope_a, slope_b]], [1.0, 0.0])
    now = airy(-scale * (1.0 + rate * t))
    return part[0] * now[0] + part[1] * now[2]


@pytest.mark.parametrize("rate", [-0.02, -1e-3, 1e-3, 0.02, 0.1])
@pytest.mark.parametrize("mode", range(6))
def test_a_mode_whose_stiffness_grows_moves_as_airys_functions(rate, mode):
    model = beam(rate)
    omega, highest = model.omega[mode], model.omega[model.omega < 2 * np.pi * BAND].max()
    found, t = free(model, mode, 3.0), H * np.arange(round(3.0 / H))
    # The phase within a segment, and jumps that fall in step with the mode as it slides (docs/theory.md, section 5).
    in_step = (
        0.25 * np.sqrt(2.0 * np.pi * abs(rate) / (2.0 * omega)) if omega > 0.5 * np.sqrt(highest * abs(rate)) else 0.0
    )
    allowed = 1.2 * PHASE_ERROR * omega / highest + 2.0 * in_step
    assert np.abs(found - airys(omega, rate, t)).max() < allowed


def test_the_phase_of_the_highest_mode_departs_within_a_segment_by_what_is_allowed():
    rate = 1e-3
    model = beam(rate)
    highest = int(np.flatnonzero(model.omega < 2 * np.pi * BAND)[-1])
    steps = steps_of_segment(rate, model.omega, BAND, H)
    t = H * np.arange(steps)
    departed = free(model, highest, steps * H) - airys(model.omega[highest], rate, t)
    expected = rate * model.omega[highest] * (steps * H) ** 2 / 16.0
    assert 0.25 * PHASE_ERROR < expected <= PHASE_ERROR
    assert np.abs(departed).max() == pytest.approx(expected, rel=0.03)  # of the phase, a cosine shows its largest part
    assert np.abs(departed[-3:]).max() < 0.1 * expected


def test_damping_in_proportion_follows_and_is_what_its_own_quotient_says():
    """The envelope falls with the integral of eta2 omega^2 (1 + rate t) / 2, and as the energy per frequency stays."""
    rate, eta = 0.05, 2e-5
    model, seconds = beam(rate, rayleigh=(0.0, eta)), 4.0
    found, omega = free(model, 1, seconds), model.omega[1]
    phi = 1.0 + rate * seconds
    last = np.abs(found[-round(0.1 / H) :]).max()
    middle = seconds - 0.05
    expected = np.exp(-0.5 * eta * omega**2 * (middle + 0.5 * rate * middle**2)) * phi**-0.25
    unmoved = np.exp(-0.5 * eta * omega**2 * middle) * phi**-0.25
    swing = np.exp(0.5 * eta * omega**2 * 0.05 * phi)  # the peak lies at the start of the stretch that is looked at
    assert last == pytest.approx(expected * swing, rel=0.02)
    assert last != pytest.approx(unmoved * swing, rel=0.02)


@pytest.mark.parametrize(
    "beside",
    [
        (),
        (EFFECTS["clamp_compliance"](Place(), 4e4),),
        (EFFECTS["axial_load"](Place(), 800.0), EFFECTS["local_damage"](Place(position=0.5), loss=0.4)),
        (EFFECTS["point_stiffness"](Place(position=0.8), 1e9),),
    ],
    ids=["bending alone", "clamp", "hinge under tension", "stiff spring"],
)
def test_a_step_of_a_segment_is_that_of_its_whole_matrices(beside):
    """Against the blocks of 2n eigenvectors, which know nothing of modes; a stiff spring takes digits from those."""
    rate, steps = 0.02, 200
    model = beam(rate, *beside, rayleigh=(1.2, 6e-6))
    segments, s = segments_of(model, H, steps, 0), 5
    growth = rate * 5.5 * steps * H
    inputs = np.column_stack([input_columns(model), -model.bending_at_rest])
    damping = model.damping + 6e-6 * growth * model.bending
    whole = to_blocks(model.omega, damping, inputs, growth * model.bending)
    expected, found = exact_step(whole, H), segments.step(s)
    state = np.append(1.0 / model.omega, np.ones(model.n))

    def moved(step, back, forth):
        first, second = np.split(forth @ state, 2)
        e = step.exponential
        new = np.concatenate([e[0] * first + e[1] * second, e[2] * first + e[3] * second])
        return back @ (new + step.start[-2] + step.end[-2])

    scale = np.append(1.0 / model.omega[0] * np.ones(model.n), np.ones(model.n))
    apart = moved(found, segments.to_modal[s], segments.from_modal[s]) - moved(
        expected, whole.to_modal, whole.from_modal
    )
    np.testing.assert_allclose(apart / scale, 0.0, atol=1e-6)


def test_segments_are_short_for_high_modes_and_large_rates_and_never_empty():
    omega = np.array([50.0, 5000.0, 5e5])
    longest = np.sqrt(16.0 * PHASE_ERROR / 5.0) / H
    assert 0.5 * longest < steps_of_segment(0.001, omega, BAND, H) <= longest
    assert steps_of_segment(0.00025, omega, BAND, H) == 2 * steps_of_segment(0.001, omega, BAND, H)
    assert steps_of_segment(-0.001, omega, BAND, H) == steps_of_segment(0.001, omega, BAND, H)
    assert steps_of_segment(1e12, omega, BAND, H) == 1


def test_a_stiffness_that_is_used_up_is_refused_by_name():
    check_drift(-0.25, 3.99)
    with pytest.raises(
        DivergenceError, match=r"stiffness_drift: at -0.25 .* is gone 4 s after the start of a record of 5 s"
    ):
        check_drift(-0.25, 5.0)
