"""A rig file whose contact laws and effects the library has, and has there: more than reading it asks for."""

from collections.abc import Iterator
from pathlib import Path

from models.effects import EFFECTS, build_effect
from models.errors import InputError, in_file
from models.plant import contact_of
from models.rig import Rig
from models.rig_file import read_rig


def whole_rig(path: Path) -> Rig:
    """The rig that a file describes, with laws and effects that can be computed.

    Args:
        path: the rig file.

    Raises:
        InputError: the file cannot be read, or the first law or effect that does not fit, told with the file.
    """
    rig = read_rig(path)
    with in_file(path.name):
        for fault in rig_faults(rig):
            raise fault
    return rig


def rig_faults(rig: Rig) -> Iterator[InputError]:
    """Laws and effects that the library does not have, or not there.

    Args:
        rig: as its file describes it.
    """
    for sleeve in rig.sleeves:
        try:
            contact_of(sleeve)
        except InputError as error:
            yield error
    for entry in rig.effects:
        try:
            build_effect(entry, rig, EFFECTS)
        except InputError as error:
            yield error
