"""Contradictions of a calibration as sentences."""

from collections.abc import Sequence
from math import ceil, log10

import numpy as np

from identification.consistency.finding import CalibrationFinding, What
from identification.consistency.held_out import HeldOut
from identification.consistency.modes import LOW_MODES, Missed, ModeBands
from identification.consistency.own_values import OwnValues
from identification.evaluate import Target
from identification.hypothesis import LARGEST_SIGMA, RigUnknown
from models.arrays import FloatArray, IntArray
from models.record import Record

LEVEL_UNITS = {"force": "N", "acceleration": "m/s^2", "velocity": "m/s", "displacement": "m"}
"""Unit of a level, by what the excitation is, whether at a point or at the base."""

LEVELS_APART = 1.2
"""Records whose largest level is less than so many times the smallest are told by their names."""

MOST_VALUES = 4
"""Values in a sentence at most, the first and the last among them."""

MOST_SIGMAS = 50.0
"""Standard deviations beyond which a significance is told as more than this."""


def left_tolerance(unknown: RigUnknown, x: float, std: float, strained: float, sigma: float) -> CalibrationFinding:
    """A number that the calibration took out of its tolerance.

    Args:
        unknown: the number.
        x: its distance, in tolerances.
        std: in tolerances.
        strained: distance from which the fit was held back.
        sigma: significance.
    """
    about = unknown.parameter
    value = about.value * float(np.exp(x * about.tolerance))
    held = ", where the fit held it back" if abs(x) >= strained else ""
    return CalibrationFinding(
        "tolerance",
        about.path,
        ("calibrated",),
        (value,),
        (std * about.tolerance * value,),
        about.unit,
        sigma,
        f"{about.label} left its tolerance of {about.tolerance:.2g}: calibrated to {_number(value)} {about.unit}, "
        f"given {_number(about.value)}; {x:+.1f} standard deviations of what its owner knows{held}",
    )


def between_records(
    unknown: RigUnknown, own: OwnValues, others: Sequence[str], targets: Sequence[Target], quantity: str
) -> CalibrationFinding:
    """A number that records do not agree on, by their levels where these differ.

    Args:
        unknown: the number.
        own: its values, a group a record.
        others: labels of numbers that would explain nearly as much.
        targets: the records.
        quantity: of the rig's excitation.
    """
    records = [targets[group].record for group in own.groups]
    levels = np.array([_level(record) for record in records])
    if np.isfinite(levels).all() and levels.max() > LEVELS_APART * levels.min():
        order = np.argsort(levels, kind="stable")
        unit = LEVEL_UNITS[quantity.removeprefix("base_")]
        where = tuple(f"at {levels[k]:.3g} {unit}" for k in order)
        return _drift("records", unknown, own, order, where, _trend(own.x[order], "with the level") + _or(others))
    order = np.arange(len(records))
    return _drift("records", unknown, own, order, tuple(f"in {record.name}" for record in records), _or(others))


def between_times(unknown: RigUnknown, own: OwnValues, others: Sequence[str], target: Target) -> CalibrationFinding:
    """A number that changes within a record.

    Args:
        unknown: the number.
        own: early and late.
        others: labels of numbers that would explain nearly as much.
        target: the record.
    """
    record = target.record
    decays = isinstance(record, Record) and record.excitation is None
    trend = _trend(own.x, "with time, or with the amplitude as it dies away" if decays else "with time")
    where = (f"early in {record.name}", f"late in {record.name}")
    return _drift("times", unknown, own, np.arange(2), where, trend + _or(others))


def between_modes(unknown: RigUnknown, own: OwnValues, others: Sequence[str], bands: ModeBands) -> CalibrationFinding:
    """A number that low and high modes do not agree on.

    Args:
        unknown: the number.
        own: low and high.
        others: labels of numbers that would explain nearly as much.
        bands: of the modes.
    """
    where = (f"from modes 1 to {LOW_MODES} (below {bands.edge:.3g} Hz)", "from those above")
    return _drift("modes", unknown, own, np.arange(2), where, _or(others))


def modes_missed(missed: Missed) -> CalibrationFinding:
    """Modes that the model meets worse than the first four.

    Args:
        missed: which, and by how much.
    """
    named = f"{'modes' if len(missed.modes) > 1 else 'mode'} {', '.join(map(str, missed.modes))}"
    first = f"modes 1 to {LOW_MODES}"
    words = (
        f"{first} are met to {missed.low:.2g} times the noise, {named} only to {missed.beyond:.2g} times "
        f"({_sigmas(missed.sigma)} sigma beyond the doubt about the noise)"
    )
    return CalibrationFinding("modes", "", (first, named), (missed.low, missed.beyond), (), "-", missed.sigma, words)


def record_apart(held: HeldOut, target: Target, sigma: float) -> CalibrationFinding:
    """A record that the numbers of the others do not predict.

    Args:
        held: the record against the others.
        target: the record.
        sigma: significance.
    """
    name = target.record.name
    where = ("the other records", f"{name}, fitted with them", f"{name}, held out")
    words = (
        f"{name} held out: numbers from the other records leave {held.predicted:.3g} times its noise there and "
        f"{held.others:.3g} times in the others; fitted with them {held.fitted:.3g} ({_sigmas(sigma)} sigma)"
    )
    values = (held.others, held.fitted, held.predicted)
    return CalibrationFinding("record apart", "", where, values, (), "-", sigma, words)


def _drift(
    what: What, unknown: RigUnknown, own: OwnValues, order: IntArray, where: tuple[str, ...], trend: str
) -> CalibrationFinding:
    about = unknown.parameter
    bounded = np.clip(own.x[order], -FARTHEST, FARTHEST)
    values = about.value * np.exp(bounded * about.tolerance)
    stds = values * about.tolerance * own.std[order]
    shown = range(len(values))
    if len(values) > MOST_VALUES:
        shown = np.unique(np.round(np.linspace(0, len(values) - 1, MOST_VALUES)).astype(int)).tolist()
    told = ", ".join(
        f"{'beyond ' if abs(own.x[order][k]) > FARTHEST else ''}{_number(values[k], stds[k])} {where[k]}" for k in shown
    )
    unit = "" if about.unit in ("", "-") else f", {about.unit}"
    words = f"{about.label}{unit}: {told} ({_sigmas(own.sigma)} sigma){trend}"
    return CalibrationFinding(
        what, about.path, where, tuple(values.tolist()), tuple(stds.tolist()), about.unit, own.sigma, words
    )


FARTHEST = 3.0 * LARGEST_SIGMA
"""Tolerances beyond which a linear step tells a direction and no value."""


def _trend(x: FloatArray, along: str) -> str:
    steps = np.diff(x)
    if np.all(steps > 0):
        return f": it grows {along}"
    return f": it falls {along}" if np.all(steps < 0) else ""


def _level(record: object) -> float:
    """Rms of a record's excitation; not a number where there is none."""
    if not isinstance(record, Record) or record.excitation is None:
        return float("nan")
    return float(np.sqrt(np.mean(record.excitation**2)))


def _or(others: Sequence[str]) -> str:
    """Numbers that explain nearly as much."""
    return f"; a drift of {' or '.join(others)} would explain nearly as much" if others else ""


def _number(value: float, std: float = 0.0) -> str:
    """Four digits, and more where the standard deviation reaches further."""
    digits = 4 if not 0.0 < std < abs(value) else min(max(4, 2 + ceil(log10(abs(value) / std))), MOST_DIGITS)
    mantissa, _, power = f"{value:.{digits}g}".partition("e")
    return f"{mantissa}e{int(power)}" if power else mantissa


MOST_DIGITS = 7


def _sigmas(sigma: float) -> str:
    return f"more than {MOST_SIGMAS:g}" if sigma > MOST_SIGMAS else f"{sigma:.2g}"
