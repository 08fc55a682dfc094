"""What stands in a rig file for an effect of a kind: one complete table, with numbers that a rig could have."""

from functools import cache
from typing import Any

from models.effects import Effect, Place, entry_of
from models.effects.protocol import Scene
from models.plant import Plant, build_plant
from models.rig_file import read_rig
from testbed.effects_page.bench import OSCILLATOR, SHIPPED_RIG

DISPLACEMENT, VELOCITY, FORCE, PENETRATION, DURATION, HUM = 5e-4, 0.05, 3.0, 2e-5, 8.0, 50.0
"""m, m/s, N, m, s, Hz: of a test as the demonstration's."""

DIGITS = 3


def table_of(kind: type[Effect]) -> str:
    """The ``[[effects]]`` table of a kind on the reference rig, or on an oscillator, as TOML.

    Args:
        kind: of the library.
    """
    trials = list(kind.trials(_scene(kind)))
    content: dict[str, Any] = entry_of(trials[len(trials) // 2]).model_dump(exclude_none=True)
    return "\n".join(["[[effects]]", *(f"{key} = {_toml(value)}" for key, value in content.items())])


@cache
def _plant(kind: str) -> Plant:
    return build_plant(read_rig(SHIPPED_RIG) if kind == "beam" else OSCILLATOR)


def _scene(kind: type[Effect]) -> Scene:
    plant = _plant(kind.structures[0])
    contact = plant.contacts[-1] if "sleeve" in kind.places else None
    place, position = Place(), None
    if contact is not None:
        place = Place(sleeve=contact.sleeve, position=contact.position)
    elif "position" in kind.places and plant.structure.is_beam:
        place = Place(position=0.83)
    elif "sensor" in kind.places:
        place, position = Place(sensor=plant.sensors[-1].name), plant.sensors[-1].position
    elif "sensor pair" in kind.places:
        first, second = plant.sensors[-2:]
        place = Place(sensor=first.name, other=second.name)
    return Scene(
        place=place, contact=contact, structure=plant.structure, displacement=DISPLACEMENT, velocity=VELOCITY,
        force=FORCE, penetration=PENETRATION, duration=DURATION, driven_base=False, ground_velocity=VELOCITY,
        natural_freqs=(25.6, 48.2, 123.0), sensor_position=position, lines=(HUM,),
    )  # fmt: skip


def _toml(value: Any) -> str:
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, list | tuple):
        return f"[{', '.join(_toml(item) for item in value)}]"
    text = f"{float(value):.{DIGITS}g}"
    return text if any(letter in text for letter in ".e") else f"{text}.0"
