"""The library of physical effects: one file each, and one line here.

The registry is a plain dict; a caller may pass its own wherever effects are built or judged.
"""

from collections.abc import Mapping

from models.effects.build import build_effect, entry_of
from models.effects.point_mass import PointMass
from models.effects.protocol import Effect, Place
from models.effects.sensor_gain import SensorGain
from models.effects.squeeze_film import SqueezeFilm

Registry = Mapping[str, type[Effect]]

EFFECTS: dict[str, type[Effect]] = {
    "squeeze_film": SqueezeFilm,
    "point_mass": PointMass,
    "sensor_gain": SensorGain,
}

__all__ = ["EFFECTS", "Effect", "Place", "Registry", "build_effect", "entry_of"]
