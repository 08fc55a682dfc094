"""An error budget over files: ``budget.json`` and a figure for each sensor in a folder."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

import numpy as np

from identification.assess import assess
from identification.budget import Budget, budget_of
from identification.budget.gain import Gain, gain_of
from identification.budget.pooled import FALSE_ALARM
from identification.budget.split import Split
from identification.budget.unsplit import Unsplit
from identification.hypothesis import Hypothesis
from identification.progress import Progress
from models.arrays import FloatArray
from models.errors import InputError
from models.record import AnyRecord, Record
from models.rig_file import read_rig
from testbed.channel_checks import check_driven, check_excitation, check_length
from testbed.channels import Channels, channels_of, check_left_out, recording_of
from testbed.figures.budget import budget_figure
from testbed.figures.save import save
from testbed.inputs import check_names, read_inputs
from testbed.outputs import Json, json_text, staged
from testbed.quantities import unit_of


@dataclass(frozen=True)
class Order:
    """What is asked for.

    Attributes:
        records: files.
        rig: file whose sensors they are and whose error is split; None where the records stand alone.
        channels: names; all where none is named.
        excitation: name of its channel, without a rig.
        without: channels to leave out.
    """

    records: tuple[Path, ...]
    rig: Path | None = None
    channels: tuple[str, ...] = ()
    excitation: str | None = None
    without: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class _Read:
    """Records with the units of what they hold."""

    records: tuple[AnyRecord, ...]
    units: dict[str, str]
    excitation_unit: str
    predicted: dict[str, FloatArray]


def run_budget(order: Order, out: Path, *, progress: Progress) -> Json:
    """Split the records and write the result.

    Args:
        order: what is asked for.
        out: folder of the results.
        progress: told what is being done.

    Returns:
        the content of ``budget.json``.

    Raises:
        InputError: a file that cannot be used, or a folder that cannot be written.
    """
    check_names(order.records)
    read = _alone(order) if order.rig is None else _with_rig(order, order.rig, progress)
    for record in read.records:
        if isinstance(record, Record):
            check_length(record.name, record.n_samples)
    budget = budget_of(read.records, read.excitation_unit)
    gains = {
        split.record.name: gain_of(split, read.predicted[split.record.name])
        for split in budget.splits
        if split.record.name in read.predicted
    }
    noticed = [finding for record in read.records if isinstance(record, Record) for finding in record.findings]
    content = budget_json(budget, gains, noticed, read.units)
    with staged(out) as stage:
        (stage / "budget.json").write_text(json_text(content), encoding="utf-8")
        shown = [level.splits[0] for level in budget.levels]
        for name in dict.fromkeys(sensor for split in shown for sensor in split.record.sensors):
            progress(f"drawing {name}")
            holding = [split for split in shown if name in split.record.sensors]
            figure = budget_figure(holding, name, read.units.get(name, ""), read.excitation_unit)
            save(figure, stage / "figures", f"{name}-budget")
    return content


def _alone(order: Order) -> _Read:
    """The records by their own names and units."""
    recordings = [recording_of(path) for path in order.records]
    check_left_out(recordings, order.without)
    held = [channels_of(recording, order.excitation, order.without) for recording in recordings]
    for channels in held:
        check_driven(channels)
    held = [channels.only(order.channels) if order.channels else channels for channels in held]
    units = {name: unit_of(quantity) for c in held for name, quantity in zip(c.sensors, c.quantities, strict=True)}
    driven = [c.excitation_quantity for c in held if c.excitation is not None]
    return _Read(tuple(_record(c) for c in held), units, unit_of(driven[0]) if driven else "", {})


def _record(channels: Channels) -> Record:
    return Record(
        channels.name,
        channels.fs,
        channels.excitation,
        channels.sensors,
        channels.responses,
        findings=channels.findings,
    )


def _with_rig(order: Order, rig_path: Path, progress: Progress) -> _Read:
    """The records by the rig's sensors, and what the rig predicts of them."""
    check_excitation(order.excitation, read_rig(rig_path))
    inputs = read_inputs(rig_path, order.records, without=order.without, strict=False)
    in_time = [record for record in inputs.records if isinstance(record, Record)]
    progress(f"predicting {', '.join(record.name for record in in_time)}")
    score = assess(Hypothesis(inputs.rig), in_time) if in_time else None
    predicted = {row.record.name: row.predicted for row in score.records} if score is not None else {}
    units = {sensor.name: unit_of(sensor.quantity) for sensor in inputs.rig.sensors}
    unit = unit_of(inputs.rig.excitation.quantity) if inputs.rig.excitation is not None else ""
    if not order.channels:
        return _Read(inputs.records, units, unit, predicted)
    rows = {record.name: _rows(record, order.channels) for record in in_time}
    records = tuple(
        replace(record, sensors=order.channels, responses=record.responses[rows[record.name]])
        if isinstance(record, Record)
        else record
        for record in inputs.records
    )
    return _Read(records, units, unit, {name: values[rows[name]] for name, values in predicted.items()})


def _rows(record: Record, names: Sequence[str]) -> list[int]:
    for name in names:
        if name not in record.sensors:
            raise InputError(
                f"{record.name}: no channel {name!r}",
                f"its channels are {', '.join(record.sensors)}",
                "name one of these with --channel, or leave the option out for all of them",
            )
    return [record.sensors.index(name) for name in names]


def budget_json(
    budget: Budget, gains: dict[str, Gain], noticed: Sequence[str] = (), units: Mapping[str, str] = MappingProxyType({})
) -> Json:
    """The content of ``budget.json``.

    Args:
        budget: finished.
        gains: what a model misses, by the names of records.
        noticed: what the reader of the records found.
        units: of the sensors' channels, by name.
    """
    content: Json = {
        "false_alarm": FALSE_ALARM,
        "records": [
            *(_split_json(split, gains.get(split.record.name)) for split in budget.splits),
            *(_other_json(other) for other in budget.others),
        ],
        "findings": [*noticed, *budget.findings()],
    }
    for record in content["records"]:
        for channel in record["channels"]:
            channel["unit"] = units.get(channel["sensor"])
    return content


def _split_json(split: Split, gain: Gain | None) -> Json:
    lines, periods = split.lines, split.periods
    return {
        "record": split.record.name,
        "repeats": True,
        "level": split.level,
        "periods": split.n_periods,
        "discarded": periods.discarded,
        "period": periods.samples / split.record.fs,
        "lines": periods.plan,
        "bands": split.bands,
        "frequency": periods.frequency,
        "excited": periods.excited,
        "told": split.told,
        "channels": [
            {
                "sensor": name,
                "rms": np.sqrt(split.mean_square[i]),
                "rms_of": {
                    "noise": np.sqrt(split.noise[i].sum()),
                    **{
                        cause: np.sqrt(share.total[i]) if np.isnan(share.total[i]) or share.found[i].any() else 0.0
                        for cause, share in split.shares.items()
                    },
                },
                "by_band": {
                    "response": np.sqrt(split.response[i]),
                    "noise": np.sqrt(split.noise[i]),
                    **{cause: np.sqrt(share.power[i]) for cause, share in split.shares.items()},
                },
                "p": {cause: share.p[i] for cause, share in split.shares.items()},
                "by_line": {
                    "response": np.sqrt(lines.response[i]),
                    "noise": np.sqrt(lines.noise[i]),
                    "distortion": np.sqrt(lines.distortion[i]),
                    "transient": np.sqrt(lines.transient[i]),
                    "time_variation": np.sqrt(lines.time_variation[i]),
                },
                "bla": {
                    "real": split.bla[i].real,
                    "imag": split.bla[i].imag,
                    "std": np.sqrt(split.bla_variance[i]),
                },
                "drift": None if split.drift is None else _drift_json(split, i),
                "model": None if gain is None else _gain_json(gain, i),
            }
            for i, name in enumerate(split.record.sensors)
        ],
    }


def _drift_json(split: Split, i: int) -> Json:
    assert split.drift is not None
    return {"gain": split.drift.gain[i], "phase": split.drift.phase[i], "std": split.drift.std[i]}


def _gain_json(gain: Gain, i: int) -> Json:
    parts = {"error": gain.error, "noise": gain.noise, "possible": gain.possible, "nonlinear": gain.nonlinear}
    return {
        **{name: np.sqrt(part[i].sum()) for name, part in parts.items()},
        "by_band": {name: np.sqrt(part[i]) for name, part in parts.items()},
    }


def _other_json(other: Unsplit) -> Json:
    rms = np.full(len(other.sensors), np.nan) if other.mean_square is None else np.sqrt(other.mean_square)
    noise = np.full(len(other.sensors), np.nan) if other.noise is None else np.sqrt(other.noise)
    return {
        "record": other.name,
        "repeats": False,
        "reason": other.reason,
        "channels": [
            {"sensor": name, "rms": rms[i], "rms_of": {"noise": noise[i]}} for i, name in enumerate(other.sensors)
        ],
    }
