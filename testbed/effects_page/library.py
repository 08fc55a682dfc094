"""What the library says of its kinds, as JSON."""

from collections.abc import Sequence

from models.effects import EFFECTS
from models.errors import InputError
from models.rig_checks import nearest
from testbed.outputs import Json


def chosen(names: Sequence[str]) -> list[str]:
    """The kinds that were named, or all of them.

    Args:
        names: as typed.

    Raises:
        InputError: a name that the library does not have.
    """
    for name in names:
        if name not in EFFECTS:
            near = nearest(name, list(EFFECTS))
            raise InputError(
                f"{name}: no such effect",
                f"the library has {', '.join(sorted(EFFECTS))}",
                f"did you mean {near}?" if near else "name one of them",
            )
    return list(dict.fromkeys(names)) or list(EFFECTS)


def library_json(kinds: Sequence[str]) -> Json:
    """What the library says of its kinds, by name.

    Args:
        kinds: of the library.
    """
    return {kind: _kind_json(kind) for kind in kinds}


def _kind_json(kind: str) -> Json:
    cls = EFFECTS[kind]
    return {
        "family": cls.family,
        "places": cls.places,
        "structures": cls.structures,
        "options": cls.options,
        "parameters": {
            name: {"symbol": about.symbol, "unit": about.unit, "lower": about.lower, "upper": about.upper}
            for name, about in cls.parameters().items()
        },
        "signature": vars(cls.signature),
        "source": cls.source,
    }
