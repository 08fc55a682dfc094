"""What the force at a place follows: displacement, velocity, acceleration, or time, by statistics alone.

The force is laid on additive functions of each quantity, broken lines between knots, by least squares; what counts is
what they predict in blocks of time that were kept aside. The functions go through the band in which the force is told.

Source: T. J. Hastie, R. J. Tibshirani, Generalized Additive Models (1990), chapters 4 and 5; M. Stone, J. R. Stat. Soc.
B 36 (1974) 111 (cross-validation).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from scipy.signal import hilbert

from identification.locating.columns import TOLD, Columns, Motion, predicted
from identification.locating.courses import course_of
from identification.locating.located import Curve, PlacedForce, Shape
from identification.locating.reading import Facts, is_worth, reading
from models.arrays import FloatArray

KNOTS = 13
"""Of a function of one quantity, at equal shares of the samples, and the largest values."""

COARSE_KNOTS = (0.0, 0.03, 0.2, 0.5, 0.8, 0.97, 1.0)
"""Shares of the samples below the knots along each axis of a function of two."""

BINS = 24

QUANTITIES = ("displacement", "velocity", "acceleration")


def shape_of(forces: Sequence[PlacedForce], centre: float | None = None) -> Shape | None:
    """The shape of the force, all records together; None where no force is told.

    Args:
        forces: at one place, one a record.
        centre: of the place's sleeve, m; by default where the beam is in the mean.
    """
    heard = [force for force in forces if np.any(force.told > TOLD)]
    if not heard:
        return None
    middle = float(np.mean([force.q.mean() for force in heard])) if centre is None else centre
    records = [Motion.of(force, middle) for force in heard]
    bases = {name: _columns(records, name) for name in QUANTITIES}
    explained = {name: predicted(basis) for name, basis in bases.items()}
    chosen = _chosen(bases, explained)
    fitted = _joined([bases[name] for name in chosen])
    together = predicted(fitted)
    if len(chosen) > 1:
        explained[" and ".join(chosen)] = together
    ramp = [np.linspace(-1.0, 1.0, motion.n)[:, None] for motion in records]
    surface = _surface(records)
    both = predicted(surface)
    steady = surface if is_worth(together, both) else fitted
    grown = _joined([steady, steady.times(ramp)])
    facts = Facts(
        explained=explained,
        chosen=tuple(chosen),
        together=together,
        surface=both,
        growing=predicted(grown),
        trend=_trend(grown),
        power=_power(records, chosen[0]),
        courses={name: course_of(_alone(bases, chosen, name), name) for name in chosen},
    )
    parts, misses = _parts(bases, chosen)
    filled = [np.sum(rows, axis=0) + miss for *rows, miss in zip(*parts.values(), misses, strict=True)]
    samples = tuple(replace(force, force=row - row.mean()) for force, row in zip(heard, filled, strict=True))
    curves = tuple(_curve(name, records, parts.get(name), misses, filled) for name in QUANTITIES)
    return Shape(tuple(explained.items()), reading(facts), (*curves, *_sizes_over(records, samples)), samples, middle)


def _columns(records: Sequence[Motion], name: str) -> Columns:
    """Functions of one quantity, whose values in all records say where knots are."""
    return Columns.of(records, _hats_of([record.signals[name] for record in records]))


def _hats_of(x: Sequence[FloatArray]) -> list[FloatArray]:
    knots = _knots(np.concatenate(list(x)), KNOTS)
    return [_hats(each, knots) for each in x]


def _knots(x: FloatArray, n: int) -> FloatArray:
    inner = np.quantile(x, np.concatenate([[0.0, 0.005], np.linspace(0.03, 0.97, n - 4), [0.995, 1.0]]))
    return np.unique(inner)


def _hats(x: FloatArray, knots: FloatArray) -> FloatArray:
    """(N, n_knots) broken lines, 1 at one knot and 0 at the others."""
    return np.stack([np.interp(x, knots, row) for row in np.eye(len(knots))], axis=1)


def _surface(records: Sequence[Motion]) -> Columns:
    """Functions of displacement and velocity together."""
    q, v = ([record.signals[name] for record in records] for name in QUANTITIES[:2])
    knots = [np.unique(np.quantile(np.concatenate(rows), COARSE_KNOTS)) for rows in (q, v)]
    raw = [
        (_hats(one, knots[0])[:, :, None] * _hats(other, knots[1])[:, None, :]).reshape(len(one), -1)
        for one, other in zip(q, v, strict=True)
    ]
    return Columns.of(records, raw)


def _joined(several: Sequence[Columns]) -> Columns:
    first = several[0]
    raw, told = (
        [np.concatenate(rows, axis=1) for rows in zip(*both, strict=True)]
        for both in ([each.raw for each in several], [each.told for each in several])
    )
    return Columns(raw, told, first.target, first.records)


def _chosen(bases: Mapping[str, Columns], explained: Mapping[str, float]) -> list[str]:
    """The quantities that are worth telling, the best first."""
    chosen = [max(explained, key=lambda name: explained[name])]
    now = explained[chosen[0]]
    while len(chosen) < len(bases):
        names = [name for name in bases if name not in chosen]
        rest = {name: predicted(_joined([bases[each] for each in (*chosen, name)])) for name in names}
        best = max(rest, key=lambda name: rest[name])
        if not is_worth(now, rest[best]):
            break
        chosen.append(best)
        now = rest[best]
    return chosen


def _alone(bases: Mapping[str, Columns], chosen: Sequence[str], name: str) -> Columns:
    """Functions of one quantity, for what the other quantities leave of the force."""
    own, others = bases[name], [bases[other] for other in chosen if other != name]
    if not others:
        return own
    weights = _joined([own, *others]).weights[own.raw[0].shape[1] :]
    told = _joined(others).told
    return replace(own, target=[y - x @ weights for x, y in zip(told, own.target, strict=True)])


def _trend(grown: Columns) -> float:
    """By what factor the force at the same motion has grown from the beginning of a record to its end."""
    weights = grown.weights
    half = len(weights) // 2
    base = np.concatenate([x[:, :half] @ weights[:half] for x in grown.raw])
    rise = np.concatenate([x[:, :half] @ weights[half:] for x in grown.raw])
    slope = float(base @ rise) / max(float(base @ base), np.finfo(float).tiny)
    return (1.0 + slope) / (1.0 - slope) if abs(slope) < 1.0 else float("inf")


def _power(records: Sequence[Motion], name: str) -> float:
    """The exponent with which the force's size grows with that of the quantity, from window to window."""
    x, y = (
        np.log(np.concatenate([_sizes(row) for row in rows]))
        for rows in (
            [record.told(record.signals[name][:, None])[:, 0] for record in records],
            [r.force for r in records],
        )
    )
    kept = x > x.max() - DECADES
    if np.ptp(x[kept]) < LEAST_RANGE:
        return float("nan")
    return float(np.polyfit(x[kept], y[kept], 1)[0])


def _sizes(signal: FloatArray) -> FloatArray:
    parts = np.array_split(signal, WINDOWS)
    return np.array([max(float(part.std()), np.finfo(float).tiny) for part in parts])


WINDOWS = 24
"""Of each record, in which sizes are compared."""

DECADES, LEAST_RANGE = np.log(30.0), np.log(1.6)
"""Range of amplitudes that are compared, and that at which an exponent means something."""


def _parts(bases: Mapping[str, Columns], chosen: Sequence[str]) -> tuple[dict[str, list[FloatArray]], list[FloatArray]]:
    """What follows each chosen quantity in each record, N, in all bands, and what is missed of the told ones."""
    fitted, end, parts = _joined([bases[name] for name in chosen]), 0, {}
    weights = fitted.weights
    for name in chosen:
        start, end = end, end + bases[name].raw[0].shape[1]
        parts[name] = [x @ weights[start:end] for x in bases[name].raw]
    rows = zip(fitted.told, fitted.target, fitted.records, strict=True)
    return parts, [(y - x @ weights) * record.rms for x, y, record in rows]


def _curve(
    name: str,
    records: Sequence[Motion],
    part: list[FloatArray] | None,
    misses: Sequence[FloatArray],
    filled: Sequence[FloatArray],
) -> Curve:
    """Binned means over a quantity: of what follows it and what is missed, or of all where nothing follows it."""
    y = filled if part is None else [own + miss for own, miss in zip(part, misses, strict=True)]
    return _binned(name, np.concatenate([record.signals[name] for record in records]), np.concatenate(list(y)))


def _sizes_over(records: Sequence[Motion], samples: Sequence[PlacedForce]) -> tuple[Curve, Curve]:
    """The force's size over time and over the amplitude of the displacement."""
    size = np.abs(np.concatenate([sample.force for sample in samples]))
    swing = [record.signals["displacement"] for record in records]
    amplitude = np.concatenate([np.abs(hilbert(row - row.mean())) for row in swing])
    return (
        _binned("time", np.concatenate([sample.time for sample in samples]), size),
        _binned("amplitude", amplitude, size),
    )


def _binned(of: str, x: FloatArray, y: FloatArray) -> Curve:
    """Means over bins of equal width between the outer thousandths, with their standard errors."""
    low, high = np.quantile(x, [0.001, 0.999])
    edges = np.linspace(float(low), float(high), BINS + 1)
    index = np.digitize(x, edges[1:-1])
    count = np.bincount(index, minlength=BINS).astype(float)
    kept = count >= LEAST_SAMPLES
    with np.errstate(invalid="ignore", divide="ignore"):
        centre, mean = (np.bincount(index, row, BINS) / count for row in (x, y))
        variance = np.bincount(index, y**2, BINS) / count - mean**2
        error = np.sqrt(np.maximum(variance, 0.0) / (count / CORRELATED))
    return Curve(of, centre[kept], mean[kept], error[kept])


LEAST_SAMPLES, CORRELATED = 20, 4.0
"""In a bin; samples of a band-limited signal that tell as much as one of white noise, roughly."""
