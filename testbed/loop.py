"""A diagnosis as ``diagnosis.json`` and as an updated rig: what scripts, benchmarks and the next round read."""

from collections.abc import Mapping, Sequence

import numpy as np

from identification.hypothesis import Hypothesis
from identification.locating.located import Located
from identification.result import (
    AddedEffect,
    Candidate,
    Diagnosis,
    ErrorMap,
    Estimate,
    FrfScore,
    MissingForce,
    ModesScore,
    Score,
    largest_at,
)
from models.arrays import FloatArray
from models.effects import Effect, entry_of
from models.record import AnyRecord
from models.rig import Rig
from testbed.outputs import Json
from testbed.proposal import proposal_json


def diagnose_to_json(
    rig: Rig, records: Sequence[AnyRecord], holdout: Sequence[AnyRecord] = (), seed: int = 0, jobs: int = 2
) -> Json:
    """Diagnose and say the result as ``diagnosis.json`` does.

    Args:
        rig: as its owner describes it.
        records: to learn from.
        holdout: kept aside, to judge the updated model on.
        seed: of every random choice.
        jobs: cores.

    Raises:
        InputError: records that do not fit the rig.
        ArithmeticError: the given rig's motion leaves the finite numbers.
    """
    from identification.diagnose import diagnose

    return diagnosis_json(diagnose(rig, records, holdout, seed=seed, jobs=jobs))


def diagnosis_json(diagnosis: Diagnosis) -> Json:
    """The content of ``diagnosis.json``.

    Args:
        diagnosis: finished.
    """
    return {
        "verdict": diagnosis.verdict,
        "effects": [_added(added) for added in diagnosis.added],
        "candidates": [_candidate(candidate) for candidate in diagnosis.candidates],
        "candidates_beside": [identity(effect) for effect in diagnosis.candidates_beside],
        "indistinguishable": [[identity(effect) for effect in group] for group in diagnosis.indistinguishable],
        "error": _errors(diagnosis),
        "holdout": _holdout(diagnosis.holdout),
        "where": _where(diagnosis),
        "next_experiment": proposal_json(diagnosis.next_experiment),
        "seconds": diagnosis.seconds,
    }


def _errors(diagnosis: Diagnosis) -> list[Json]:
    """How the error fell; of the last model also by how much it stands above the noise line by line."""
    rows = [
        {"model": stage.label, "nrmse": stage.score.nrmse, "noise_nrmse": stage.score.noise_nrmse}
        for stage in diagnosis.stages
    ]
    return [*rows[:-1], rows[-1] | {"times_noise": diagnosis.times_noise}]


def updated_rig(diagnosis: Diagnosis) -> Rig:
    """The rig with its calibrated numbers and, as further ``[[effects]]`` tables, what was added.

    Args:
        diagnosis: finished.
    """
    return rig_of(diagnosis.final.hypothesis)


def rig_of(hypothesis: Hypothesis) -> Rig:
    """The rig that a hypothesis describes: its numbers, and its effects as further ``[[effects]]`` tables.

    Args:
        hypothesis: one model of the history.
    """
    rig = hypothesis.updated_rig
    parts = (entry_of(part) for effect in hypothesis.effects for part in effect.parts())
    return rig.model_copy(update={"effects": (*rig.effects, *parts)})


def identity(effect: Effect) -> Json:
    """Kind, place and options of an effect, as the files name it; a sleeve stands for its position.

    What is tried in all sleeves at once has ``sleeves`` in place of ``sleeve``.
    """
    first, *others = effect.parts()
    place = first.place
    where = {
        "sleeve": None if others else place.sleeve,
        "sleeves": [part.place.sleeve for part in (first, *others)] if others else None,
        "position": None if place.sleeve else place.position,
        "sensor": place.sensor,
        "other": place.other,
    }
    options = {key: getattr(first, key) for key in first.options}
    return {"kind": first.kind, **{key: value for key, value in where.items() if value is not None}, **options}


def _added(added: AddedEffect) -> Json:
    fixed = {
        name: {"value": getattr(added.effect, name), "std": None, "unit": about.unit}
        for name, about in added.effect.parameters().items()
    }
    fitted = {estimate.name: estimate_json(estimate) for estimate in added.estimates}
    return {**identity(added.effect), "probability": added.probability, "parameters": {**fixed, **fitted}}


def estimate_json(estimate: Estimate) -> Json:
    """A fitted number with its standard deviation and unit.

    Args:
        estimate: of an effect or of the rig.
    """
    return {"value": estimate.value, "std": estimate.std, "unit": estimate.unit}


def _candidate(candidate: Candidate) -> Json:
    return {**identity(candidate.effect), "probability": candidate.probability, "nrmse": candidate.nrmse}


def _holdout(scores: Mapping[str, Score]) -> Json:
    if not scores:
        return {}
    errors: Json = {label: score.nrmse for label, score in scores.items()}
    return {**errors, "noise_nrmse": list(scores.values())[-1].noise_nrmse}


def _where(diagnosis: Diagnosis) -> Json:
    """The worst sensor, band and time window of each time record for the calibrated model, and the forces it lacks.

    FRFs and mode shapes have their errors, as given and updated, under ``linear``.
    """
    sensors = {score.record.name: score.record.sensors for score in diagnosis.final.score.records}
    return {
        "records": [_worst(error_map, sensors[error_map.record]) for error_map in diagnosis.where],
        "forces": [_force(force) for force in diagnosis.missing_forces],
        **({} if diagnosis.located is None else _located(diagnosis.located)),
        "findings": list(diagnosis.all_findings),
        "of_calibrated": [finding.told for finding in diagnosis.calibration],
        "linear": {
            label: [_linear(row) for row in stage.score.at_rest]
            for label, stage in (("as given", diagnosis.stages[0]), ("updated", diagnosis.final))
        },
    }


def _linear(row: FrfScore | ModesScore) -> Json:
    """How near a model comes to FRFs, by their worst sensor too, or to modes: mean relative error of frequency, MAC."""
    common = {"record": row.record.name, "nrmse": row.nrmse, "noise_nrmse": row.noise_nrmse}
    if isinstance(row, FrfScore):
        worst = int(np.argmax(row.channel_nrmse))
        return {**common, "sensor": {"name": row.record.sensors[worst], "error": float(row.channel_nrmse[worst])}}
    found = ~np.isnan(row.modes.mac)
    errors = np.abs(row.modes.natural_freqs / row.record.natural_freqs - 1.0)[found]
    if not found.any():
        return {**common, "freq_error": None, "mac": None}
    return {**common, "freq_error": float(errors.mean()), "mac": float(row.modes.mac[found].mean())}


def _worst(error_map: ErrorMap, sensors: Sequence[str]) -> Json:
    by_sensor = _rms(error_map.by_time, 1)
    by_band, by_window = _rms(error_map.by_frequency, 0), _rms(error_map.by_time, 0)
    sensor, band, window = (int(np.argmax(errors)) for errors in (by_sensor, by_band, by_window))
    return {
        "record": error_map.record,
        "level": error_map.level,
        "sensor": {"name": sensors[sensor], "error": float(by_sensor[sensor])},
        "band": {"frequency": float(error_map.frequency[band]), "error": float(by_band[band])},
        "window": {"time": float(error_map.time[window]), "error": float(by_window[window])},
    }


def _force(force: MissingForce) -> Json:
    return {
        "place": force.place,
        "record": force.record,
        "rms": float(np.sqrt(np.mean(force.force**2))),
        "largest_at": largest_at(force),
        "unit": "N",
    }


def _located(found: Located) -> Json:
    """The most likely place (or channel) of one force that is missing, the profile that says so, and its shape."""
    place = {
        "position": found.place,
        "interval": None if found.interval is None else list(found.interval),
        "sleeve": found.sleeve,
        "sensor": found.sensor,
        "explained": found.share,
        "enough": found.enough,
        "words": found.words,
    }
    profile = {"position": found.positions.tolist(), "explained": found.explained.tolist()}
    channels = [{"sensor": channel.sensor, "explained": channel.explained} for channel in found.channels]
    shape = [] if found.shape is None else list(found.shape.words)
    return {"place": place, "profile": profile, "channels": channels, "shape": shape}


def _rms(errors: FloatArray, axis: int) -> FloatArray:
    return np.asarray(np.sqrt(np.mean(np.nan_to_num(errors) ** 2, axis=axis)))
