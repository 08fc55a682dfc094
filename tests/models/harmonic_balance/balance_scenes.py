"""An oscillator with a closed form, and a beam that strikes two sleeves."""

from pathlib import Path

import numpy as np

from models.rig import Excitation, Oscillator, Rig, Sensor, Sleeve
from models.rig_file import read_rig

MASS, STIFFNESS, DAMPING, CUBIC = 1.0, (2 * np.pi * 10.0) ** 2, 1.2, 5e7
OSCILLATOR = Rig(
    structure=Oscillator(kind="oscillator", mass=MASS, stiffness=STIFFNESS, damping=DAMPING),
    excitation=Excitation(),
    sensors=(Sensor(name="mass", quantity="displacement"),),
)

REFERENCE = read_rig(Path(__file__).parents[2] / "data" / "reference_rig.toml")
LENGTH = REFERENCE.structure.length


def sleeved(gravity: float = 0.0, excitation: str = "force") -> Rig:
    """The reference beam in two other sleeves, with three kinds of sensors."""
    places = ((0.3 * LENGTH, "acceleration"), (LENGTH, "displacement"), (0.7 * LENGTH, "angular_velocity"))
    changes = {
        "structure": REFERENCE.structure.model_copy(update={"gravity": gravity}),
        "sleeves": tuple(
            Sleeve(name=name, position=share * LENGTH, clearance=gap, stiffness=1e5, damping=80.0)
            for name, share, gap in (("inner", 0.4, 2e-4), ("outer", 0.8, 3e-4))
        ),
        "sensors": tuple(Sensor(name=quantity, position=place, quantity=quantity) for place, quantity in places),
    }
    if excitation != "force":
        changes["excitation"] = Excitation(quantity=excitation)
    return REFERENCE.model_copy(update=changes)


def names(rig: Rig) -> list[str]:
    """Of the sensors."""
    return [sensor.name for sensor in rig.sensors]
