"""Records in pieces: past where neighbouring motions part, a record is followed again from starts of its own.

Impacts magnify what is not known exactly, until nobody can follow a motion that began long ago. From its state at a
later sample it can be followed again. That state is found from the samples after it, beginning with where the piece
before leads to; what a small change of it would do is left out of what is judged, so that no fit has to move it. A
piece of a second tells some thousand numbers, of which its start takes two a mode.

Source: multiple shooting as in H. G. Bock, K. J. Plitt, IFAC Proceedings 17 (1984) 1603; separable least squares as in
G. H. Golub, V. Pereyra, SIAM J. Numer. Anal. 10 (1973) 413.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import pairwise
from math import inf
from typing import Any, Self

import numpy as np

from identification.evaluate import Evaluator, Target, TimeTarget, carry_noise, whitened
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis
from identification.onset import goes_on
from identification.parallel import in_parallel
from identification.piece_start import PieceStart, start_near, start_sought
from identification.prepare import MIN_SAMPLES, Horizon, horizons
from identification.wire import sent_once
from models.arrays import FloatArray
from models.plant import Plant
from models.record import Record
from models.simulate import Response, Settings

SECONDS = 1.0
"""Of a piece: impacts have magnified little in it, and it tells much more than its start takes."""

IN_ALL = 12.0
"""Seconds in pieces, of all records together, one of each at least: a search in them takes some minutes."""

LOUDEST = 0.15
"""Noise, as a share of the motion, up to which a piece is used: beyond, it is not in proportion to the force's."""


@sent_once
@dataclass(frozen=True, eq=False, kw_only=True)
class Piece(TimeTarget):
    """A part of a record that begins in motion, as a fit sees it: beyond what its start could do.

    Attributes:
        whole_name: of the record that it is of.
        start: the motion with which it begins, where a hypothesis does not tell its own, and what a change of it does.
    """

    whole_name: str
    start: PieceStart

    @property
    def n_judged(self) -> int:
        """Chi-square that noise alone leaves in the mean: every number of the start takes one."""
        return super().n_judged - len(self.start.slopes)

    @property
    def begins_later(self) -> bool:
        """It is no beginning of a record."""
        return True

    def disturbed(self, share: float) -> Self:
        """With what drives it, and its start, larger by this share."""
        begin, more = self.start.begin, 1.0 + share
        moved = replace(begin, displacement=begin.displacement * more, velocity=begin.velocity * more)
        return replace(super().disturbed(share), start=replace(self.start, begin=moved))

    def heard_as(self, whole: TimeTarget) -> Self:
        """With the noise of the sensors as it is told of the whole record."""
        heard = self.with_noise(whole.noise)
        return heard.with_carried(self.carried) if len(self.carried) else heard

    def response(self, hypothesis: Hypothesis, settings: Settings, plant: Plant | None = None) -> Response:
        """What the model says from this start."""
        name = self.record.name
        there = replace(hypothesis, starts={}, motions={name: hypothesis.motions.get(name, self.start.begin)})
        return there.simulated(self.driven, settings, self.met_by(plant or hypothesis.plant()))

    def residual(self, hypothesis: Hypothesis, settings: Settings) -> FloatArray:
        """(n_data,) model minus measured in standard deviations of the noise, less what another start would do."""
        residual = super().residual(hypothesis, settings)
        return np.asarray(residual - self._of_start @ (self._of_start.T @ residual))

    @cached_property
    def _of_start(self) -> FloatArray:
        """(n_data, n_states) orthonormal: what changes of the start do to a residual."""
        columns = [whitened(self.spectrum(each), self) for each in self.start.slopes]
        return np.asarray(np.linalg.qr(np.stack(columns, axis=1))[0])

    def only(self, names: Sequence[str]) -> Self:
        """The channels of these sensors, which it has, in this order."""
        kept = [self.record.sensors.index(name) for name in names]
        return replace(super().only(names), start=replace(self.start, slopes=self.start.slopes[:, kept]))

    def _part(self, record: Record, driven: Record, carried: FloatArray, unjudged: int) -> Self:
        start = replace(self.start, slopes=self.start.slopes[:, :, : record.n_samples])
        return replace(super()._part(record, driven, carried, unjudged), start=start)


def pieces_of(
    evaluator: Evaluator, hypothesis: Hypothesis, limits: Sequence[Horizon], least: float, rng: np.random.Generator
) -> tuple[Piece, ...]:
    """What can be followed of the records past where this model loses them; nothing by one with a memory or a clock.

    Args:
        evaluator: whole records.
        hypothesis: the model, by which the starts are found.
        limits: how far it follows each of the time records from its start.
        least: share of a record, followed from its start, from which it is not cut in pieces.
        rng: of the noise that the model carries from the measured force.

    Raises:
        ArithmeticError: the motion leaves the finite numbers before its horizon.
    """
    torn = [
        (target, round(limit.seconds * target.record.fs))
        for target, limit in zip(evaluator.timed, limits, strict=True)
        if limit.seconds < least * target.record.duration and _judged_of(target, hypothesis) >= MIN_SAMPLES
    ]
    # Where displacements are measured from a start in motion, the force's zero is unknown with it.
    if not torn or hypothesis.offsets or not goes_on(hypothesis):
        return ()
    model, most = replace(hypothesis, motions={}), max(1, int(IN_ALL / SECONDS / len(torn)))
    rows = in_parallel(evaluator.jobs, partial(_pieces_from, evaluator.with_jobs(1), model, most), torn)
    pieces = [piece for row in rows for piece in row]
    if not pieces:
        return ()
    followed = horizons(evaluator.with_targets(pieces), model)
    lengths = [
        min(piece.record.n_samples, round(limit.seconds * piece.record.fs))
        for piece, limit in zip(pieces, followed, strict=True)
    ]
    pairs = zip(pieces, lengths, strict=True)
    long = [piece.cut(n) for piece, n in pairs if n - piece.waits >= MIN_SAMPLES]
    heard = carry_noise(evaluator.with_targets(long), model, rng)
    return tuple(piece for piece in heard if isinstance(piece, Piece) and piece.nrmse_of_noise <= LOUDEST)


def _judged_of(target: TimeTarget, hypothesis: Hypothesis) -> float:
    """Samples of a piece that are judged: those in which a late channel tells of what was before are not."""
    return (SECONDS - hypothesis.looks_back(target.record.sensors)) * target.record.fs


def most_missed(evaluator: Evaluator, base: Fit, seconds: float) -> list[Piece]:
    """The pieces in which a model leaves most beyond the noise, the most telling first; none where there are none.

    Args:
        evaluator: records of the fit.
        base: the model, fitted to them.
        seconds: of all of them together, at least, where there are as many.
    """
    pieces = [(target, part) for target, part in evaluator.parts_of(base.residual) if isinstance(target, Piece)]
    pieces.sort(key=lambda pair: float(pair[0].n_judged - pair[1] @ pair[1]))
    lengths = np.cumsum([target.record.duration for target, _ in pieces])
    return [target for target, _ in pieces[: int(np.searchsorted(lengths, seconds)) + 1]]


def _pieces_from(evaluator: Evaluator, hypothesis: Hypothesis, most: int, torn: tuple[TimeTarget, int]) -> list[Piece]:
    """The next pieces of a record from a sample on, each begun where the one before it leads to, until one is lost."""
    target, first = torn
    fs, n, back = target.record.fs, round(SECONDS * target.record.fs), hypothesis.looks_back(target.record.sensors)
    found: list[Piece] = []
    motion = hypothesis.motion_at(target.driven, first, evaluator.settings)
    last = min(target.record.n_samples, first + most * n)
    for begin, end in pairwise(range(first, last + 1, n)):
        later = replace(target.later(begin, f"{target.record.name} from {begin / fs:.2f} s", back), ran=begin / fs)
        part = later.cut(end - begin)
        try:
            start = start_sought(evaluator, hypothesis, part, motion)
            found.append(Piece(**_fields_of(part), whole_name=target.record.name, start=start))
            if end + n <= last:
                begun = replace(hypothesis, starts={}, motions={part.record.name: start.begin})
                motion = begun.motion_at(later.driven, end - begin, evaluator.settings)
        except ArithmeticError:
            break
    return found


def _fields_of(part: TimeTarget) -> dict[str, Any]:
    return {name: getattr(part, name) for name in TimeTarget.__dataclass_fields__}


def begun_by(evaluator: Evaluator, hypothesis: Hypothesis) -> tuple[Evaluator, Hypothesis]:
    """The pieces with slopes taken where this model begins them best, near where others do; the model with its starts.

    A law with a memory begins in each without one. Both as they are where there are no pieces.

    Args:
        evaluator: perhaps with pieces.
        hypothesis: any.
    """
    if not in_pieces(evaluator):
        return evaluator, hypothesis
    targets = in_parallel(evaluator.jobs, partial(_begun_near, evaluator.with_jobs(1), hypothesis), evaluator.targets)
    begun = {target.record.name: target.start.begin for target in targets if isinstance(target, Piece)}
    return evaluator.with_targets(targets), replace(hypothesis, motions={**hypothesis.motions, **begun})


def in_pieces(evaluator: Evaluator) -> bool:
    """Whether some of its records are pieces of others."""
    return any(isinstance(target, Piece) for target in evaluator.targets)


def _begun_near(evaluator: Evaluator, hypothesis: Hypothesis, piece: Target) -> Target:
    """A piece begun by a model near where others do, or where it has begun it before; as it is where that is lost.

    What is no piece stays as it is.
    """
    if not isinstance(piece, Piece):
        return piece
    name, alone = piece.record.name, evaluator.with_targets([piece])
    begins = [piece.start.begin, *(motion for of, motion in hypothesis.motions.items() if of == name)]
    rows = alone.residuals([(replace(hypothesis, motions={name: begin}), None) for begin in begins])
    left = [inf if row is None else float(row @ row) for row in rows]
    try:
        bare = TimeTarget(**_fields_of(piece))
        return replace(piece, start=start_near(evaluator, hypothesis, bare, begins[int(np.argmin(left))]))
    except ArithmeticError:
        return piece


def fit_from_own_starts(evaluator: Evaluator, found: Fit) -> Fit:
    """A fit gone on with the pieces begun by itself, for as long as that brings it nearer; the same without pieces.

    A start that was found by a model without what is missing is off by more than its slopes can tell.

    Args:
        evaluator: records of the fit.
        found: ended, with the starts of another model.
    """
    if not in_pieces(evaluator):
        return found
    for _ in range(MOST_TIMES):
        own, there = begun_by(evaluator, found.hypothesis)
        try:
            again = fit(own, there, found.unknowns, max_iterations=ITERATIONS, precise=True)
        except ArithmeticError:
            break
        before, found = found.cost, min(found, again, key=lambda each: each.cost)
        if found.cost > WORTH_WHILE * before:
            break
    return found


MOST_TIMES, ITERATIONS, WORTH_WHILE = 3, 6, 0.9
"""Times that pieces are begun anew in a fit, of so many iterations, and the share of the cost to which each of them has
to bring it to go on."""
