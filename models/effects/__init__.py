"""The library of physical effects: one file each, and one line here.

The registry is a plain dict; a caller may pass its own wherever effects are built or judged.
"""

from collections.abc import Mapping

from models.effects.absorber import Absorber
from models.effects.axial_load import AxialLoad
from models.effects.base_motion import BaseMotion
from models.effects.bouc_wen import BoucWen
from models.effects.breathing_crack import BreathingCrack
from models.effects.build import build_effect, entry_of
from models.effects.clamp_compliance import ClampCompliance
from models.effects.clearance import Clearance
from models.effects.contact_stiffness import ContactStiffness
from models.effects.coulomb_friction import CoulombFriction
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.end_stop import EndStop
from models.effects.force_gain import ForceGain
from models.effects.gap_offset import GapOffset
from models.effects.hertz_contact import HertzContact
from models.effects.hunt_crossley import HuntCrossley
from models.effects.local_damage import LocalDamage
from models.effects.mains_hum import MainsHum
from models.effects.modal_damping import ModalDamping
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.point_stiffness import PointStiffness
from models.effects.protocol import Effect, Place
from models.effects.quadratic_drag import QuadraticDrag
from models.effects.quadratic_stiffness import QuadraticStiffness
from models.effects.sensor_delay import SensorDelay
from models.effects.sensor_gain import SensorGain
from models.effects.sensor_position import SensorPosition
from models.effects.sensor_swap import SensorSwap
from models.effects.squeeze_film import SqueezeFilm
from models.effects.stiffness_drift import StiffnessDrift
from models.effects.structural_damping import StructuralDamping
from models.effects.time_varying_damping import TimeVaryingDamping
from models.effects.wear import Wear
from models.effects.youngs_modulus import YoungsModulus

Registry = Mapping[str, type[Effect]]

EFFECTS: dict[str, type[Effect]] = {
    "clearance": Clearance,
    "gap_offset": GapOffset,
    "contact_stiffness": ContactStiffness,
    "hertz_contact": HertzContact,
    "hunt_crossley": HuntCrossley,
    "squeeze_film": SqueezeFilm,
    "coulomb_friction": CoulombFriction,
    "quadratic_stiffness": QuadraticStiffness,
    "cubic_stiffness": CubicStiffness,
    "end_stop": EndStop,
    "bouc_wen": BoucWen,
    "point_stiffness": PointStiffness,
    "point_damping": PointDamping,
    "point_mass": PointMass,
    "absorber": Absorber,
    "clamp_compliance": ClampCompliance,
    "axial_load": AxialLoad,
    "local_damage": LocalDamage,
    "breathing_crack": BreathingCrack,
    "modal_damping": ModalDamping,
    "structural_damping": StructuralDamping,
    "quadratic_drag": QuadraticDrag,
    "youngs_modulus": YoungsModulus,
    "time_varying_damping": TimeVaryingDamping,
    "stiffness_drift": StiffnessDrift,
    "wear": Wear,
    "sensor_gain": SensorGain,
    "sensor_delay": SensorDelay,
    "sensor_position": SensorPosition,
    "sensor_swap": SensorSwap,
    "mains_hum": MainsHum,
    "force_gain": ForceGain,
    "base_motion": BaseMotion,
}

__all__ = ["EFFECTS", "Effect", "Place", "Registry", "build_effect", "entry_of"]
