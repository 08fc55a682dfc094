"""A model against records of any kind: time histories, FRFs, mode shapes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import linear_sum_assignment

from identification.assess import assess
from identification.frf import estimate_frf
from identification.hypothesis import Hypothesis
from identification.result import RecordScore, Score
from models.arrays import ComplexArray, FloatArray
from models.band_limit import SCORE_EDGE
from models.linear import Linearised, frf, linearised, measurement_chain, natural_modes
from models.modal import build_modal
from models.record import AnyRecord, FrfRecord, ModeShapeRecord, Record
from testbed.metrics import mac

SEGMENTS_PER_RECORD = 8.0
"""Segments without overlap into which a record is cut for its FRFs, where its excitation does not repeat."""

LEAST_COHERENCE = 0.5
"""Lines at which no sensor is coherent with the excitation to this degree were not excited and carry no FRF."""

MODES_BEYOND = 1.5
"""The model's modes are looked for up to this many times the highest measured natural frequency."""


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
    """

    score: Score | None
    frfs: tuple[FrfPair, ...]
    modes: tuple[ModePair, ...]


def compare(hypothesis: Hypothesis, records: Sequence[AnyRecord], *, seed: int = 0, jobs: int = 2) -> Comparison:
    """Predict every record and hold the prediction against it.

    Args:
        hypothesis: the model.
        records: of any kind.
        seed: of the noise that is carried through the model.
        jobs: threads.

    Raises:
        InputError: a record that does not fit the rig.
        ArithmeticError: the motion left the finite numbers.
    """
    in_time = [record for record in records if isinstance(record, Record)]
    score = assess(hypothesis, in_time, jobs=jobs, seed=seed) if in_time else None
    return Comparison(
        score,
        (
            *(score_frfs(score) if score is not None else ()),
            *(frf_pair(hypothesis, record) for record in records if isinstance(record, FrfRecord)),
        ),
        tuple(mode_pair(hypothesis, record) for record in records if isinstance(record, ModeShapeRecord)),
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
    channels = np.vstack([record.responses, row.predicted[moving]])
    estimate = estimate_frf(record.excitation, channels, record.fs, resolution=SEGMENTS_PER_RECORD / record.duration)
    n = len(record.sensors)
    in_band = estimate.frequency <= SCORE_EDGE * record.fs
    excited = in_band & (estimate.coherence[:n].max(axis=0) >= LEAST_COHERENCE)
    lines = excited if excited.any() else in_band
    predicted = np.zeros((n, int(lines.sum())), complex)
    predicted[moving] = estimate.h1[n:, lines]
    coherence = estimate.coherence[:n, lines]
    return FrfPair(record.name, record.sensors, estimate.frequency[lines], estimate.h1[:n, lines], predicted, coherence)


def frf_pair(hypothesis: Hypothesis, record: FrfRecord) -> FrfPair:
    """Measured FRFs beside those of the model linearised at rest, above 0 Hz.

    Args:
        hypothesis: the model.
        record: the FRFs.

    Raises:
        InputError: the rig has no excitation.
    """
    lines = record.frequency > 0
    frequency = record.frequency[lines]
    linear = _linear(hypothesis, float(frequency.max()), record.excitation_position)
    predicted = frf(linear, frequency, record.sensors)
    return FrfPair(record.name, record.sensors, frequency, record.values[:, lines], predicted, None)


def mode_pair(hypothesis: Hypothesis, record: ModeShapeRecord) -> ModePair:
    """Measured modes beside those of the model linearised at rest, paired so that frequencies and shapes agree best.

    Args:
        hypothesis: the model.
        record: the mode shapes.
    """
    highest = MODES_BEYOND * float(record.natural_freqs.max())
    linear = _linear(hypothesis, highest, None)
    named = {sensor.name: sensor for sensor in linear.model.plant.sensors}
    modes = natural_modes(linear, [named[name] for name in record.sensors], highest)
    read = modes.shapes * measurement_chain(linear.model.plant, record.sensors, modes.natural_freqs).T
    likeness = mac(read, record.shapes)
    apart = np.abs(np.log(modes.natural_freqs[:, None] / record.natural_freqs[None, :]))
    model, measured = linear_sum_assignment(1.0 - likeness + apart)
    blank = np.full(len(record.natural_freqs), np.nan)
    freqs, damping, pair_mac = blank.copy(), blank.copy(), blank.copy()
    freqs[measured], damping[measured] = modes.natural_freqs[model], modes.damping_ratios[model]
    pair_mac[measured] = likeness[model, measured]
    return ModePair(record.name, record.natural_freqs, freqs, record.damping_ratios, damping, pair_mac)


def _linear(hypothesis: Hypothesis, band: float, position: float | None) -> Linearised:
    plant = hypothesis.plant()
    if position is not None and plant.excitation is not None:
        plant = replace(plant, excitation=plant.excitation.model_copy(update={"position": position}))
    return linearised(build_modal(plant, band))
