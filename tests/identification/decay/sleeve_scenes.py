"""Rigs at rest whose sleeves damp them, for the tests of what damping ratios tell of a sleeve."""

from pathlib import Path

import numpy as np

from models.contact.kelvin_voigt import KelvinVoigt
from models.linear import linearised
from models.modal import build_modal
from models.plant import Plant, build_plant
from models.ports import Contact
from models.rig import Oscillator
from models.rig_file import read_rig
from models.structure import Structure

REFERENCE = read_rig(Path(__file__).parents[2] / "data" / "reference_rig.toml")
"""Its sleeve 2 touches at rest, its sleeve 1 does not."""

BAND = 880.0
MASS, STIFFNESS, OWN = 3.0, 1000.0, 1.2
SPRING, DASHPOT = 2000.0, 4.0


def reference(*, closed=False):
    """The reference rig at rest; with ``closed`` both sleeves have no clearance."""
    rig = REFERENCE
    if closed:
        rig = rig.model_copy(update={"sleeves": tuple(s.model_copy(update={"clearance": 0.0}) for s in rig.sleeves)})
    return linearised(build_modal(build_plant(rig), BAND))


def stopped_mass(dashpot=DASHPOT):
    """One mass on a spring and in a stop without clearance: 3 kg on 3000 N/m with 1.2 and ``dashpot`` N s/m."""
    structure = Structure.of(Oscillator(kind="oscillator", mass=MASS, stiffness=STIFFNESS, damping=OWN, gravity=0.0))
    plant = Plant(structure, (Contact("stop", None, KelvinVoigt(SPRING, dashpot), 0.0),), (), None, (), ())
    return linearised(build_modal(plant, 100.0))


def omega():
    """rad/s of the stopped mass."""
    return np.sqrt((STIFFNESS + SPRING) / MASS)


def ratio_of(damping):
    """Damping ratio of the stopped mass whose stop damps with so many N s/m."""
    return (OWN + np.asarray(damping)) / (2.0 * MASS * omega())
