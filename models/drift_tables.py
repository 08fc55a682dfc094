"""A beam whose bending stiffness grows in time, as the stepper takes it: segments of constant stiffness.

In the modes of the record's start the stiffness is omega^2 + g B, with B the share of the beam's own bending and
g = rate t; the damping gains eta2 g B. Each segment has the g of its middle. The state is the motion about rest, and
what bends the beam at rest drifts too: that is one more known input, straight in time. docs/theory.md, section 5.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import floor, log2, pi, sqrt

import numpy as np

from models.arrays import FloatArray
from models.beam.assembly import LEAST_INVERSE
from models.lanes import LANES
from models.modal import ModalModel
from models.propagator import Blocks, Step, exact_step, to_blocks
from models.step_tables import input_columns
from models.stepping import Reading

PHASE_ERROR = 1e-3
"""Largest phase, rad, by which the highest mode in the band is ahead or behind within a segment; at its ends it is
right again. In lower modes it is less in proportion."""

AT_ONCE = 32
"""Segments whose tables are made, and kept, together."""

ROUND_OFF = 1e-9
"""Share of the own dampings below which modes are not coupled by damping."""


@dataclass(frozen=True, eq=False)
class Segments:
    """Tables of S segments in a row; a step of segment s is that of ``propagator.Step``.

    Attributes:
        exponential: (S, 4, n).
        start, end: (S, n_inputs, 2n), of the inputs of ``step_tables.input_columns`` and of the bending at rest.
        q, v: motion of the ports from the state, (S, n_ports, width) from a column on.
        from_modal: (S, 2n, 2m) from the modes of the record's start to the segment's coordinates.
        to_modal: (S, 2m, 2n) back.
    """

    exponential: FloatArray
    start: FloatArray
    end: FloatArray
    q: tuple[FloatArray, int]
    v: tuple[FloatArray, int]
    from_modal: FloatArray
    to_modal: FloatArray

    def step(self, s: int) -> Step:
        """Of one segment."""
        return Step(self.exponential[s], self.start[s], self.end[s])

    def motion(self, s: int) -> tuple[Reading, Reading]:
        """q and v of the ports from the state of one segment."""
        return Reading(self.q[0][s], self.q[1]), Reading(self.v[0][s], self.v[1])

    def read(self, rows: FloatArray) -> list[Reading]:
        """What rows (n_out, 2m) by modal displacement and velocity read of the state of each segment."""
        found, first = _trimmed(rows @ self.to_modal)
        return [Reading(row, first) for row in found]


def steps_of_segment(rate: float, omega: FloatArray, band: float, h: float) -> int:
    """Steps of h, s, in a segment: a power of 2, so that a fit which moves a number a little keeps its segments.

    The frequency of a mode is off by up to rate omega T / 4 at the ends of a segment of length T and right in its
    middle: the phase departs by the integral of that over half a segment, rate omega T^2 / 16, and comes back.

    Args:
        rate: of the bending stiffness, 1/s.
        omega: (n,) rad/s.
        band: highest frequency of interest, Hz.
        h: s.
    """
    highest = float(omega[omega <= 2.0 * pi * band].max(initial=float(omega.min())))
    longest = sqrt(16.0 * PHASE_ERROR / (abs(rate) * highest)) / h
    return int(2.0 ** max(0, floor(log2(longest))))


@lru_cache(maxsize=64)
def segments_of(model: ModalModel, h: float, n_steps: int, number: int) -> Segments:
    """The tables of segments ``AT_ONCE number`` and on, kept for the rig's other records.

    Args:
        model: whose structure's stiffness grows.
        h: step, s.
        n_steps: in each segment.
        number: of the group of segments.
    """
    structure, m = model.plant.structure, model.n
    middle = (AT_ONCE * number + np.arange(AT_ONCE, dtype=float) + 0.5) * (n_steps * h)
    growth = np.asarray((structure.stiffness_rate * middle)[:, None, None], float)
    inputs = np.column_stack([input_columns(model), -model.bending_at_rest])
    damping = model.damping + structure.viscosity * growth * model.bending
    square, turn = _own_modes(model, growth)
    turned = turn.transpose(0, 2, 1) @ damping @ turn
    own = np.diagonal(turned, axis1=1, axis2=2)
    coupled = np.abs(turned) > ROUND_OFF * np.sqrt(np.abs(own[:, :, None] * own[:, None, :]))
    if np.any(coupled & ~np.eye(m, dtype=bool)):
        systems = [
            to_blocks(model.omega, c, inputs, g * model.bending) for c, g in zip(damping, growth[:, 0], strict=True)
        ]
        system = _Stack(*(np.stack([getattr(one, part) for one in systems]) for part in PARTS))
    else:
        system = _uncoupled(square, own, turn, inputs)
    return _segments(model, system, h)


PARTS = ("blocks", "inputs", "from_modal", "to_modal")


@dataclass(frozen=True, eq=False)
class _Stack:
    """``propagator.Blocks`` of S segments: each array with S in front."""

    blocks: FloatArray
    inputs: FloatArray
    from_modal: FloatArray
    to_modal: FloatArray


def _own_modes(model: ModalModel, growth: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(S, m) squared frequencies and (S, m, m) modes of each segment, in those of the record's start."""
    bending, square = model.bending, model.omega**2
    if not np.any(bending - np.diag(np.diag(bending))):  # bending is all: the modes stay
        return square + growth[:, 0] * np.diag(bending), np.tile(np.eye(model.n), (len(growth), 1, 1))
    # Of the inverse, whose large eigenvalues, the low modes, keep all their digits beside a spring however stiff.
    omega = np.outer(model.omega, model.omega)
    found, turn = np.linalg.eigh(np.linalg.inv(np.eye(model.n) + growth * bending / omega) / omega)
    least = LEAST_INVERSE * np.abs(found).max(axis=1, keepdims=True)
    return 1.0 / np.where(np.abs(found) > least, found, least), turn


def _uncoupled(square: FloatArray, damping: FloatArray, turn: FloatArray, inputs: FloatArray) -> _Stack:
    """Blocks of modes that no damping couples, from (S, m) squared frequencies and dampings."""
    n_segments, m = square.shape
    n = -(-m // LANES) * LANES
    speed = np.sqrt(np.where(square > 0.0, square, 1.0))
    blocks = np.zeros((n_segments, n, 2, 2))
    blocks[:, :m, 0, 1], blocks[:, :m, 1, 0], blocks[:, :m, 1, 1] = speed, -square / speed, -damping
    from_modal, to_modal = np.zeros((n_segments, 2 * n, 2 * m)), np.zeros((n_segments, 2 * m, 2 * n))
    from_modal[:, :m, :m] = turn.transpose(0, 2, 1)
    from_modal[:, n : n + m, m:] = turn.transpose(0, 2, 1) / speed[:, :, None]
    to_modal[:, :m, :m], to_modal[:, m:, n : n + m] = turn, turn * speed[:, None, :]
    return _Stack(blocks, from_modal[:, :, m:] @ inputs, from_modal, to_modal)


def _segments(model: ModalModel, system: _Stack, h: float) -> Segments:
    """One step of each, all exponentials at once."""
    n_segments, n = system.blocks.shape[:2]
    m, n_inputs = model.n, system.inputs.shape[2]
    force = system.inputs.reshape(n_segments, 2, n, n_inputs).transpose(1, 0, 2, 3)
    whole = Blocks(
        system.blocks.reshape(-1, 2, 2), force.reshape(-1, n_inputs), system.from_modal[0], system.to_modal[0]
    )
    step = exact_step(whole, h)

    def of_each(row: FloatArray, parts: int) -> FloatArray:
        split = row.reshape(len(row), parts, n_segments, n).transpose(2, 0, 1, 3)
        return np.ascontiguousarray(split.reshape(n_segments, len(row), parts * n))

    return Segments(
        exponential=of_each(step.exponential, 1),
        start=of_each(step.start, 2),
        end=of_each(step.end, 2),
        q=_trimmed(model.port_rows @ system.to_modal[:, :m]),
        v=_trimmed(model.port_rows @ system.to_modal[:, m:]),
        from_modal=system.from_modal,
        to_modal=system.to_modal,
    )


def _trimmed(rows: FloatArray) -> tuple[FloatArray, int]:
    """``Reading.of`` of (S, n_rows, 2n) rows, alike in all segments."""
    some = Reading.of(np.abs(rows).max(axis=0))
    width = some.rows.shape[1]
    return np.ascontiguousarray(rows[:, :, some.first : some.first + width]), some.first
