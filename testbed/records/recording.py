"""What a file holds, before the rig is consulted: raw channels in the file's own units, names and node numbers."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from models.arrays import AnyArray, ComplexArray, FloatArray


@dataclass(frozen=True)
class Tag:
    """How a file calls one channel.

    Attributes:
        name: as written, or None.
        node: node number, or None where the format has none.
        sign: -1 where the file says that the channel counts against the axis.
        unit: the file's own label, or None.
        quantity: acceleration, velocity, displacement, angular_velocity or force, where the file says it elsewhere.
    """

    name: str | None = None
    node: int | None = None
    sign: int = 1
    unit: str | None = None
    quantity: str | None = None

    @property
    def shown(self) -> str:
        """The channel as an error calls it."""
        node = None if self.node is None else f"node {self.node}"
        return " at ".join(part for part in (self.name, node) if part) or "without name"


_HEADING = re.compile(r"\s*(.*?)\s*(?:\[([^\[\]]*)\])?\s*")


def headed(text: str) -> Tag:
    """A channel by a heading ``name [unit]``, either of which may be missing.

    Args:
        text: as the file has it.
    """
    match = _HEADING.fullmatch(text)
    name, unit = (match[1], match[2]) if match else (text.strip(), None)
    return Tag(name=name or None, unit=unit.strip() or None if unit else None)


@dataclass(frozen=True, eq=False)
class RawChannel:
    """One channel: its tag and (N,) samples as the file holds them, without the sign."""

    tag: Tag
    data: AnyArray


@dataclass(frozen=True, eq=False)
class Recording:
    """A time record's file.

    Attributes:
        file: its name, which begins every error.
        channels: all that may be channels; in one that is to be written, the excitation comes first.
        fs: sampling rate, Hz, where the file says it.
        time: (N,) time base, where the file holds one.
        time_unit: unit of ``time``; seconds where None.
        excitation_position: m from the clamp, where the file says it.
        unlabelled: quantity -> SI factor of channels without unit, where the file says it for all.
        remarks: what the reader passed over.
    """

    file: str
    channels: tuple[RawChannel, ...]
    fs: float | None = None
    time: FloatArray | None = None
    time_unit: str | None = None
    excitation_position: float | None = None
    unlabelled: Mapping[str, float] = field(default_factory=dict)
    remarks: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class RawFrf:
    """One measured FRF: who responded, who excited, (n,) complex values, and (n,) coherence where the file has it."""

    response: Tag
    reference: Tag
    values: ComplexArray
    coherence: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class FrfRecording:
    """A file of FRFs over one frequency axis, Hz; ``unlabelled`` as in ``Recording``."""

    file: str
    frequency: FloatArray
    frfs: tuple[RawFrf, ...]
    unlabelled: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class ModeRecording:
    """A file of mode shapes.

    Attributes:
        file: its name.
        nodes: (n_nodes,) node numbers.
        natural_freqs: (n,) Hz.
        damping_ratios: (n,), 0 where the file has none.
        shapes: (n, n_nodes) complex.
    """

    file: str
    nodes: tuple[int, ...]
    natural_freqs: FloatArray
    damping_ratios: FloatArray
    shapes: ComplexArray


AnyRecording = Recording | FrfRecording | ModeRecording


def identifier(name: str) -> str:
    """The name as a variable of MATLAB can carry it: letters, digits and underscores, a letter first."""
    cleaned = re.sub(r"\W", "_", name, flags=re.ASCII)
    return cleaned if cleaned[:1].isalpha() else f"x{cleaned}"
