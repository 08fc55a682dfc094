"""A rig file whose sensitivities, contact laws and effects fit: more than reading it asks for."""

from collections.abc import Iterator
from pathlib import Path

from models.effects import EFFECTS, build_effect
from models.errors import InputError, in_file
from models.plant import contact_of
from models.rig import Rig
from models.rig_file import read_rig
from testbed.records.units import check_sensitivities


def whole_rig(path: Path) -> Rig:
    """The rig that a file describes, with sensitivities, laws and effects that can be used.

    Args:
        path: the rig file.

    Raises:
        InputError: the file cannot be read, or the first thing in it that does not fit, told with the file.
    """
    rig = read_rig(path)
    with in_file(path.name):
        for fault in rig_faults(rig):
            raise fault
    return rig


def rig_faults(rig: Rig) -> Iterator[InputError]:
    """Sensitivities of another quantity; laws and effects that the library does not have, or not there.

    Args:
        rig: as its file describes it.
    """
    try:
        check_sensitivities(rig)
    except InputError as error:
        yield error
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
