"""Units of what is measured, as labels show them."""

from models.rig import Rig
from testbed.records.units import SI_UNITS


def unit_of(quantity: str) -> str:
    """SI unit of a sensor's or an excitation's quantity.

    Args:
        quantity: as in the rig file; that of a base is that of its motion.
    """
    return SI_UNITS[quantity.removeprefix("base_")]


def frf_unit(rig: Rig, sensor: str) -> str:
    """Unit of a sensor's FRF; ``-`` where response and excitation have the same.

    Args:
        rig: with an excitation.
        sensor: name.
    """
    assert rig.excitation is not None
    return ratio_unit(unit_of(rig.sensor(sensor).quantity), unit_of(rig.excitation.quantity))


def ratio_unit(above: str, below: str) -> str:
    """The unit of one quantity per another.

    Args:
        above: unit of the response.
        below: unit of the excitation.
    """
    if above == below:
        return "-"
    return f"({above})/{below}" if "/" not in below else f"({above})/({below})"
