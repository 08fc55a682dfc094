"""Which channel of a file is which sensor of the rig, and which one is the excitation."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from models.errors import InputError
from models.rig import Excitation, Rig, Sensor
from models.rig_checks import nearest
from testbed.records.recording import RawChannel, Recording, Tag, identifier
from testbed.records.units import Measured, quantity_of


@dataclass(frozen=True, eq=False)
class Matched:
    """A recording's channels by the rig's parts.

    Attributes:
        sensors: sensor -> its channel, in the order of the rig.
        excitation: its channel, if there is one.
        excitation_position: m from the clamp, where it is not the rig's.
        findings: channels that match nothing, and guesses.
        strangers: channels that match nothing, as they are shown.
    """

    sensors: dict[str, RawChannel]
    excitation: RawChannel | None
    excitation_position: float | None
    findings: tuple[str, ...]
    strangers: tuple[str, ...]


def match(recording: Recording, rig: Rig, without: Sequence[str] = ()) -> Matched:
    """Find each sensor's channel by node or name, and the excitation by node, name or as the only force.

    Args:
        recording: what the file holds.
        rig: whose parts the channels are.
        without: names to leave out.

    Raises:
        InputError: no sensor of the rig is there, two channels match one part, or the force cannot be located.
    """
    excitation, position, findings = _excitation(recording, rig, without)
    others = [channel for channel in recording.channels if channel is not excitation]
    sensors = {}
    for sensor in rig.sensors:
        found = [] if sensor.name in without else _channels_of(sensor, others, rig.sensors)
        if len(found) > 1:
            raise _duplicate(recording.file, sensor.name, [channel.tag for channel in found])
        if found:
            sensors[sensor.name] = found[0]
    if not sensors:
        raise no_sensor(recording.file, (channel.tag for channel in others), rig)
    strangers = [
        channel.tag.shown
        for channel in others
        if not any(channel is used for used in sensors.values()) and _is_unexpected(channel.tag, rig, without)
    ]
    unused = [f"{recording.file}: channel {name} is no sensor of the rig and was passed over" for name in strangers]
    if excitation is None and rig.excitation is not None and rig.excitation.name not in without and strangers:
        raise InputError(
            f"{recording.file}: no channel for the excitation {rig.excitation.name}, but {strangers[0]}, which the rig "
            "does not know",
            f"the excitation goes by the name {rig.excitation.name}"
            + ("" if rig.excitation.node is None else f" or the node {rig.excitation.node}")
            + "; without it a record is a free decay",
            f"rename the channel, or read the record as a free decay with --without {rig.excitation.name}",
        )
    return Matched(sensors, excitation, position, (*recording.remarks, *findings, *unused), tuple(strangers))


def sensor_of(tag: Tag, sensors: Sequence[Sensor]) -> Sensor | None:
    """The sensor that a tag means: its node's, or its name's where one of the two has no node."""
    if tag.node is not None:
        for sensor in sensors:
            if sensor.node == tag.node:
                return sensor
    if tag.name is None:
        return None
    named = [sensor for sensor in sensors if tag.node is None or sensor.node is None]
    exact = [sensor for sensor in named if sensor.name == tag.name]
    like = [sensor for sensor in named if identifier(sensor.name) == identifier(tag.name)]
    return next(iter(exact or like), None)


def locate(tag: Tag, rig: Rig, file: str) -> float | None:
    """Where a force acts that may not act where the rig says, m from the clamp; None for the rig's own place.

    Raises:
        InputError: its node is neither the excitation's nor a sensor's.
    """
    excitation = rig.excitation
    assert excitation is not None
    if tag.node is None or tag.node == excitation.node:
        return None
    for sensor in rig.sensors:
        if sensor.node == tag.node:
            return None if sensor.position == excitation.position else sensor.position
    known = ", ".join(f"{sensor.node} ({sensor.name})" for sensor in rig.sensors if sensor.node is not None)
    raise InputError(
        f"{file}: the excitation is at node {tag.node}",
        f"an excitation is at the rig's node {excitation.node} or at a sensor's: {known or 'none has a node'}",
        f"write node = {tag.node} in [excitation], or give that node to a sensor",
    )


def no_sensor(file: str, tags: Iterable[Tag], rig: Rig) -> InputError:
    """The error for a file that has nothing to do with the rig."""
    held = ", ".join(tag.shown for tag in tags) or "none"
    names = ", ".join(
        sensor.name if sensor.node is None else f"{sensor.name} (node {sensor.node})" for sensor in rig.sensors
    )
    return InputError(
        f"{file}: no sensor of the rig among its channels ({held[:200]})",
        f"the rig's sensors are {names or 'none'}",
        "name the channels like the sensors, or correct the sensors' names or nodes in the rig file",
    )


def check_left_out(names: Sequence[str], rig: Rig) -> None:
    """Whether each name of ``--without`` is a channel of the rig.

    Raises:
        InputError: one is not.
    """
    sensors = [sensor.name for sensor in rig.sensors]
    known = sensors + ([rig.excitation.name] if rig.excitation else [])
    for name in names:
        if name not in known:
            raise not_left_out(name, "the rig's channels", known)
    if sensors and set(sensors) <= set(names):
        raise InputError(f"--without {' '.join(names)}", "a record keeps at least one sensor", "leave out fewer")


def not_left_out(name: str, channels: str, known: list[str]) -> InputError:
    """What to say of a name of ``--without`` that no channel has.

    Args:
        name: as given.
        channels: whose they are, in words.
        known: their names.
    """
    near = nearest(name, known)
    mend = f"the nearest one is {near}" if near else "name one of them" if known else "leave --without away"
    return InputError(f"--without {name}", f"{channels} are {', '.join(known)}", mend)


def _channels_of(sensor: Sensor, channels: Sequence[RawChannel], sensors: Sequence[Sensor]) -> list[RawChannel]:
    """Its channels; where a node carries several quantities, those of the sensor's own."""
    found = [c for c in channels if (s := sensor_of(c.tag, sensors)) is not None and s.name == sensor.name]
    own = [c for c in found if quantity_of(c.tag) in (None, sensor.quantity)]
    return own or [c for c in found if not _is_force_at_a_node(c.tag)]


def _is_force_at_a_node(tag: Tag) -> bool:
    """A hammer at a sensor's node, not that sensor in wrong units."""
    return quantity_of(tag) == "force" and tag.node is not None


def _is_unexpected(tag: Tag, rig: Rig, without: Sequence[str]) -> bool:
    sensor = sensor_of(tag, rig.sensors)
    if sensor is not None:
        return sensor.name not in without
    return rig.excitation is None or rig.excitation.name not in without or tag.name != rig.excitation.name


def _excitation(
    recording: Recording, rig: Rig, without: Sequence[str]
) -> tuple[RawChannel | None, float | None, list[str]]:
    if rig.excitation is None or rig.excitation.name in without:
        return None, None, []
    quantity = Measured.of(rig.excitation).quantity
    called = [c for c in recording.channels if _is_called(c.tag, rig.excitation, rig.sensors, quantity)]
    if len(called) > 1:
        raise _duplicate(recording.file, f"the excitation {rig.excitation.name}", [c.tag for c in called])
    if called:
        return called[0], _place(called[0].tag, recording, rig), []
    forces = [c for c in recording.channels if quantity == "force" and _may_be_excitation(c.tag, rig)]
    if len(forces) > 1:
        raise InputError(
            f"{recording.file}: the channels {', '.join(c.tag.shown for c in forces)} are forces",
            f"a record has one: the rig's {rig.excitation.name} (node {rig.excitation.node}), or the only force",
            "remove the others, or name the one like the rig's excitation",
        )
    if forces:
        tag = forces[0].tag
        guess = (
            f"{recording.file}: channel {tag.shown}, the only force, is taken as the excitation {rig.excitation.name}"
        )
        return forces[0], _place(tag, recording, rig), [guess]
    named = next((c for c in recording.channels if _is_named(c.tag, rig.excitation)), None)
    if named is not None and sensor_of(named.tag, rig.sensors) is None:
        # Its unit is that of another quantity, which is told when it is converted.
        return named, _place(named.tag, recording, rig), []
    return None, None, [f"{recording.file}: no channel for the excitation {rig.excitation.name}; read as a free decay"]


def _may_be_excitation(tag: Tag, rig: Rig) -> bool:
    if tag.node is None and sensor_of(tag, rig.sensors) is not None:
        return False
    return quantity_of(tag) == "force"


def _is_called(tag: Tag, excitation: Excitation, sensors: Sequence[Sensor], quantity: str) -> bool:
    found = quantity_of(tag)
    if found not in (None, quantity):
        return False
    if _is_named(tag, excitation):
        return True
    # A sensor at the drive point may carry the same node; without a quantity the channel is the sensor's.
    shared = any(sensor.node == tag.node and found in (None, sensor.quantity) for sensor in sensors)
    return tag.node is not None and tag.node == excitation.node and not shared


def _is_named(tag: Tag, excitation: Excitation) -> bool:
    return tag.name is not None and identifier(tag.name) == identifier(excitation.name)


def _place(tag: Tag, recording: Recording, rig: Rig) -> float | None:
    """The record's own excitation position, from the file's words or its node."""
    position = recording.excitation_position
    if position is None:
        return locate(tag, rig, recording.file)
    length = getattr(rig.structure, "length", None)
    if length is None or not 0 < position <= length:
        span = (
            "there is none on an oscillator" if length is None else f"a position lies within the beam, 0 to {length} m"
        )
        raise InputError(f"{recording.file}: excitation_position = {position} m", span, "correct it in the file")
    assert rig.excitation is not None
    return None if position == rig.excitation.position else position


def _duplicate(file: str, part: str, tags: Sequence[Tag]) -> InputError:
    return InputError(
        f"{file}: {len(tags)} channels match {part}: {', '.join(tag.shown for tag in tags)}",
        "one channel belongs to one part of the rig",
        "remove or rename the others (of several directions, keep the bending one)",
    )
