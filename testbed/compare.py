"""A model against records of any kind: time histories, FRFs, mode shapes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from identification.assess import score, with_starts
from identification.at_rest import PairedModes, paired_modes, predicted_frfs
from identification.frf import estimate_frf
from identification.hypothesis import Hypothesis
from identification.noise import MIN_SAMPLES, MIN_SENSORS
from identification.prepare import LEAST_TORN, Horizon, horizons, prepare
from identification.result import RecordScore, Score
from identification.together import wholly_off
from models.arrays import ComplexArray, FloatArray
from models.band_limit import SCORE_EDGE
from models.record import AnyRecord, FrfRecord, ModeShapeRecord, Record
from models.rig import Sensor

SEGMENTS_PER_RECORD = 8.0
"""Segments without overlap into which a record is cut for its FRFs, where its excitation does not repeat."""

LEAST_COHERENCE = 0.5
"""Lines at which no sensor is coherent with the excitation to this degree were not excited and carry no FRF."""


@dataclass(frozen=True, eq=False)
class FrfPair:
    """Measured and predicted FRFs on the same lines.

    Attributes:
        record: name.
        sensors: names, in the order of the rows.
        frequency: (n_freq,) Hz.
        measured, predicted: (n_sensors, n_freq) SI.
        coherence: (n_sensors, n_freq) of the measurement, None where the file holds FRFs alone.
    """

    record: str
    sensors: tuple[str, ...]
    frequency: FloatArray
    measured: ComplexArray
    predicted: ComplexArray
    coherence: FloatArray | None


@dataclass(frozen=True, eq=False)
class ModePair:
    """Measured modes beside the model's, each with the one that is most like it.

    Attributes:
        record: name.
        measured_freqs, model_freqs: (n,) Hz; NaN where the model has no mode left.
        measured_damping, model_damping: (n,) ratios; the measured ones None where the file has none.
        mac: (n,) modal assurance criterion of each pair.
    """

    record: str
    measured_freqs: FloatArray
    model_freqs: FloatArray
    measured_damping: FloatArray | None
    model_damping: FloatArray
    mac: FloatArray


@dataclass(frozen=True, eq=False)
class Comparison:
    """One model against several records.

    Attributes:
        score: of the time records, None without any.
        frfs: one a time record with measured excitation, from its own channels, then one a record of FRFs.
        modes: one a record of mode shapes.
        sensors: of the rig.
        findings: sentences on records whose channels are all off alike, and on those that no model can follow.
    """

    score: Score | None
    frfs: tuple[FrfPair, ...]
    modes: tuple[ModePair, ...]
    sensors: tuple[Sensor, ...]
    findings: tuple[str, ...] = ()


def compare(hypothesis: Hypothesis, records: Sequence[AnyRecord], *, seed: int = 0, jobs: int = 2) -> Comparison:
    """Predict every record and hold the prediction against it.

    Args:
        hypothesis: the model.
        records: of any kind.
        seed: of the noise that is carried through the model.
        jobs: cores.

    Raises:
        InputError: a record that does not fit the rig.
        ArithmeticError: the motion left the finite numbers.
    """
    in_time = [record for record in records if isinstance(record, Record)]
    score, findings = _in_time(hypothesis, in_time, jobs, seed) if in_time else (None, ())
    return Comparison(
        score,
        (
            *(score_frfs(score) if score is not None else ()),
            *(_rest_frf_pair(hypothesis, record) for record in records if isinstance(record, FrfRecord)),
        ),
        tuple(
            mode_pair(record, paired_modes(hypothesis, record))
            for record in records
            if isinstance(record, ModeShapeRecord)
        ),
        hypothesis.rig.sensors,
        findings,
    )


def _in_time(hypothesis: Hypothesis, records: Sequence[Record], jobs: int, seed: int) -> tuple[Score, tuple[str, ...]]:
    """The errors of time records, and what must be known to read them."""
    evaluator = prepare(hypothesis, records, jobs, np.random.default_rng(seed))
    known = with_starts(evaluator, hypothesis)
    found = score(evaluator, known)
    bounds = [_only_a_bound(row) for row in found.records if row.noise.at_most and row.noise_nrmse > SENSORS_OWN]
    loud = {row.record.name: row for row in found.records if row.noise_nrmse > RATTLING}
    limits = horizons(evaluator, known) if loud else []
    torn = [limit for limit in limits if limit.record in loud and limit.torn > LEAST_TORN]
    parted = [limit for limit in torn if limit.seconds < loud[limit.record].record.duration]
    return found, (*wholly_off(found), *bounds, *(_in_words(limit, loud[limit.record]) for limit in parted))


SENSORS_OWN = 0.005
"""Noise, as a share of the motion, below which a good sensor's may as well be told from its quietest bands."""


def _only_a_bound(row: RecordScore) -> str:
    """That a record's noise may be far lower than told, and what would tell it."""
    return (
        f"{row.record.name}: its sensors' noise, {row.noise_nrmse:.2g} of the motion, is a bound from above: too few "
        f"sensors or samples, and nothing that repeats, so it was told from {row.noise.method}, where the structure "
        f"may move, too; {MIN_SENSORS} sensors and {MIN_SAMPLES} samples, or three periods of a multisine, tell it"
    )


RATTLING = 0.1
"""Noise, as a share of the motion, from which it is asked whether motions part."""


def _in_words(limit: Horizon, row: RecordScore) -> str:
    """That a record's noise is what the force's does to a motion that nobody can follow to its end."""
    return (
        f"{limit.record}: noise alone is {row.noise_nrmse:.2f} of the motion, since the noise of the force tears "
        f"neighbouring motions of this model apart, by {limit.torn:.0%} of it; it can be compared for its first "
        f"{limit.seconds:.2g} s"
    )


def score_frfs(score: Score) -> tuple[FrfPair, ...]:
    """FRFs of the measured and the predicted channels on the excited lines below 0.35 fs; a free decay has none.

    Args:
        score: finished.
    """
    return tuple(_estimated(row) for row in score.records if row.record.excitation is not None)


def _estimated(row: RecordScore) -> FrfPair:
    record = row.record
    assert record.excitation is not None
    # A sensor at the clamp is predicted to stand still, and its FRF is 0.
    moving = np.ptp(row.predicted, axis=1) > 0
    estimate = estimate_frf(
        record.excitation,
        record.responses,
        record.fs,
        resolution=SEGMENTS_PER_RECORD / record.duration,
        besides=row.predicted[moving],
    )
    n = len(record.sensors)
    in_band = estimate.frequency <= SCORE_EDGE * record.fs
    excited = in_band & (estimate.coherence[:n].max(axis=0) >= LEAST_COHERENCE)
    lines = excited if excited.any() else in_band
    predicted = np.zeros((n, int(lines.sum())), complex)
    predicted[moving] = estimate.h1[n:, lines]
    coherence = estimate.coherence[:n, lines]
    return FrfPair(record.name, record.sensors, estimate.frequency[lines], estimate.h1[:n, lines], predicted, coherence)


def frf_pair(record: FrfRecord, predicted: ComplexArray) -> FrfPair:
    """Measured FRFs beside predicted ones.

    Args:
        record: above 0 Hz.
        predicted: (n_sensors, n) SI.
    """
    return FrfPair(record.name, record.sensors, record.frequency, record.values, predicted, record.coherence)


def _rest_frf_pair(hypothesis: Hypothesis, record: FrfRecord) -> FrfPair:
    above = record.above_0_hz()
    return frf_pair(above, predicted_frfs(hypothesis, above))


def mode_pair(record: ModeShapeRecord, modes: PairedModes) -> ModePair:
    """Measured modes beside those of a model.

    Args:
        record: the mode shapes.
        modes: each with the measured one that it is most like.
    """
    freqs, damping = modes.natural_freqs, modes.damping_ratios
    return ModePair(record.name, record.natural_freqs, freqs, record.damping_ratios, damping, modes.mac)
