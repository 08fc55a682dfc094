"""Cables of the reference beam."""

from pathlib import Path

from models.cable.build import build_cable
from models.cable.course import Course
from models.cable.rig_cable import RigCable
from models.plant import Plant
from models.rig import Rig, Sleeve
from models.rig_file import read_rig
from models.structure import Structure

REFERENCE = read_rig(Path(__file__).parents[2] / "data" / "reference_rig.toml")
STRUCTURE = Structure.of(REFERENCE.structure)
LENGTH, EI, LINE_MASS = STRUCTURE.length, STRUCTURE.bending_stiffness, STRUCTURE.line_mass


def bare_beam(gravity: float, *sleeves: Sleeve, **changes) -> Rig:
    """The reference beam with other sleeves and numbers."""
    structure = REFERENCE.structure.model_copy(update={"gravity": gravity, **changes})
    return REFERENCE.model_copy(update={"structure": structure, "sleeves": sleeves})


def still_cable(plant: Plant, n: int, held_at: float | None = None) -> RigCable:
    """The plant as n elements that nothing drives."""
    return build_cable(plant, n, Course(), held_at)
