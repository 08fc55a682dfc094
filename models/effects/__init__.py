"""The library of physical effects: one file each, and one line here.

The registry is a plain dict; a caller may pass its own wherever effects are built or judged.
"""

from collections.abc import Mapping

from models.effects.bouc_wen import BoucWen
from models.effects.build import build_effect, entry_of
from models.effects.clamp_compliance import ClampCompliance
from models.effects.clearance import Clearance
from models.effects.contact_stiffness import ContactStiffness
from models.effects.coulomb_friction import CoulombFriction
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.force_gain import ForceGain
from models.effects.gap_offset import GapOffset
from models.effects.hunt_crossley import HuntCrossley
from models.effects.modal_damping import ModalDamping
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.point_stiffness import PointStiffness
from models.effects.protocol import Effect, Place
from models.effects.sensor_gain import SensorGain
from models.effects.squeeze_film import SqueezeFilm
from models.effects.time_varying_damping import TimeVaryingDamping
from models.effects.youngs_modulus import YoungsModulus

Registry = Mapping[str, type[Effect]]

EFFECTS: dict[str, type[Effect]] = {
    "clearance": Clearance,
    "gap_offset": GapOffset,
    "contact_stiffness": ContactStiffness,
    "hunt_crossley": HuntCrossley,
    "squeeze_film": SqueezeFilm,
    "coulomb_friction": CoulombFriction,
    "cubic_stiffness": CubicStiffness,
    "bouc_wen": BoucWen,
    "point_stiffness": PointStiffness,
    "point_damping": PointDamping,
    "point_mass": PointMass,
    "clamp_compliance": ClampCompliance,
    "modal_damping": ModalDamping,
    "youngs_modulus": YoungsModulus,
    "time_varying_damping": TimeVaryingDamping,
    "sensor_gain": SensorGain,
    "force_gain": ForceGain,
}

__all__ = ["EFFECTS", "Effect", "Place", "Registry", "build_effect", "entry_of"]
