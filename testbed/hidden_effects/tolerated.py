"""Effects that are a toleranced number of the rig by another name, moved no further than a calibration may move it."""

from identification.hypothesis import LARGEST_SIGMA
from models.contact.hunt_crossley import HuntCrossley as HuntCrossleyLaw
from models.effects import Effect
from models.effects.clearance import Clearance
from models.effects.contact_stiffness import ContactStiffness
from models.effects.hunt_crossley import HuntCrossley
from models.effects.youngs_modulus import YoungsModulus
from models.rig import Beam, Rig


def tolerated(effect: Effect, rig: Rig, built: Rig) -> bool:
    """Whether a calibration within the tolerances makes the effect good, so that nothing is missing.

    Args:
        effect: that the description lacks.
        rig: as its owner describes it.
        built: with its toleranced numbers as they are.
    """
    numbers = {parameter.path: parameter for parameter in rig.parameters()}
    path, value = _number(effect, built)
    return path in numbers and value > 0.0 and abs(numbers[path].deviations(value)) <= LARGEST_SIGMA


def _number(effect: Effect, built: Rig) -> tuple[str, float]:
    """Path and value of the number that the effect makes of one of the rig's; of other kinds no path."""
    if isinstance(effect, YoungsModulus):
        assert isinstance(built.structure, Beam)
        return "youngs_modulus", effect.ratio * built.structure.youngs_modulus
    for index, sleeve in enumerate(built.sleeves):
        if sleeve.name != effect.place.sleeve:
            continue
        if isinstance(effect, Clearance):
            return f"sleeves[{index}].clearance", effect.clearance
        if isinstance(effect, ContactStiffness) and sleeve.stiffness is not None:
            return f"sleeves[{index}].stiffness", effect.ratio * sleeve.stiffness
        if isinstance(effect, HuntCrossley) and sleeve.law == HuntCrossleyLaw.name:
            return f"sleeves[{index}].damping", effect.dissipation
    return "", 0.0
