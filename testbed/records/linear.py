"""FRFs and mode shapes, resolved against a rig: the records from which no nonlinearity can be seen."""

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.errors import InputError
from models.record import FrfRecord, ModeShapeRecord
from models.rig import Excitation, Rig
from testbed.records.matching import locate, no_sensor, sensor_of
from testbed.records.recording import FrfRecording, ModeRecording, RawFrf, Tag
from testbed.records.units import Measured, frf_factor


def frf_record(recording: FrfRecording, rig: Rig, expected: tuple[str, ...]) -> FrfRecord:
    """FRFs of the expected sensors in SI units, response per excitation.

    Args:
        recording: what the file holds.
        rig: whose sensors and excitation they are.
        expected: names of the sensors to keep.

    Raises:
        InputError: several references, a reference or sensor that cannot be found, units, values that are no numbers,
            a coherence that is none.
    """
    file = recording.file
    _check_frequency(recording.frequency, file)
    if rig.excitation is None:
        raise InputError(
            f"{file}: FRFs", "an FRF needs to know what excites the rig", "add [excitation] to the rig file"
        )
    references = {(frf.reference.node, abs(frf.reference.sign)): frf.reference for frf in recording.frfs}
    if len(references) > 1:
        shown = ", ".join(tag.shown for tag in references.values())
        raise InputError(
            f"{file}: FRFs from several references ({shown})", "a record has one", "write one file for each"
        )
    values: dict[str, ComplexArray] = {}
    coherence: dict[str, FloatArray] = {}
    for frf in recording.frfs:
        sensor = sensor_of(frf.response, rig.sensors)
        if sensor is None or sensor.name not in expected:
            continue
        if sensor.name in values:
            raise InputError(
                f"{file}: several FRFs match {sensor.name}", "each sensor has one", "remove the others from the file"
            )
        values[sensor.name] = _si_values(frf, Measured.of(sensor), rig.excitation, recording)
        if frf.coherence is not None:
            coherence[sensor.name] = _checked_coherence(frf.coherence, f"{file}: coherence of {sensor.name}")
    if not values:
        raise no_sensor(file, (frf.response for frf in recording.frfs), rig)
    names = tuple(name for name in expected if name in values)
    return FrfRecord(
        name=file,
        frequency=recording.frequency,
        sensors=names,
        values=np.stack([values[name] for name in names]),
        excitation_position=locate(recording.frfs[0].reference, rig, file),
        coherence=np.stack([coherence[name] for name in names]) if len(coherence) == len(names) else None,
    )


def mode_shape_record(recording: ModeRecording, rig: Rig, expected: tuple[str, ...]) -> ModeShapeRecord:
    """Mode shapes at the expected sensors.

    Args:
        recording: what the file holds.
        rig: whose sensors the nodes are.
        expected: names of the sensors to keep.

    Raises:
        InputError: a node that stands twice, no sensor of the rig, values that are no numbers.
    """
    file, nodes = recording.file, recording.nodes
    # Dataset 55 holds translations; the slope at an angular sensor is none.
    sensors = [s for s in rig.sensors if s.name in expected and s.node in nodes and s.quantity != "angular_velocity"]
    if not sensors:
        raise no_sensor(file, (Tag(node=node) for node in nodes), rig)
    twice = next((sensor for sensor in sensors if nodes.count(sensor.node or 0) > 1), None)
    if twice is not None:
        raise InputError(f"{file}: node {twice.node} stands twice", "each node has one shape", "remove one of the two")
    shapes = recording.shapes[:, [nodes.index(sensor.node or 0) for sensor in sensors]]
    for sensor, column in zip(sensors, shapes.T, strict=True):
        _check_finite(column, f"{file}: channel {sensor.name}, mode")
    damped = bool(np.any(recording.damping_ratios != 0))
    return ModeShapeRecord(
        name=file,
        sensors=tuple(sensor.name for sensor in sensors),
        natural_freqs=recording.natural_freqs,
        damping_ratios=recording.damping_ratios if damped else None,
        shapes=shapes,
    )


def _si_values(frf: RawFrf, sensor: Measured, excitation: Excitation, recording: FrfRecording) -> ComplexArray:
    file, values = recording.file, frf.values
    _check_finite(values, f"{file}: channel {frf.response.shown}, sample")
    if not values.any():
        raise InputError(
            f"{file}: the FRF of {sensor.name} is 0 throughout",
            "a channel that measures is not 0",
            f"remove it, or leave it out with --without {sensor.name}",
        )
    measured = Measured.of(excitation)
    factor = frf_factor(frf.response, frf.reference, sensor, measured, file=file, unlabelled=recording.unlabelled)
    return values * (factor * frf.response.sign * frf.reference.sign)


def _check_finite(values: ComplexArray, where: str) -> None:
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise InputError(
            f"{where} {bad[0]} is {values[bad[0]]}", "all values are finite", "repair or remove the channel"
        )


def _checked_coherence(values: FloatArray, where: str) -> FloatArray:
    outside = np.flatnonzero(~((values >= 0.0) & (values <= 1.0 + ROUNDING)))
    if outside.size:
        raise InputError(
            f"{where}, sample {outside[0]} is {values[outside[0]]:g}",
            "a coherence is from 0 to 1",
            "repair or remove the channel",
        )
    return np.minimum(values, 1.0)


ROUNDING = 1e-5
"""A coherence of 1 in single precision."""


def _check_frequency(frequency: FloatArray, file: str) -> None:
    if frequency.size == 0 or not np.all(np.isfinite(frequency)) or frequency[0] < 0 or np.any(np.diff(frequency) <= 0):
        raise InputError(
            f"{file}: its frequency axis does not grow from 0 or above",
            "an FRF is over growing frequencies in Hz",
            "correct the abscissa",
        )
