"""What a comparison and a diagnosis say, as values: the report and the JSON files are made from these alone."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, TypeVar

import numpy as np

from identification.at_rest import PairedModes
from identification.consistency.finding import CalibrationFinding
from identification.hypothesis import Hypothesis
from identification.locating.located import Located, PlacedForce
from identification.next_experiment.proposal import Proposal
from identification.noise import Noise
from models.arrays import ComplexArray, FloatArray
from models.effects import Effect
from models.record import FrfRecord, ModeShapeRecord, Record
from models.simulate import Trace

Verdict = Literal["missing_effect", "complete", "unexplained"]


@dataclass(frozen=True, eq=False)
class RecordScore:
    """One record against one model.

    Attributes:
        record: measured.
        predicted: (n_sensors, N) what the model says, SI.
        noise: of the record's channels.
        nrmse: over all channels, by quantity, below 0.35 fs.
        noise_nrmse: the same for a perfect model.
        channel_nrmse, channel_noise_nrmse: (n_sensors,) per channel.
    """

    record: Record
    predicted: FloatArray
    noise: Noise
    nrmse: float
    noise_nrmse: float
    channel_nrmse: FloatArray
    channel_noise_nrmse: FloatArray


@dataclass(frozen=True, eq=False)
class FrfScore:
    """FRFs against one model linearised at rest.

    Attributes:
        record: measured, above 0 Hz.
        predicted: (n_sensors, n) SI.
        method: how the noise was found, in words.
        nrmse: rms(model - measured) / rms(measured) over all sensors and lines.
        noise_nrmse: the same for a perfect model.
        channel_nrmse, channel_noise_nrmse: (n_sensors,) per sensor.
    """

    record: FrfRecord
    predicted: ComplexArray
    method: str
    nrmse: float
    noise_nrmse: float
    channel_nrmse: FloatArray
    channel_noise_nrmse: FloatArray


@dataclass(frozen=True, eq=False)
class ModesScore:
    """Mode shapes against one model linearised at rest.

    Attributes:
        record: measured.
        modes: of the model, each with the measured one that it is most like.
        method: where the noise comes from, in words.
        nrmse: over the modes, of the relative error of the frequency and that of the scaled shape.
        noise_nrmse: the same for a perfect model.
    """

    record: ModeShapeRecord
    modes: PairedModes
    method: str
    nrmse: float
    noise_nrmse: float


AnyScore = RecordScore | FrfScore | ModesScore


@dataclass(frozen=True, eq=False)
class Score:
    """Several records against one model; the overall figures are root mean squares of the records'.

    Attributes:
        records: time records.
        at_rest: FRFs and mode shapes.
    """

    records: tuple[RecordScore, ...]
    at_rest: tuple[FrfScore | ModesScore, ...] = ()

    def of(self, name: str) -> RecordScore:
        """The row of the time record of that name, which must be there."""
        return next(row for row in self.records if row.record.name == name)

    @property
    def rows(self) -> tuple[AnyScore, ...]:
        """All of them."""
        return (*self.records, *self.at_rest)

    @property
    def nrmse(self) -> float:
        """Overall error."""
        return float(np.sqrt(np.mean([row.nrmse**2 for row in self.rows])))

    @property
    def noise_nrmse(self) -> float:
        """Overall error of a perfect model."""
        return float(np.sqrt(np.mean([row.noise_nrmse**2 for row in self.rows])))


@dataclass(frozen=True, eq=False)
class Estimate:
    """A fitted number with its standard deviation."""

    name: str
    value: float | tuple[float, ...]
    std: float | tuple[float, ...]
    unit: str


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect at a place, refitted with everything else, and what speaks for it.

    Attributes:
        effect: with its fitted values.
        probability: among all that were judged in the same round, "nothing more" included, less what is kept for what
            was not judged (``outcome.tried``).
        nrmse: error of the model with it on the records it was judged on.
        log_evidence: natural logarithm, relative to the best of the round.
        refitted: False where only the beginning of the records judged it; its nrmse is then an upper bound.
    """

    effect: Effect
    probability: float
    nrmse: float
    log_evidence: float
    refitted: bool


@dataclass(frozen=True, eq=False)
class AddedEffect:
    """An effect that was added, with its parameters' intervals (``position`` among them where it was fitted)."""

    effect: Effect
    probability: float
    estimates: tuple[Estimate, ...]


@dataclass(frozen=True, eq=False)
class Stage:
    """One model of the history: ``as given``, ``calibrated``, ``+ squeeze_film at sleeve 2``."""

    label: str
    hypothesis: Hypothesis
    score: Score


@dataclass(frozen=True, eq=False)
class ErrorMap:
    """Where and when a model misses one record.

    Attributes:
        record: name.
        level: rms of the excitation, SI.
        frequency: (n_bands,) centres, Hz.
        by_frequency: (n_sensors, n_bands) rms error over rms measured of the channel, in bands.
        time: (n_windows,) centres, s.
        by_time: (n_sensors, n_windows) the same in windows.
        noise_by_frequency: (n_sensors, n_bands) the same for a perfect model.
    """

    record: str
    level: float
    frequency: FloatArray
    by_frequency: FloatArray
    time: FloatArray
    by_time: FloatArray
    noise_by_frequency: FloatArray


@dataclass(frozen=True, eq=False)
class MissingForce:
    """The force at one sleeve (or other place) that the model lacks, against the motion there.

    Attributes:
        place: the sleeve's name, or a position.
        record: name.
        q, v: (N,) m and m/s, as the model with the missing force moves.
        force: (N,) N, smoothed to the band in which it can be told.
        fs: Hz.
    """

    place: str
    record: str
    q: FloatArray
    v: FloatArray
    force: FloatArray
    fs: float


AnyForce = TypeVar("AnyForce", MissingForce, PlacedForce)


def loudest(forces: Sequence[AnyForce]) -> AnyForce:
    """The force that varies most, of several places or records, one at least.

    Args:
        forces: N.
    """
    return max(forces, key=lambda force: float(force.force.std()))


def largest_at(force: MissingForce | PlacedForce) -> float:
    """When a force is largest, s from the record's first sample.

    Args:
        force: N.
    """
    return int(np.argmax(np.abs(force.force))) / force.fs


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """The whole round of the loop.

    Attributes:
        verdict: as in diagnosis.json.
        added: effects in the order of adding.
        candidates: all that were judged in the first round, the most probable first.
        indistinguishable: groups that the records cannot tell apart.
        stages: the models in order with their errors.
        times_noise: rms residual of the last fit on what was fitted, each line of each channel over its own noise.
        holdout: ``as given`` and ``updated`` scores on records kept aside; empty if there are none.
        rig_estimates: calibrated numbers of the rig.
        where: error maps of the calibrated model, one a time record.
        missing_forces: of the calibrated model.
        updated_maps: error maps of the final model.
        traces: of the final model, by record name.
        next_experiment: what would tell most.
        decisions: what was decided and why, in order, in words.
        seconds: wall time.
        seed: of every random choice.
        located: the one place where a force would explain most of what the calibrated model leaves, and its shape.
        findings: what was noticed in the records, in words.
        calibration: what one set of numbers does not explain, the most significant first.
        not_predicted: a sentence for each record kept aside on which what was learnt does not hold.
        candidates_beside: effects in the model beside which the candidates were judged last: those that were tried
            after the first one, where it was judged again beside them.
    """

    verdict: Verdict
    added: tuple[AddedEffect, ...]
    candidates: tuple[Candidate, ...]
    indistinguishable: tuple[tuple[Effect, ...], ...]
    stages: tuple[Stage, ...]
    times_noise: float
    holdout: Mapping[str, Score]
    rig_estimates: tuple[Estimate, ...]
    where: tuple[ErrorMap, ...]
    missing_forces: tuple[MissingForce, ...]
    updated_maps: tuple[ErrorMap, ...]
    traces: Mapping[str, Trace]
    next_experiment: Proposal
    decisions: tuple[str, ...]
    seconds: float
    seed: int
    findings: tuple[str, ...] = field(default=())
    located: Located | None = None
    calibration: tuple[CalibrationFinding, ...] = field(default=())
    not_predicted: tuple[str, ...] = ()
    candidates_beside: tuple[Effect, ...] = ()

    @property
    def all_findings(self) -> tuple[str, ...]:
        """In words: of the records, of those kept aside where that judges what was learnt, of the calibrated model."""
        kept = self.not_predicted if self.verdict != "unexplained" else ()
        return (*self.findings, *kept, *(each.told for each in self.calibration))

    @property
    def calibrated(self) -> Stage:
        """The model without effects, its numbers within their tolerances."""
        return next(stage for stage in reversed(self.stages) if stage.label == "calibrated")

    @property
    def final(self) -> Stage:
        """The last model."""
        return self.stages[-1]
