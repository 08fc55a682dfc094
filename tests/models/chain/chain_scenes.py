"""Chains of the reference beam, and what beam theory says of it."""

from pathlib import Path

import numpy as np

from models.arrays import FloatArray
from models.chain.mjcf import ChainSettings
from models.chain.rig_chain import RigChain, build_chain
from models.effects import EFFECTS, build_effect
from models.plant import Plant, build_plant
from models.rig import EffectEntry, Rig, Sleeve
from models.rig_file import read_rig
from models.structure import Structure

REFERENCE = read_rig(Path(__file__).parents[2] / "data" / "reference_rig.toml")
STRUCTURE = Structure.of(REFERENCE.structure)
LENGTH, EI, LINE_MASS = STRUCTURE.length, STRUCTURE.bending_stiffness, STRUCTURE.line_mass
STATIC = ChainSettings(1e-4, 0.0, rotary_inertia=False)


def bare(gravity: float = 0.0, *sleeves: Sleeve, **changes) -> Rig:
    """The reference beam without its sleeves, or with others."""
    structure = REFERENCE.structure.model_copy(update={"gravity": gravity, **changes})
    return REFERENCE.model_copy(update={"structure": structure, "sleeves": sleeves})


def with_ports(rig: Rig, *places: float) -> Plant:
    """The rig with a dashpot, so that it is a port, at each place."""
    entries = [EffectEntry(kind="point_damping", position=at, damping=1.0) for at in places]
    return build_plant(rig, [build_effect(entry, rig, EFFECTS) for entry in entries])


def chain_of(plant: Plant, n: int, settings: ChainSettings = STATIC) -> RigChain:
    """The plant as n segments."""
    return build_chain(plant, n, settings)


def flexibility(x: FloatArray) -> FloatArray:
    """(n, n) deflection of a cantilever at a place by a force at another: a^2 (3 b - a) / (6 E I), a <= b."""
    a, b = np.minimum.outer(x, x), np.maximum.outer(x, x)
    return a**2 * (3.0 * b - a) / (6.0 * EI)
