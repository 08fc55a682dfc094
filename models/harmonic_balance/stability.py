"""Stability of a periodic motion: multipliers of what a small disturbance becomes after one period (Floquet).

Within each sample the linear part moves exactly; the slopes of laws and contacts act in kicks between.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np

from models.arrays import FloatArray
from models.compiled import compiled
from models.harmonic_balance.equations import OverPeriod
from models.modal import ModalModel
from models.propagator import to_blocks

Loss = Literal["", "fold", "period doubling", "torus"]
"""How stability is lost: by a multiplier beyond +1, beyond -1, or by a pair beyond the unit circle; empty if stable."""

ROUND_OFF = 1e-6
"""By which a multiplier may lie outside the unit circle."""

NEARLY_REAL = 1e-6
"""Imaginary part of a multiplier over its size below which it counts as real."""


ALIKE = 1e-8
"""Half the difference of two eigenvalues times the step below which they count as one; round-off is its square."""


@dataclass(frozen=True)
class Stability:
    """Of one periodic motion.

    Attributes:
        largest: modulus of the largest multiplier.
        loss: how stability is lost.
    """

    largest: float
    loss: Loss


def stability_of(model: ModalModel, omega: float, moved: OverPeriod) -> Stability:
    """From the slopes of the forces over the period.

    Args:
        model: that moves.
        omega: rad/s.
        moved: the motion's forces and their slopes.
    """
    blocks, push, see_q, see_v = _real_form(model)
    h = 2.0 * np.pi / (omega * moved.by_q.shape[1])
    turned = monodromy(_exponentials(blocks * h), push * h, see_q, see_v, moved.by_q, moved.by_v)
    multipliers = np.linalg.eigvals(turned)
    worst = multipliers[np.abs(multipliers).argmax()]
    return Stability(float(np.abs(worst)), _loss(complex(worst)))


@lru_cache(maxsize=8)
def _real_form(model: ModalModel) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """(n, 2, 2) blocks of the linear part; (2n, n_ports) unit forces and (n_ports, 2n) twice q and v in its state."""
    rows = model.port_rows
    system = to_blocks(model.omega, model.damping, rows.T)
    busy = np.concatenate([np.arange(model.n), len(system.blocks) + np.arange(model.n)])
    seen = (system.displacement(rows)[:, busy], system.velocity(rows)[:, busy])
    see_q, see_v = (np.ascontiguousarray(one) for one in seen)
    return system.blocks[: model.n], np.ascontiguousarray(system.inputs[busy]), see_q, see_v


def _exponentials(blocks: FloatArray) -> FloatArray:
    """(n, 2, 2) of 2 x 2 matrices B: exp(m) (cosh(d) + (B - m) sinh(d) / d), m half the trace, d^2 = m^2 - det B."""
    mean = 0.5 * (blocks[:, 0, 0] + blocks[:, 1, 1])
    spread = np.sqrt((mean**2 - np.linalg.det(blocks)).astype(complex))
    up, down = np.exp(mean + spread), np.exp(mean - spread)
    same = np.abs(spread) < ALIKE
    level = 0.5 * (up + down).real
    slope = np.where(same, np.exp(mean), (0.5 * (up - down) / np.where(same, 1.0, spread)).real)
    apart = blocks - mean[:, None, None] * np.eye(2)
    return np.asarray(level[:, None, None] * np.eye(2) + slope[:, None, None] * apart)


def _loss(worst: complex) -> Loss:
    if abs(worst) <= 1.0 + ROUND_OFF:
        return ""
    if abs(worst.imag) > NEARLY_REAL * abs(worst):
        return "torus"
    return "fold" if worst.real > 0.0 else "period doubling"


@compiled
def monodromy(  # noqa: C901 loops written out run three times as fast as sums of arrays
    advance: FloatArray,
    push: FloatArray,
    see_q: FloatArray,
    see_v: FloatArray,
    by_q: FloatArray,
    by_v: FloatArray,
) -> FloatArray:
    """(2n, 2n) what a disturbance becomes after one period.

    Args:
        advance: (n, 2, 2) of the blocks over one sample.
        push: (2n, n_ports) of a unit force over one sample.
        see_q: (n_ports, 2n) displacement of the ports, m.
        see_v: (n_ports, 2n) their velocity, m/s.
        by_q: (n_ports, N) slopes of the forces over the displacement, N/m.
        by_v: (n_ports, N) over the velocity, N s/m.
    """
    n = advance.shape[0]
    state, seen = np.eye(2 * n), np.zeros(2 * n)
    for k in range(by_q.shape[1]):
        for i in range(by_q.shape[0]):
            kq, kv = by_q[i, k], by_v[i, k]
            if kq == 0.0 and kv == 0.0:
                continue
            seen[:] = 0.0
            for m in range(n):
                first = kq * see_q[i, m] + kv * see_v[i, m]
                second = kq * see_q[i, n + m] + kv * see_v[i, n + m]
                for c in range(2 * n):
                    seen[c] += first * state[m, c] + second * state[n + m, c]
            for m in range(2 * n):
                pushed = push[m, i]
                if pushed != 0.0:
                    for c in range(2 * n):
                        state[m, c] += pushed * seen[c]
        for m in range(n):
            a, b, d, e = advance[m, 0, 0], advance[m, 0, 1], advance[m, 1, 0], advance[m, 1, 1]
            for c in range(2 * n):
                upper, lower = state[m, c], state[n + m, c]
                state[m, c] = a * upper + b * lower
                state[n + m, c] = d * upper + e * lower
    return state
