"""One step of the linear system against the matrix exponential of the whole."""

import numpy as np
import pytest
from scipy.linalg import expm

from models.errors import NotComputableError
from models.lanes import LANES
from models.propagator import exact_step, to_blocks

H = 2e-4
RNG = np.random.default_rng(5)
OMEGA = np.array([3.0, 60.0, 700.0, 9e3, 8e4])
INPUTS = RNG.standard_normal((5, 3))


def proportional():
    return np.diag(1.2 + 6e-6 * OMEGA**2)


def coupled(size=40.0):
    row = RNG.standard_normal(5)
    return proportional() + size * np.outer(row, row)


DAMPINGS = {
    "none": np.zeros((5, 5)),
    "proportional": proportional(),
    "overdamped": np.diag([50.0, 900.0, 1.0, 1.0, 1e6]),
    "coupled": coupled(),
    "coupled and overdamped": coupled(8e3),
}


def reference(omega, damping, h):
    """(2m, 2m) exponential and (2m, n_inputs) effect of inputs 1 at the start, and at the end, of a linear course."""
    m, k = len(omega), INPUTS.shape[1]
    scale = np.concatenate([np.ones(m), np.maximum(omega, 1.0)])
    system = np.block([[np.zeros((m, m)), np.eye(m)], [-np.diag(omega**2), -damping]])
    system = system * scale / scale[:, None]  # balanced, or the large exponential loses digits
    force = np.vstack([np.zeros((m, k)), INPUTS]) / scale[:, None]
    big = np.zeros((2 * m + 2 * k, 2 * m + 2 * k))
    big[: 2 * m, : 2 * m], big[: 2 * m, 2 * m : -k] = system * h, force * h
    big[2 * m : -k, -k:] = np.eye(k)
    power = expm(big)
    end = power[: 2 * m, -k:]
    start = power[: 2 * m, 2 * m : -k] - end
    return power[: 2 * m, : 2 * m] * scale[:, None] / scale, start * scale[:, None], end * scale[:, None]


def stepped(blocks, step, state, start, end):
    """(q, q') after one step from (q, q') with inputs going from ``start`` to ``end``."""
    n = len(blocks.blocks)
    first, second = np.split(blocks.from_modal @ state, 2)
    e = step.exponential
    new = np.concatenate([e[0] * first + e[1] * second, e[2] * first + e[3] * second])
    assert len(first) == n
    return blocks.to_modal @ (new + start @ step.start + end @ step.end)


@pytest.mark.parametrize("damping", DAMPINGS.values(), ids=DAMPINGS)
@pytest.mark.parametrize("h", [H, 1e-6, 5e-3])
def test_a_step_is_exact(damping, h):
    blocks = to_blocks(OMEGA, damping, INPUTS)
    step = exact_step(blocks, h)
    state, start, end = RNG.standard_normal(10), RNG.standard_normal(3), RNG.standard_normal(3)
    state[5:] *= OMEGA
    whole, at_start, at_end = reference(OMEGA, damping, h)
    expected = whole @ state + at_start @ start + at_end @ end
    scale = np.concatenate([np.ones(5), OMEGA]) * np.abs(state[:5]).max()
    np.testing.assert_allclose(stepped(blocks, step, state, start, end) / scale, expected / scale, atol=1e-9)


@pytest.mark.parametrize("damping", DAMPINGS.values(), ids=DAMPINGS)
def test_two_half_steps_are_one(damping):
    blocks = to_blocks(OMEGA, damping, INPUTS)
    whole, half = exact_step(blocks, H), exact_step(blocks, H / 2)
    state, start, end = np.zeros(10), RNG.standard_normal(3), RNG.standard_normal(3)
    middle = stepped(blocks, half, state, start, 0.5 * (start + end))
    twice = stepped(blocks, half, middle, 0.5 * (start + end), end)
    once = stepped(blocks, whole, state, start, end)
    np.testing.assert_allclose(twice, once, rtol=1e-9, atol=1e-9 * np.abs(once[5:]).max() / OMEGA[-1])


def test_a_stiffness_beside_the_modes_own_is_that_of_the_modes_it_makes():
    """In the modes that both make, with the damping turned, the same step."""
    row = RNG.standard_normal(5)
    stiffening = 2e4 * np.outer(row, row)
    square, turn = np.linalg.eigh(np.diag(OMEGA**2) + stiffening)
    state, end = RNG.standard_normal(10) * np.append(np.ones(5), OMEGA), RNG.standard_normal(3)
    damping = coupled()
    blocks = to_blocks(OMEGA, damping, INPUTS, stiffening)
    found = stepped(blocks, exact_step(blocks, H), state, np.zeros(3), end)
    own = to_blocks(np.sqrt(square), turn.T @ damping @ turn, turn.T @ INPUTS)
    both = np.kron(np.eye(2), turn)
    expected = both @ stepped(own, exact_step(own, H), both.T @ state, np.zeros(3), end)
    scale = np.concatenate([np.ones(5), OMEGA]) * np.abs(state[:5]).max()
    np.testing.assert_allclose(found / scale, expected / scale, atol=1e-8)


def test_a_mass_that_nothing_holds_falls_as_a_parabola():
    blocks = to_blocks(np.zeros(1), np.zeros((1, 1)), np.ones((1, 1)))
    found = stepped(blocks, exact_step(blocks, H), np.array([0.1, 2.0]), np.ones(1), np.ones(1))
    np.testing.assert_allclose(found, [0.1 + 2.0 * H + H**2 / 2, 2.0 + H], rtol=1e-14)


def test_without_damping_energy_stays():
    blocks = to_blocks(OMEGA, np.zeros((5, 5)), INPUTS)
    step, nothing = exact_step(blocks, H), np.zeros(3)
    state = np.concatenate([1.0 / OMEGA, np.zeros(5)])
    for _ in range(2000):
        state = stepped(blocks, step, state, nothing, nothing)
    np.testing.assert_allclose((OMEGA * state[:5]) ** 2 + state[5:] ** 2, 1.0, rtol=1e-10)


@pytest.mark.parametrize("damping", DAMPINGS.values(), ids=DAMPINGS)
def test_coordinates_go_forth_and_back_and_idle_blocks_stay_out(damping):
    blocks = to_blocks(OMEGA, damping, INPUTS)
    np.testing.assert_allclose(blocks.to_modal @ blocks.from_modal, np.eye(10), atol=1e-9 * OMEGA[-1])
    assert len(blocks.blocks) % LANES == 0
    idle = np.tile(np.arange(LANES) >= 5, 2)
    assert not blocks.inputs[idle].any()
    assert not blocks.to_modal[:, idle].any()
    assert not blocks.blocks[5:].any()


def test_rows_read_displacements_and_velocities():
    blocks = to_blocks(OMEGA, coupled(), INPUTS)
    row, state = RNG.standard_normal((1, 5)), RNG.standard_normal(10)
    x = blocks.from_modal @ state
    assert (blocks.displacement(row) @ x)[0] == pytest.approx((row @ state[:5])[0], rel=1e-9)
    assert (blocks.velocity(row) @ x)[0] == pytest.approx((row @ state[5:])[0], rel=1e-9)


def test_a_critically_damped_mode_beside_another_moves_as_it_should():
    """x = (1 + w t) e^(-w t) from rest at 1; the other is coupled to nothing, but by a matrix that is not diagonal."""
    w = 40.0
    damping = np.array([[2.0 * w, 0.0, 0.0], [0.0, 3.0, 1.0], [0.0, 1.0, 4.0]])
    blocks = to_blocks(np.array([w, 100.0, 300.0]), damping, np.zeros((3, 1)))
    step, nothing = exact_step(blocks, H), np.zeros(1)
    state = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    for _ in range(30):
        state = stepped(blocks, step, state, nothing, nothing)
    t = 30 * H
    assert state[0] == pytest.approx((1.0 + w * t) * np.exp(-w * t), abs=1e-7)


def test_a_free_mode_without_damping_among_coupled_ones_is_refused():
    """It moves in proportion to time, which no eigenvalue does."""
    with pytest.raises(NotComputableError) as caught:
        to_blocks(np.array([0.0, 10.0, 20.0]), np.array([[0.0, 0, 0], [0, 1, 0.5], [0, 0.5, 1]]), np.ones((3, 1)))
    assert "two modes that merge" in caught.value.given
    assert "a part in a million" in caught.value.mend
