"""The tables of a report, as rows of finished texts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from identification.evaluate import LEAST_NOISE
from identification.reached import MODELS_APART
from identification.result import Diagnosis, Estimate, FrfScore, ModesScore, RecordScore, Score
from models.arrays import FloatArray
from models.band_limit import PASS_EDGE, SCORE_EDGE, STOP_EDGE
from models.rig import Rig
from models.simulate import STEP_RATE
from testbed.quantities import unit_of
from testbed.report.words import chance, error_of, number, percent, stage_kind, with_std

Row = Mapping[str, str]

CANDIDATES = 12
"""Candidates in the main table; the others follow in a list that unfolds."""


def stage_rows(diagnosis: Diagnosis) -> list[Row]:
    """Each model with its error on the records and on those kept aside."""
    aside = {0: diagnosis.holdout.get("as given"), len(diagnosis.stages) - 1: diagnosis.holdout.get("updated")}
    rows: list[Row] = []
    for i, stage in enumerate(diagnosis.stages):
        held, score = aside.get(i), stage.score
        rows.append(
            {
                "model": stage.label,
                "kind": stage_kind(diagnosis, stage),
                "nrmse": percent(score.nrmse),
                "noise": percent(score.noise_nrmse),
                "ratio": number_of_times(score.nrmse, score.noise_nrmse),
                "holdout": "" if held is None else percent(held.nrmse),
            }
        )
    return rows


def number_of_times(error: float, noise: float) -> str:
    """How often the error is the noise."""
    return "" if noise <= 0 else f"{error / noise:.3g}"


def effect_rows(diagnosis: Diagnosis) -> list[Mapping[str, object]]:
    """Each added effect with its parameters."""
    return [
        {
            "label": added.effect.label(),
            "words": added.effect.in_words(),
            "source": added.effect.source,
            "probability": chance(added.probability),
            "estimates": [(estimate.name, with_std(estimate)) for estimate in added.estimates],
        }
        for added in diagnosis.added
    ]


@dataclass(frozen=True, eq=False)
class Pulls:
    """Calibrated numbers against the owner's tolerances.

    Attributes:
        rows: as texts.
        labels: for the figure.
        pulls, stds: (n,) in standard deviations of the tolerance.
    """

    rows: list[Row]
    labels: list[str]
    pulls: FloatArray
    stds: FloatArray


def rig_pulls(estimates: Sequence[Estimate], rig: Rig) -> Pulls:
    """The rig's calibrated numbers; those the rig does not tolerance are left out."""
    given = {parameter.path: parameter for parameter in rig.parameters()}
    known = [(estimate, given[estimate.name]) for estimate in estimates if estimate.name in given]
    pulls = np.array([p.deviations(float(np.mean(e.value))) for e, p in known])
    stds = np.array([float(np.mean(e.std)) / (p.tolerance * float(np.mean(e.value))) for e, p in known])
    rows: list[Row] = [
        {
            "label": parameter.label,
            "given": f"{number(parameter.value)} {parameter.unit}",
            "tolerance": percent(parameter.tolerance),
            "calibrated": with_std(estimate),
            "pull": f"{pull:+.2f} ± {std:.2f}",
        }
        for (estimate, parameter), pull, std in zip(known, pulls, stds, strict=True)
    ]
    return Pulls(rows, [parameter.label for _, parameter in known], pulls, stds)


def candidate_rows(diagnosis: Diagnosis) -> list[Row]:
    """What was judged in the first round, the most probable first."""
    return [
        {
            "label": candidate.effect.label(),
            "words": candidate.effect.in_words(),
            "probability": chance(candidate.probability),
            "width": f"{100.0 * candidate.probability:.1f}",
            "nrmse": error_of(candidate),
            "evidence": number(float(f"{candidate.log_evidence:.3g}")),
            "judged": "refitted" if candidate.refitted else "screened",
        }
        for candidate in diagnosis.candidates
    ]


def group_rows(diagnosis: Diagnosis) -> list[list[str]]:
    """Groups of effects that the records cannot tell apart."""
    return [[effect.label() for effect in group] for group in diagnosis.indistinguishable]


def record_rows(diagnosis: Diagnosis, rig: Rig) -> list[Row]:
    """Each record: level, errors, noise and how it was estimated; then those kept aside."""
    given = {row.record.name: row for row in diagnosis.stages[0].score.records}
    held = {row.record.name: row for row in diagnosis.holdout["as given"].records} if diagnosis.holdout else {}
    aside = diagnosis.holdout["updated"].records if "updated" in diagnosis.holdout else ()
    rows = [_record_row(row, given.get(row.record.name), rig, "") for row in diagnosis.final.score.records]
    rows += [_record_row(row, held.get(row.record.name), rig, "kept aside") for row in aside]
    return (
        rows
        + _rest_rows(diagnosis.stages[0].score, diagnosis.final.score, "")
        + (
            _rest_rows(diagnosis.holdout["as given"], diagnosis.holdout["updated"], "kept aside")
            if {"as given", "updated"} <= set(diagnosis.holdout)
            else []
        )
    )


def _rest_rows(given: Score, final: Score, note: str) -> list[Row]:
    """FRFs and mode shapes."""
    return [
        {
            "name": row.record.name,
            "note": note,
            "level": "",
            "length": _extent(row),
            "given": percent(first.nrmse),
            "updated": percent(row.nrmse),
            "noise": percent(row.noise_nrmse),
            "method": row.method,
            "start": "small motion about rest",
        }
        for first, row in zip(given.at_rest, final.at_rest, strict=True)
    ]


def _extent(row: FrfScore | ModesScore) -> str:
    if isinstance(row, ModesScore):
        return f"{len(row.record.natural_freqs)} modes"
    frequency = row.record.frequency
    return f"{len(frequency)} lines, {frequency[0]:.4g} to {frequency[-1]:.4g} Hz"


def mode_tables(diagnosis: Diagnosis) -> list[Mapping[str, object]]:
    """Each record of mode shapes with its modes beside those of the given and of the final model."""
    pairs = zip(diagnosis.stages[0].score.at_rest, diagnosis.final.score.at_rest, strict=True)
    return [
        {
            "record": row.record.name,
            "rows": [
                {"measured": f"{freq:.5g} Hz", "given": _mode(first, k), "updated": _mode(row, k)}
                for k, freq in enumerate(row.record.natural_freqs)
            ],
        }
        for first, row in pairs
        if isinstance(first, ModesScore) and isinstance(row, ModesScore)
    ]


def _mode(row: ModesScore, k: int) -> str:
    freq, mac = row.modes.natural_freqs[k], row.modes.mac[k]
    return "none" if np.isnan(freq) else f"{freq:.5g} Hz, MAC {mac:.3f}"


def _record_row(row: RecordScore, given: RecordScore | None, rig: Rig, note: str) -> Row:
    record = row.record
    force = record.excitation
    unit = "" if rig.excitation is None else unit_of(rig.excitation.quantity)
    method = row.noise.method
    if force is not None:
        method += f"; excitation: {row.noise.excitation_method}"
    return {
        "name": record.name,
        "note": note,
        "level": "free decay" if force is None else f"{number(float(np.sqrt(np.mean(force**2))))} {unit}",
        "length": f"{record.duration:.4g} s at {record.fs:.5g} Hz",
        "given": "" if given is None else percent(given.nrmse),
        "updated": percent(row.nrmse),
        "noise": percent(row.noise_nrmse),
        "method": method,
        "start": "estimated" if record.moving_start else "at rest",
    }


def channel_rows(diagnosis: Diagnosis) -> list[Mapping[str, object]]:
    """Each record with the errors of its channels, as given and of the final model."""
    given = {row.record.name: row for row in _with_channels(diagnosis.stages[0].score)}
    tables: list[Mapping[str, object]] = []
    for row in _with_channels(diagnosis.final.score):
        first = given.get(row.record.name)
        tables.append(
            {
                "record": row.record.name,
                "rows": [
                    {
                        "sensor": sensor,
                        "given": "" if first is None else percent(float(first.channel_nrmse[i])),
                        "updated": percent(float(row.channel_nrmse[i])),
                        "noise": percent(float(row.channel_noise_nrmse[i])),
                    }
                    for i, sensor in enumerate(row.record.sensors)
                ],
            }
        )
    return tables


def _with_channels(score: Score) -> list[RecordScore | FrfScore]:
    return [*score.records, *(row for row in score.at_rest if isinstance(row, FrfScore))]


def default_rows(diagnosis: Diagnosis, rig: Rig) -> list[tuple[str, str]]:
    """Choices that change the numbers, the rig file's and this program's."""
    tolerances = ", ".join(f"{key} {percent(share)}" for key, share in rig.tolerances.items())
    return [
        ("band judged", f"0 to {SCORE_EDGE:g} fs"),
        ("recorder", f"zero-phase low-pass, flat to {PASS_EDGE:g} fs, stopped from {STOP_EDGE:g} fs"),
        ("tolerances (one standard deviation)", tolerances or "none: no number of the rig was moved"),
        ("noise floor", "estimated from each record, see above; the excitation's noise is carried through the model"),
        ("least noise", f"{LEAST_NOISE:g} of a channel's rms"),
        ("the model's own error, if unexplained", f"up to {percent(MODELS_APART)} of the motion with impacts"),
        ("time step", f"at least {STEP_RATE:g} steps a second"),
        ("seed", str(diagnosis.seed)),
        ("time taken", f"{diagnosis.seconds:.0f} s"),
    ]
