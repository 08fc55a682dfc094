"""UFF: dataset 58 (ASCII and binary) with time responses or FRFs, 55 with mode shapes, 164 with units."""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from models.arrays import FloatArray
from models.errors import InputError
from testbed.records.recording import AnyRecording, FrfRecording, RawChannel, RawFrf, Recording, Tag
from testbed.records.time_base import likely_rate
from testbed.records.uff_modes import mode_recording

HOLDS = "datasets between lines of -1, with time responses or FRFs (58) or mode shapes (55)"

GENERAL, TIME_RESPONSE, FRF, COHERENCE = 0, 1, 4, 6
"""Function types of dataset 58."""

TIME, FREQUENCY = 17, 18
"""Specific data types of an abscissa."""

QUANTITIES = {8: "displacement", 9: "force", 11: "velocity", 12: "acceleration", 13: "force"}
"""Specific data types of an ordinate."""

SPECIFIC_TYPES = {"displacement": 8, "velocity": 11, "acceleration": 12, "force": 13, "angular_velocity": 11}

Z_TRANSLATION, Z_ROTATION = 3, 6
FIRST_ROTATION = 4

STEP_DIGITS = 6e-6
"""The format prints the step with six significant digits: by this share it may be off."""

_SET_TAG = re.compile(rb"    -1(?=[\r\n]|\Z| {74})")
_EXACT_RATE = re.compile(r"fs = (\S+) Hz")

Dataset = Mapping[str, Any]


def read(path: Path) -> AnyRecording:
    """The time responses of a file, or else its FRFs, or else its mode shapes.

    Raises:
        InputError: none of these, a file cut short, channels on different time bases.
        Exception: whatever pyuff raises on a file that is broken.
    """
    datasets = _datasets(path)
    functions = [d for d in datasets if d["type"] == 58]
    for dataset in functions:
        _check_length(dataset, path.name)
    unlabelled = _file_units(datasets, path.name)
    times = [d for d in functions if _is_time_response(d)]
    frfs = [d for d in functions if d["func_type"] == FRF]
    if times:
        return _time_recording(times, len(functions) - len(times), path.name, unlabelled)
    if frfs:
        coherences = [d for d in functions if d["func_type"] == COHERENCE]
        return _frf_recording(frfs, coherences, path.name, unlabelled)
    return mode_recording(datasets, path.name, HOLDS)


def write(recording: Recording, path: Path, *, binary: bool = True) -> None:
    """One dataset 58 a channel in double precision; ASCII keeps twelve digits.

    Args:
        recording: with ``fs``, of at least two samples.
        path: written in place.
        binary: dataset 58b.

    Raises:
        InputError: an excitation at a place without node.
    """
    import pyuff

    assert recording.fs is not None
    if recording.excitation_position is not None and recording.channels[0].tag.node is None:
        raise InputError(
            f"{recording.file}: the excitation acts at {recording.excitation_position} m, where no sensor has a node",
            "a UFF file says by a node where a roving hammer strikes",
            "give the sensor there a node, or write another format",
        )
    path.write_bytes(b"")
    file = pyuff.UFF(str(path))
    n = len(recording.channels[0].data)
    for channel in recording.channels:
        tag = channel.tag
        dataset = {
            "type": 58,
            "binary": int(binary),
            "func_type": TIME_RESPONSE,
            "id1": tag.name or "NONE",
            "id5": f"fs = {recording.fs!r} Hz",
            "rsp_node": tag.node or 0,
            "rsp_dir": Z_ROTATION if tag.quantity == "angular_velocity" else Z_TRANSLATION,
            "ref_node": 0,
            "ref_dir": 0,
            "abscissa_spacing": 1,
            "x": np.arange(n) / recording.fs,
            "data": np.array(channel.data, float),
            "abscissa_spec_data_type": TIME,
            "abscissa_axis_lab": "Time",
            "abscissa_axis_units_lab": "s",
            "ordinate_spec_data_type": SPECIFIC_TYPES[str(tag.quantity)],
            "ordinate_axis_lab": str(tag.quantity),
            "ordinate_axis_units_lab": tag.unit,
            "orddenom_spec_data_type": 0,
        }
        # Overwriting would lose the header of a binary set; the file is empty anyway.
        file.write_sets([dataset], mode="add", force_double=True)


def _datasets(path: Path) -> list[Dataset]:
    """All datasets of a file that is closed properly: pyuff would pass over a last one that is cut short."""
    import pyuff

    content = path.read_bytes()
    n_tags = len(_SET_TAG.findall(content))
    if n_tags == 0:
        raise InputError(f"{path.name}: has no datasets", f"a UFF file holds {HOLDS}", "check the file's suffix")
    if n_tags % 2 or not content.rstrip().endswith(b"-1"):
        raise InputError(
            f"{path.name}: dataset {(n_tags + 1) // 2} does not end",
            "each dataset of a UFF file ends with a line of -1",
            "the file is cut short or damaged: export or copy it again",
        )
    file = pyuff.UFF(str(path))
    return [file.read_sets(i) for i in range(file.get_n_sets())]


def _check_length(dataset: Dataset, file: str) -> None:
    announced, found = dataset["num_pts"], len(dataset["data"])
    if announced != found:
        raise InputError(
            f"{file}: channel {_response(dataset).shown} announces {announced} samples and holds {found}",
            "a dataset holds the samples it announces",
            "the file is cut short or damaged: export or copy it again",
        )


def _is_time_response(dataset: Dataset) -> bool:
    kind, abscissa = int(dataset["func_type"]), int(dataset["abscissa_spec_data_type"])
    return kind == TIME_RESPONSE or (kind == GENERAL and abscissa == TIME)


def _file_units(datasets: Sequence[Dataset], file: str) -> dict[str, float]:
    """SI factors of channels without label, from dataset 164, whose own factors divide."""
    units = next((d for d in datasets if d["type"] == 164), None)
    if units is None:
        return {}
    length, force = float(units["length"]), float(units["force"])
    if not (0 < length < np.inf and 0 < force < np.inf):
        raise InputError(
            f"{file}: dataset 164 with length {length:g} and force {force:g}",
            "unit factors are above 0",
            "correct dataset 164",
        )
    lengths = dict.fromkeys(("acceleration", "velocity", "displacement"), 1 / length)
    return {**lengths, "force": 1 / force, "angular_velocity": 1.0}


def _time_recording(times: Sequence[Dataset], n_others: int, file: str, unlabelled: dict[str, float]) -> Recording:
    first = times[0]
    for other in times[1:]:
        if not _same_abscissa(first, other):
            raise InputError(
                f"{file}: channel {_response(other).shown} has another time base than channel {_response(first).shown}",
                "all channels of a record share one time base and one length",
                "export channels of one rate and length into one file",
            )
    even = bool(first["abscissa_spacing"])
    remarks = [f"{file}: {n_others} datasets that are no time response were passed over"] if n_others else []
    return Recording(
        file,
        tuple(RawChannel(_response(d), d["data"]) for d in times),
        fs=_even_rate(first, file) if even else None,
        time=None if even else np.asarray(first["x"], float),
        time_unit=_label(first["abscissa_axis_units_lab"]),
        unlabelled=unlabelled,
        remarks=tuple(remarks),
    )


def _frf_recording(
    frfs: Sequence[Dataset], coherences: Sequence[Dataset], file: str, unlabelled: dict[str, float]
) -> FrfRecording:
    first = frfs[0]
    for dataset in frfs:
        shown = _response(dataset).shown
        if not _same_abscissa(first, dataset):
            raise InputError(
                f"{file}: channel {shown} has another frequency axis than channel {_response(first).shown}",
                "all FRFs of a record share one frequency axis",
                "export FRFs of one measurement into one file",
            )
        unit = _label(dataset["abscissa_axis_units_lab"])
        if unit is not None and unit.lower() not in ("hz", "hertz", "1/s"):
            raise InputError(
                f'{file}: channel {shown} over "{unit}"', "an FRF is over frequency in Hz", "export it in Hz"
            )
    return FrfRecording(
        file,
        np.asarray(first["x"], float),
        tuple(
            RawFrf(_response(d), _reference(d), np.asarray(d["data"], complex), _coherence_of(d, coherences))
            for d in frfs
        ),
        unlabelled,
    )


def _coherence_of(frf: Dataset, coherences: Sequence[Dataset]) -> FloatArray | None:
    """The coherence between the same two points on the same lines, whatever their signs."""
    for dataset in coherences:
        if _points(dataset) == _points(frf) and _same_abscissa(dataset, frf):
            return np.asarray(np.real(dataset["data"]), float)
    return None


def _points(dataset: Dataset) -> tuple[int, int, int, int]:
    directions = abs(int(dataset["rsp_dir"])), abs(int(dataset["ref_dir"]))
    return int(dataset["rsp_node"]), int(dataset["ref_node"]), *directions


def _same_abscissa(a: Dataset, b: Dataset) -> bool:
    # A tenth of a step: further apart, two channels are not simultaneous.
    x, y = np.asarray(a["x"], float), np.asarray(b["x"], float)
    if a["abscissa_spacing"] != b["abscissa_spacing"] or len(x) != len(y):
        return False
    return len(x) < 2 or bool(np.all(np.abs(x - y) <= 0.1 * abs(x[1] - x[0])))


def _even_rate(dataset: Dataset, file: str) -> float:
    step = float(dataset["abscissa_inc"])
    if not 0 < step < np.inf:
        raise InputError(f"{file}: a step of {step:g} s", "a time base grows", "correct the abscissa increment")
    noted = _EXACT_RATE.fullmatch(str(dataset["id5"]).strip())
    if noted:
        try:
            exact = float(noted[1])
        except ValueError:
            exact = 0.0
        if abs(exact * step - 1) <= STEP_DIGITS:
            return exact
    return likely_rate(1 / step, STEP_DIGITS)


def _response(dataset: Dataset) -> Tag:
    name = _label(dataset["rsp_ent_name"]) or _label(dataset["id1"])
    ordinate = dataset["ordinate_spec_data_type"], dataset["ordinate_axis_units_lab"]
    return _tag(name, dataset["rsp_node"], dataset["rsp_dir"], *ordinate)


def _reference(dataset: Dataset) -> Tag:
    denominator = dataset["orddenom_spec_data_type"], dataset["orddenom_axis_units_lab"]
    return _tag(_label(dataset["ref_ent_name"]), dataset["ref_node"], dataset["ref_dir"], *denominator)


def _tag(name: str | None, node: int, direction: int, specific_type: int, unit: str) -> Tag:
    quantity = QUANTITIES.get(specific_type)
    if quantity is not None and abs(direction) >= FIRST_ROTATION:
        quantity = f"angular_{quantity}"
    # Node 0 is how the format says that there is none.
    return Tag(name, node or None, -1 if direction < 0 else 1, _label(unit), quantity)


def _label(text: str) -> str | None:
    """A text field, of which NONE and nothing mean the same."""
    stripped = text.strip()
    return stripped if stripped.upper() not in ("", "NONE") else None
