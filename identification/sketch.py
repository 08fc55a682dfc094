"""A first fit of every suspect on the beginning of the records, in heats.

The beginning of a record is quick to simulate, and the phase of the motion is still right there, however far the
numbers are from the truth. So many suspects are fitted on very little, the best of them again on more.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from math import inf
from operator import attrgetter

from identification.calibrate import beginning, concerning
from identification.evaluate import Evaluator
from identification.evidence import log_occam
from identification.fit import Fit, fit
from identification.hypothesis import Hypothesis, Unknown, own_unknowns
from identification.in_step import tried_with
from identification.parallel import in_parallel
from identification.progress import silent
from identification.scene import NEAR, is_same_place
from identification.screen import Projection, promising, survey
from models.arrays import FloatArray
from models.effects import Effect, Registry
from models.rig import Beam, Rig

Heat = tuple[float, float, int]

HEATS: tuple[Heat, ...] = ((0.02, 0.4, 14), (0.1, 0.75, 10))
"""Share of the response's energy, and seconds at least, on which suspects are fitted; how many go on from there."""

ITERATIONS_ALONE, ITERATIONS, TOLERANCE = 3, 5, 2e-2
"""Of the suspect by itself, while the rig's numbers are held, and then of all: else these are pulled away first."""

ITERATIONS_NEAR, ITERATIONS_TOGETHER, ITERATIONS_FOLLOWED, ITERATIONS_LASTING = 14, 8, 15, 20
"""Of all at once, from numbers that are near: with slopes of the rig's numbers that follow the steps, and formed anew;
more of the few that are followed from a beginning that one of them explains, and of the few kinds that act over the
length of a record."""

MOST_RIVALS = 8
"""Rivals fitted in a heat."""

MOST_LONG_RIVALS = 4
"""Rivals fitted on whole records."""

SIZES = (0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0)
"""Factors on a suspect's size tried there."""


@dataclass(frozen=True, eq=False)
class Sketch:
    """A first fit of a suspect on a part of the records.

    Attributes:
        base: the model without the suspect on the same part.
        fit: with it.
        begun: the suspect where its fit began.
    """

    base: Fit
    fit: Fit
    begun: Effect

    @property
    def effect(self) -> Effect:
        """The suspect as fitted."""
        return self.fit.hypothesis.effects[-1]

    @property
    def share(self) -> float:
        """Share of the cost that the suspect takes away, less what its parameters cost in evidence."""
        return (self.base.cost - self.fit.cost + 2.0 * log_occam(self.fit)) / max(self.base.cost, 1.0)


def heats(
    evaluator: Evaluator,
    start: Hypothesis,
    base: Fit,
    suspects: Sequence[Effect],
    registry: Registry,
    schedule: Sequence[Heat] = HEATS,
    *,
    near: bool = False,
) -> list[Sketch]:
    """The suspects that are left after all heats, best first.

    Args:
        evaluator: records, of which the heats see the beginning.
        start: the model without a suspect where the fits begin.
        base: the calibrated model, for its unknowns.
        suspects: effects at trial sizes.
        registry: kinds to try where the best of them sits.
        schedule: what each heat sees, and how many it leaves.
        near: whether the start is near enough to move all unknowns at once from the first.
    """
    starts = [tried_with(evaluator, start, effect) for effect in suspects]
    sketches: list[Sketch] = []
    too_far: list[Sketch] = []
    noise_reached = False
    first = beginning(evaluator, *schedule[0][:2])
    for number, (share, seconds, most) in enumerate(schedule):
        ground = ground_of(beginning(evaluator, share, seconds), start, base)
        sketches = sketched(ground, starts, near=near, own_slopes=noise_reached)
        if (number == 0 or near) and not any(sketch.fit.ratio < REACHED for sketch in sketches):
            sketches = grown_from_bare(ground, sketches)
        sketches = apart(sketches)
        # Beside numbers that are nearly right the shortest part tells who is worth a sketch on more.
        others = [] if noise_reached else rivals(first, base, sketches, registry)[:MOST_RIVALS]
        sketches = apart(by_share([*sketches, *sketched(ground, others, near=near)]))[:most]
        noise_reached = bool(sketches) and sketches[0].fit.ratio < REACHED < ground.bare.ratio
        if noise_reached:
            close = [sketch for sketch in sketches if sketch.share > FAR_BEHIND * sketches[0].share]
            sketches = sketches[: max(len(close), LEAST_LEFT)]
            most_off = TOO_FAR_OFF * sketches[0].fit.ratio
            too_far += [sketch for sketch in sketches if sketch.fit.ratio > most_off]
            sketches = [sketch for sketch in sketches if sketch.fit.ratio <= most_off]
        starts = [sketch.fit.hypothesis for sketch in sketches]
    return by_share([*sketches, *(there for sketch in too_far if (there := _as_it_is(ground, sketch)))])


REACHED = 1.1
"""Residual over noise at which the best suspect has met all its rivals, and those far behind it are dropped; not where
the model without a suspect is there too, and nothing is told."""

FAR_BEHIND = 0.5
"""A suspect whose sketch takes away less than this share of what the best one does is left out."""

LEAST_LEFT = 4
"""Suspects left by a heat at least, however far behind."""

TOO_FAR_OFF = 2.0
"""Times as far off as one that has reached the noise: what has taken so many steps and is still there takes none on
longer records, where it would crawl for longer than all others take."""


def afresh(model: Hypothesis) -> Hypothesis:
    """Where suspects are tried from: the numbers as given, unless an effect was found with the calibrated ones."""
    return model if model.effects else replace(model, values={})


def rivals(evaluator: Evaluator, base: Fit, sketches: Sequence[Sketch], registry: Registry) -> list[Hypothesis]:
    """Other kinds where the best effect sits, seen from the numbers of the rig that were fitted along with it.

    Once anything at the right place has taken most of the misfit away, the numbers are nearly right, and what differs
    is how the effect acts.

    Args:
        evaluator: the records of the sketches.
        base: the calibrated model, for its unknowns.
        sketches: the best first.
        registry: kinds to try.
    """
    position = sketches[0].effect.place.position if sketches else None
    if position is None:
        return []
    best = sketches[0].fit.hypothesis
    bare = replace(best, effects=best.effects[:-1])
    close = (s for s in sketches if s.fit.ratio < ALIKE * sketches[0].fit.ratio)
    seen = {s.effect.kind for s in close if _reaches(s.effect, position, best.rig)}
    there = _tried(evaluator, bare, concerning(base, evaluator), 0)
    if there is None:
        return []
    others = {name: kind for name, kind in registry.items() if name not in seen}
    found = promising(survey(evaluator, there, others, silent, position), 1)
    return [tried_with(evaluator, bare, suspect.effect) for suspect in found]


def _reaches(effect: Effect, position: float, rig: Rig) -> bool:
    """It acts near a position along the beam, m, or everywhere."""
    if effect.place.position is None or not isinstance(rig.structure, Beam):
        return True
    return abs(effect.place.position - position) < NEAR * rig.structure.length


ALIKE = 1.5
"""A kind whose sketch is at most this many times as far off as the best one need not be seen from there again."""


def by_share(sketches: Sequence[Sketch]) -> list[Sketch]:
    """The best first."""
    return sorted(sketches, key=lambda sketch: -sketch.share)


def apart(sketches: Sequence[Sketch]) -> list[Sketch]:
    """The sketches without those that ended where a better one of the same kind already is."""
    kept: list[Sketch] = []
    for sketch in sketches:
        if not any(is_alike(sketch.fit, other.fit) for other in kept):
            kept.append(sketch)
    return kept


def is_alike(one: Fit, other: Fit) -> bool:
    """Whether the last effects of two fits are of one kind, with the same options, in one valley, at the same place.

    Args:
        one: a fit.
        other: of the same rig.
    """
    effect, rival = one.hypothesis.effects[-1], other.hypothesis.effects[-1]
    if effect.kind != rival.kind or effect.is_variant_of(rival):
        return False
    return is_same_place(effect.place, rival.place, one.hypothesis.rig)


@dataclass(frozen=True, eq=False)
class Ground:
    """What all sketches on one part of the records share.

    Attributes:
        evaluator: that part.
        slopes: (n_unknowns, n_data) Jacobian of the model without a suspect, where the sketches begin.
        quick: that model after as few steps as a sketch takes, which its share is of.
        bare: the same followed for as many steps as a suspect that is followed.
    """

    evaluator: Evaluator
    slopes: FloatArray
    quick: Fit
    bare: Fit


def ground_of(evaluator: Evaluator, start: Hypothesis, base: Fit) -> Ground:
    """The ground of sketches that begin at ``start``.

    Args:
        evaluator: records to fit.
        start: the model without a suspect.
        base: the calibrated model, for its unknowns.
    """
    shared = concerning(base, evaluator)
    slopes = fit(evaluator, start, shared, max_iterations=0).jacobian
    quick = min(
        fit(evaluator, start, shared, max_iterations=ITERATIONS, jacobian=slopes, tolerance=TOLERANCE),
        fit(evaluator, base.hypothesis, shared, max_iterations=0, jacobian=slopes),
        key=lambda f: f.cost,
    )
    bare = fit(evaluator, quick.hypothesis, shared, max_iterations=ITERATIONS_FOLLOWED, tolerance=TOLERANCE)
    return Ground(evaluator, slopes, quick, bare)


def sketched(
    ground: Ground, suspects: Sequence[Hypothesis], *, near: bool = False, own_slopes: bool = False
) -> list[Sketch]:
    """Each suspect fitted with all unknowns, from afar first by itself; best first.

    Args:
        ground: records to fit.
        suspects: the model with one effect more each.
        near: all unknowns at once from the first.
        own_slopes: each with its own and more iterations, so that what explained the beginning is not lost farther on.
    """
    work = partial(_sketched, ground, near=near, own_slopes=own_slopes)
    found = zip(in_parallel(ground.evaluator.jobs, work, suspects), suspects, strict=True)
    return by_share([Sketch(ground.quick, one, suspect.effects[-1]) for one, suspect in found if one])


def _sketched(ground: Ground, suspect: Hypothesis, *, near: bool, own_slopes: bool) -> Fit | None:
    evaluator, own = ground.evaluator.with_jobs(1), own_unknowns(suspect)
    unknowns = (*ground.bare.unknowns, *own)
    if own_slopes:
        return _tried(evaluator, suspect, unknowns, ITERATIONS_FOLLOWED)
    if near:
        return _tried(evaluator, suspect, unknowns, ITERATIONS_NEAR, ground.slopes, keep=True)
    alone = _tried(evaluator, suspect, own, ITERATIONS_ALONE)
    return alone and _tried(evaluator, alone.hypothesis, unknowns, ITERATIONS, ground.slopes)


def _as_it_is(ground: Ground, sketch: Sketch) -> Sketch | None:
    """A sketch on these records, on longer ones without another step; None where it diverges there."""
    if sketch.base is ground.quick:
        return sketch
    found = sketch.fit.hypothesis
    unknowns = (*ground.bare.unknowns, *own_unknowns(found))
    try:
        return replace(sketch, base=ground.quick, fit=fit(ground.evaluator, found, unknowns, max_iterations=0))
    except ArithmeticError:
        return None


def grown_from_bare(ground: Ground, sketches: Sequence[Sketch]) -> list[Sketch]:
    """The sketches, best first, those that are farther off than the model without a suspect begun again from that.

    Of no size a suspect is as near as that model; a fit that ends farther off was lost on its way, with slopes from
    where it began. So it begins small beside the numbers that fit best without it, and forms its own.

    Args:
        ground: that they were fitted on.
        sketches: of the suspects.
    """
    lost = [sketch for sketch in sketches if sketch.fit.cost > ground.bare.cost]
    found = in_parallel(ground.evaluator.jobs, partial(_grown_from_bare, ground), lost)
    nearer = {old: replace(old, fit=new) for old, new in zip(lost, found, strict=True) if new}
    return by_share([nearer.get(sketch, sketch) for sketch in sketches])


def _grown_from_bare(ground: Ground, sketch: Sketch) -> Fit | None:
    """The fit of a sketch begun again, None where that ends no nearer."""
    evaluator = ground.evaluator.with_jobs(1)
    small = [tried_with(evaluator, ground.bare.hypothesis, sketch.begun.scaled(factor)) for factor in SMALL]
    rows = evaluator.residuals([(start, None) for start in small])
    left = [inf if row is None else float(row @ row) for row in rows]
    start = small[left.index(min(left))] if min(left) < sketch.fit.chi2 else sketch.fit.hypothesis
    found = _tried(evaluator, start, sketch.fit.unknowns, ITERATIONS_FOLLOWED)
    return found if found and found.cost < sketch.fit.cost else None


SMALL = (1.0, 0.1, 0.01)
"""Shares of a suspect's size of which the one that leaves least is begun again with."""


def sketched_from_calibrated(
    evaluator: Evaluator,
    there: Fit,
    starts: Sequence[Hypothesis],
    suspects: Sequence[Effect],
    registry: Registry,
    *,
    lasting: bool,
) -> list[Sketch]:
    """Each suspect, then the rivals of the best, fitted with all unknowns together on whole records; best first.

    Beside the calibrated numbers an effect grows along a narrow, curved valley, in which least squares crawls; grown
    along with the numbers as given, from the beginning of the records, it lies outside of that valley.

    Args:
        evaluator: records to fit.
        there: the calibrated model on them.
        starts: that model, or where the fits are better begun.
        suspects: effects at trial sizes.
        registry: kinds to try where the best of them sits.
        lasting: they act over the length of a record: nothing of them grows from its beginning, and they are few, so
            each is given more iterations.
    """
    grounds = [
        there if start is there.hypothesis else fit(evaluator, start, there.unknowns, max_iterations=0)
        for start in starts
    ]
    iterations = ITERATIONS_LASTING if lasting else ITERATIONS_TOGETHER
    given, alone = afresh(there.hypothesis), evaluator.with_jobs(1)
    windows = [] if lasting else [beginning(alone, share, seconds) for share, seconds, _ in HEATS]
    shorter = [fit(window, given, concerning(there, window), max_iterations=0) for window in windows]
    whole = [(alone, ground.hypothesis, Projection(ground)) for ground in grounds]
    short = [(windows[0], given, Projection(shorter[0]))] if windows else []
    begun = in_parallel(evaluator.jobs, partial(_begun, whole, short, windows, shorter), suspects)
    together = partial(_together, alone, grounds[0].jacobian, iterations)

    def sketches_from(starts: Sequence[Sequence[Hypothesis]]) -> list[Sketch]:
        unknowns = [(*there.unknowns, *own_unknowns(each[0])) for each in starts]
        all_starts = [(start, moved) for each, moved in zip(starts, unknowns, strict=True) for start in each]
        found = iter(in_parallel(evaluator.jobs, together, all_starts))
        fits = [([one for one in islice(found, len(each)) if one], each[0].effects[-1]) for each in starts]
        return [Sketch(there, min(ended, key=attrgetter("cost")), suspect) for ended, suspect in fits if ended]

    sketches = sketches_from(begun)
    others = rivals(evaluator, there, by_share(sketches), registry)[:MOST_LONG_RIVALS]
    return by_share([*sketches, *sketches_from([[rival] for rival in others])])


Start = tuple[Evaluator, Hypothesis, Projection]
"""Records, a model on them, and what its unknowns could do there as well."""


def _begun(
    whole: Sequence[Start],
    short: Sequence[Start],
    windows: Sequence[Evaluator],
    shorter: Sequence[Fit],
    suspect: Effect,
) -> list[Hypothesis]:
    """Where the fits of a suspect begin: of the best size on all records, and grown from their beginning."""
    sizes = [suspect.scaled(factor) for factor in SIZES]
    begun = [_best_size(*start, sizes) for start in whole]
    for start in short:
        begun += _grown(windows, shorter, _best_size(*start, sizes))
    return begun


def _together(
    evaluator: Evaluator, slopes: FloatArray, iterations: int, begun: tuple[Hypothesis, tuple[Unknown, ...]]
) -> Fit | None:
    """The fit from a start with all its unknowns at once; None where it diverges."""
    start, unknowns = begun
    return _tried(evaluator, start, unknowns, iterations, slopes)


def _best_size(evaluator: Evaluator, model: Hypothesis, projection: Projection, sizes: Sequence[Effect]) -> Hypothesis:
    """The model with the effect at the size that leaves least when the rig's numbers do what they can."""
    trials = [tried_with(evaluator, model, size) for size in sizes]
    rows = evaluator.residuals([(trial, None) for trial in trials])
    left = [inf if row is None else projection.left_of(row) for row in rows]
    return trials[left.index(min(left))]


def _grown(windows: Sequence[Evaluator], bare: Sequence[Fit], suspect: Hypothesis) -> list[Hypothesis]:
    """The suspect fitted by itself, then with all unknowns on ever more of the records; none where it diverges."""
    own = own_unknowns(suspect)
    found = _tried(windows[0], suspect, own, ITERATIONS_ALONE)
    for window, base in zip(windows, bare, strict=True):
        if found is not None:
            found = _tried(window, found.hypothesis, (*base.unknowns, *own), ITERATIONS, base.jacobian)
    return [] if found is None else [found.hypothesis]


def _tried(
    evaluator: Evaluator,
    start: Hypothesis,
    unknowns: Sequence[Unknown],
    iterations: int,
    jacobian: FloatArray | None = None,
    *,
    keep: bool = False,
) -> Fit | None:
    """A quick fit, or None where the model to start from diverges; slopes that it keeps follow its steps."""
    try:
        return fit(
            evaluator,
            start,
            unknowns,
            max_iterations=iterations,
            jacobian=jacobian,
            keep=keep,
            along_steps=keep,
            tolerance=TOLERANCE,
        )
    except ArithmeticError:
        return None
