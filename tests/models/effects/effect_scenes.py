"""A beam and an oscillator to put effects on, what moves there, and a law as the time stepper calls it."""

import ctypes
from collections.abc import Iterable
from dataclasses import replace

from models.contact.kelvin_voigt import KelvinVoigt
from models.effects import Effect, Place
from models.effects.protocol import Scene
from models.law import LawFunction, law_address
from models.ports import Contact
from models.rig import Beam, Excitation, Oscillator, Rig, Sensor, Sleeve
from models.structure import Structure

BEAM = Rig(
    structure=Beam(
        kind="beam", length=1.5, diameter=0.02, youngs_modulus=2e11, density=7850.0, rayleigh_damping=(1.2, 6e-6)
    ),
    sleeves=(Sleeve(name="outer", position=1.0, clearance=2e-4, stiffness=1e5, damping=80.0),),
    excitation=Excitation(position=1.3),
    sensors=(Sensor(name="tip", position=1.5), Sensor(name="mid", position=0.7)),
)
OSCILLATOR = Rig(
    structure=Oscillator(kind="oscillator", mass=3.0, stiffness=1200.0, damping=0.7),
    excitation=Excitation(),
    sensors=(Sensor(name="tip"), Sensor(name="mid")),
)
RIGS = {"beam": BEAM, "oscillator": OSCILLATOR}
CONTACT = Contact("outer", 1.0, KelvinVoigt(1e5, 80.0), clearance=2e-4)
PLACES = {
    "sleeve": Place(sleeve="outer", position=1.0),
    "position": Place(position=0.7),
    "sensor": Place(sensor="mid"),
    "sensor pair": Place(sensor="tip", other="mid"),
}


def places_of(cls: type[Effect], structure: str) -> list[Place]:
    """Where an effect can sit on the beam or the oscillator."""
    allowed = [kind for kind in cls.places if structure == "beam" or kind == "sensor"]
    return [PLACES[kind] for kind in allowed] or [Place()]


def scene_at(place: Place, structure: str = "beam", amplitude: float = 1.0, **changes) -> Scene:
    """What moves at a place; ``amplitude`` scales motion, force and clearance together."""
    contact = replace(CONTACT, clearance=amplitude * CONTACT.clearance) if place.sleeve else None
    plain = Scene(
        place=place,
        contact=contact,
        structure=Structure.of(RIGS[structure].structure),
        displacement=4e-4 * amplitude,
        velocity=0.03 * amplitude,
        force=5.0 * amplitude,
        penetration=2e-5 * amplitude if contact else 0.0,
        duration=4.0,
        driven_base=False,
        ground_velocity=0.05 * amplitude,
        natural_freqs=(7.0, 44.0, 123.0),
        sensor_position=0.7 if place.sensor and structure == "beam" else None,
    )
    return replace(plain, **changes)


def trials_of(cls: type[Effect]) -> list[tuple[Scene, Effect]]:
    """Every trial of an effect on both structures, at every kind of place, with a driven and a quiet base."""
    return [
        (scene, effect)
        for structure in cls.structures
        for place in places_of(cls, structure)
        for driven in (False, True)
        for scene in [scene_at(place, structure, driven_base=driven)]
        for effect in cls.trials(scene)
    ]


def as_compiled(law: LawFunction, motion: Iterable[float], p: tuple[float, ...]) -> float:
    """The law at ``motion`` = (t, q, v, z) through its address, as compiled code calls it."""
    real = ctypes.c_double
    call = ctypes.CFUNCTYPE(real, real, real, real, real, ctypes.POINTER(real))(law_address(law))
    return call(*motion, (real * len(p))(*p))
