"""From records to what a fit works on: noise, the predictable part, and windows that fit the time there is."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np

from identification.evaluate import Evaluator, Target, TimeTarget, carry_noise, whitened
from identification.heard_before import unjudged_of
from identification.hypothesis import Hypothesis, OffsetUnknown, StartUnknown, Unknown, own_numbers
from identification.noise import estimate_noise
from identification.rest_target import FrfTarget, ModesTarget
from models.arrays import BoolArray, FloatArray
from models.band_limit import STOP_EDGE
from models.linear import ORDER_READ
from models.modal import ModalModel, build_modal
from models.plant import Plant
from models.record import AnyRecord, FrfRecord, Record
from models.rig import quantities_of

DISTURBANCE = 1e-7
"""Relative disturbance of the excitation by whose growth the divergence of neighbouring motions is measured."""

PREDICTABLE_GROWTH = 300.0
"""Growth up to which a model whose numbers are off by a part in a thousand still follows its own path."""

TORN = 3.0
"""Times the sensors' noise that the force's noise may do beyond what is in proportion to it: where motions settle in
other sleeves, a record no longer tells of the rig, and noise taken for steady would hide the beginning, which does."""

LEAST_TORN = 0.02
"""Of a channel's rms; sensors without noise would allow nothing."""

DIVERGENCE_WINDOW = 0.25
"""Seconds over which growth is averaged."""

LASTING = 8
"""Windows over which a growth of noise has to last."""


def prepare(hypothesis: Hypothesis, records: Sequence[AnyRecord], jobs: int, rng: np.random.Generator) -> Evaluator:
    """An evaluator of the records with their noise, that of the excitation carried through the model.

    Args:
        hypothesis: the model that carries it.
        records: of any kind.
        jobs: cores.
        rng: for the realisations of the noise.

    Raises:
        InputError: FRFs with too few lines to tell their noise, or a mode that no sensor sees.
    """
    plant = hypothesis.plant()
    evaluator = Evaluator([target_of(record, plant) for record in records], jobs)
    return evaluator.with_targets(carry_noise(evaluator, hypothesis, rng))


def target_of(record: AnyRecord, plant: Plant) -> Target:
    """A record with its noise, as far as the record itself tells it, from where it tells of the plant alone."""
    if isinstance(record, Record):
        noise = estimate_noise(record)
        return TimeTarget.of(
            record, noise, unjudged_of(record, noise, plant), quantities_of(plant.sensors, record.sensors)
        )
    if isinstance(record, FrfRecord):
        return FrfTarget.of(record, quantities_of(plant.sensors, record.sensors))
    return ModesTarget.of(record)


def start_unknowns(
    hypothesis: Hypothesis, records: Sequence[Record], plant: Plant | None = None
) -> tuple[Unknown, ...]:
    """What each record has for itself: its state at the first sample where it does not start at rest, mode by mode.

    Where displacements are measured, the excitation channel's reading at rest is unknown with it: neither zero is then
    seen. Effects of the rig file may have numbers of each record's own.

    Args:
        hypothesis: the model.
        records: whose numbers are told.
        plant: as the records meet it, if it is another than the hypothesis's own.
    """
    plant, names = plant or hypothesis.plant(), [record.name for record in records]
    given = plant.effects[: len(hypothesis.rig.effects)]
    unknowns = [number for effect in given for number in own_numbers(effect, -1, names)]
    for record in records:
        if record.moving_start:
            model = build_modal(plant, STOP_EDGE * record.fs)
            scales = _state_scales(model, record)
            unknowns += [StartUnknown(i, 2 * model.n, s, record.name) for i, s in enumerate(scales) if s > 0]
            quantities = {sensor.quantity for sensor in plant.sensors if sensor.name in record.sensors}
            if record.excitation is not None and "displacement" in quantities:
                unknowns.append(OffsetUnknown(float(np.std(record.excitation)) or 1.0, record.name))
    return tuple(unknowns)


def _state_scales(model: ModalModel, record: Record) -> FloatArray:
    """(2n,) typical modal displacements and velocities; 0 for modes above the band."""
    by_name = {sensor.name: sensor for sensor in model.plant.sensors}
    lowest = 2.0 * pi / record.duration
    omega = np.maximum(model.omega, lowest)
    size, sensors = np.zeros(model.n), [by_name[name] for name in record.sensors]
    shapes = [np.abs(model.rows(each.position, 1 if each.quantity == "angular_velocity" else 0)) for each in sensors]
    largest: dict[str, float] = {}  # beside it, at the clamp, a sensor tells nothing
    for sensor, shape in zip(sensors, shapes, strict=True):
        largest[sensor.quantity] = max(largest.get(sensor.quantity, np.finfo(float).tiny), float(shape.max()))
    for sensor, shape, channel in zip(sensors, shapes, record.responses, strict=True):
        moves = np.maximum(shape, 0.1 * largest[sensor.quantity]) * omega ** ORDER_READ[sensor.quantity]
        size = np.maximum(size, float(np.std(channel)) / moves)
    size[model.omega > 2.0 * pi * STOP_EDGE * record.fs] = 0.0
    return np.concatenate([size, size * omega])


RESOLVED = 0.25
"""Discretisation error, as a share of the noise, that a fit does not see."""


def resolved(evaluator: Evaluator, hypothesis: Hypothesis, misfit: float = 1.0) -> Evaluator:
    """The evaluator with as many steps per sample as keep the stepping error well below the noise.

    Args:
        evaluator: with the records to judge on.
        hypothesis: the model whose steps are halved until nothing changes.
        misfit: residual over noise of which the error is to stay a small share, where it is more than the noise.
    """
    while evaluator.timed:
        finer = replace(evaluator.settings, times=2 * evaluator.settings.times)
        coarse, fine = evaluator.responses(hypothesis), evaluator.responses(hypothesis, finer)
        error = 0.0
        for target, one, other in zip(evaluator.timed, coarse, fine, strict=True):
            change = whitened(target.spectrum(one.channels - other.channels), target)
            error = max(error, float(np.sqrt(np.mean(change**2))))
        if error * COARSE_SHARE < RESOLVED * max(1.0, misfit):
            return evaluator
        evaluator = evaluator.with_settings(finer)
    return evaluator


COARSE_SHARE = 4.0 / 3.0
"""Error of a second-order method over its change when the step is halved."""


@dataclass(frozen=True)
class Horizon:
    """How long a record can be predicted.

    Attributes:
        record: name.
        growth: of a small disturbance over the record, relative to the disturbance.
        seconds: until which the growth stays below ``PREDICTABLE_GROWTH`` and what noise tears apart below ``TORN``.
        torn: largest rms, as a share of the channels', of what the force's noise does out of proportion.
    """

    record: str
    growth: float
    seconds: float
    torn: float = 0.0

    @property
    def in_words(self) -> str:
        """Why no more of the record is used."""
        return (
            f"{self.record}: neighbouring motions part by a factor of {self.growth:.0e}, and the force's "
            f"noise tears them apart by {self.torn:.1%}; only the first {self.seconds:.2f} s are used to fit"
        )


def horizons(evaluator: Evaluator, hypothesis: Hypothesis) -> list[Horizon]:
    """Divergence of neighbouring motions in every time record, by simulating it beside two others.

    One is disturbed so little, in its force and in its state at the start, that the motions part as the tangent says,
    two by noise as large as the force's, once with the other sign: in proportion to the noise, their mean would be the
    motion without it.
    """
    rng = np.random.default_rng(0)
    pushes = [
        None if t.driven.excitation is None else t.noise.excitation * rng.standard_normal(t.driven.n_samples)
        for t in evaluator.timed
    ]
    runs = [evaluator.responses(hypothesis)] if evaluator.timed else []
    nearby = [t.disturbed(DISTURBANCE) for t in evaluator.timed]
    moved = {name: start * (1.0 + DISTURBANCE) for name, start in hypothesis.starts.items()}
    disturbed = [(nearby, replace(hypothesis, starts=moved))]
    for sign in (1.0, -1.0):
        pairs = zip(evaluator.timed, pushes, strict=True)
        disturbed.append(([t.driven_by(_pushed(t.driven, push, sign)) for t, push in pairs], hypothesis))
    runs += [evaluator.with_targets(targets).responses(model) for targets, model in disturbed if targets]
    return [
        _horizon(target, *(response.channels for response in responses))
        for target, *responses in zip(evaluator.timed, *runs, strict=True)
    ]


def _pushed(record: Record, push: FloatArray | None, sign: float) -> Record:
    if record.excitation is None or push is None:
        return record
    return replace(record, excitation=record.excitation + sign * push)


def _horizon(target: TimeTarget, one: FloatArray, nearby: FloatArray, up: FloatArray, down: FloatArray) -> Horizon:
    record = target.record
    width = max(1, min(int(DIVERGENCE_WINDOW * record.fs), one.shape[1]))
    growth = _apart(one, nearby, width) / DISTURBANCE
    torn = _apart(one, 0.5 * (up + down), width)
    own = one.std(axis=1)
    moves = own > 0.0
    heard = float(np.sqrt(np.mean((target.noise.sensors[moves] / own[moves]) ** 2))) if moves.any() else 0.0
    allowed = max(TORN * heard, LEAST_TORN)
    beyond = np.flatnonzero((growth > PREDICTABLE_GROWTH) | _stays(torn > allowed))
    seconds = record.duration if len(beyond) == 0 else max(2, int(beyond[0])) * width / record.fs
    return Horizon(record.name, float(growth.max()), seconds, float(torn.max()))


def _stays(loud: BoolArray) -> BoolArray:
    """Windows with which most of the next ones are loud: where a sleeve was just missed, motions meet again."""
    padded = np.append(loud, np.repeat(loud[-1:], LASTING - 1))
    return np.asarray(loud & (np.convolve(padded, np.ones(LASTING), "valid") > 0.5 * LASTING))


def _apart(one: FloatArray, other: FloatArray, width: int) -> FloatArray:
    """(n_windows,) how far two motions are apart in each window, as a share of the first."""
    scale = one.std(axis=1, keepdims=True) + np.finfo(float).tiny
    n = one.shape[1] // width
    apart = ((one - other) / scale)[:, : n * width].reshape(len(one), n, width)
    return np.asarray(np.sqrt(np.mean(apart**2, axis=(0, 2))))


def cut_to(
    evaluator: Evaluator, seconds: float, limits: Sequence[Horizon], most_records: int | None = None
) -> Evaluator:
    """The first part of the time records, ``seconds`` in all, none beyond its horizon, and the others whole.

    Args:
        evaluator: with all records.
        seconds: of all time records together.
        limits: horizons, in the order of the time records.
        most_records: keep only so many of them, the loudest, the quietest, and those between.
    """
    loud = levels([target.record for target in evaluator.timed])
    pairs = sorted(zip(evaluator.timed, limits, strict=True), key=lambda pair: -loud[pair[0].record.name])
    if most_records is not None and len(pairs) > most_records:
        chosen = np.unique(np.linspace(0, len(pairs) - 1, most_records).round().astype(int))
        pairs = [pairs[i] for i in chosen]
    kept: list[Target] = [*evaluator.at_rest]
    left, remaining = seconds, len(pairs)
    for target, limit in sorted(pairs, key=lambda pair: min(pair[1].seconds, pair[0].record.duration)):
        share = min(left / remaining, limit.seconds, target.record.duration)
        kept.append(target.cut_quickly(max(MIN_SAMPLES, round(share * target.record.fs))))
        left, remaining = left - share, remaining - 1
    return evaluator.with_targets(kept)


MIN_SAMPLES = 256


def followed_long(evaluator: Evaluator, seconds: float, limits: Sequence[Horizon]) -> tuple[Evaluator, list[Horizon]]:
    """The time records that can be followed for long, and their horizons: what acts over time shows in none that tears.

    Args:
        evaluator: with all records.
        seconds: no more are asked for.
        limits: horizons, in the order of the time records.
    """
    pairs = list(zip(evaluator.timed, limits, strict=True))
    followed = [min(seconds, limit.seconds, target.record.duration) for target, limit in pairs]
    kept = [pair for pair, lasts in zip(pairs, followed, strict=True) if lasts >= LONG * max(followed)]
    return evaluator.with_targets([*evaluator.at_rest, *(target for target, _ in kept)]), [limit for _, limit in kept]


LONG = 0.5
"""Share of the longest."""


def level(record: Record) -> float:
    """Rms of the excitation, or of the response where there is none."""
    signal = record.responses if record.excitation is None else record.excitation
    return float(np.sqrt(np.mean(signal**2)))


def levels(records: Sequence[Record]) -> dict[str, float]:
    """How loud each record is beside the others, by name: its level, or where some have no excitation their response.

    Args:
        records: of which each sensor's rms is taken as a share of its largest.
    """
    if len({record.excitation is None for record in records}) < 2:
        return {record.name: level(record) for record in records}
    rms = [dict(zip(record.sensors, record.responses.std(axis=1).tolist(), strict=True)) for record in records]
    largest = {name: max(row.get(name, 0.0) for row in rms) or 1.0 for row in rms for name in row}
    shares = [[size / largest[name] for name, size in row.items()] for row in rms]
    return {record.name: float(np.median(row)) for record, row in zip(records, shares, strict=True)}
