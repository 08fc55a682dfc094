"""The simulators by name; an engine is loaded when it is asked for, since each takes a second or more to import."""

from collections.abc import Mapping
from functools import cache
from importlib import import_module

from models.errors import InputError
from models.rig_checks import nearest
from models.simulators.protocol import Simulator

SIMULATORS: Mapping[str, tuple[str, str]] = {
    "modal": ("models.simulators.modal", "Modal"),
    "mujoco": ("models.simulators.mujoco", "Mujoco"),
    "exudyn": ("models.simulators.exudyn", "Exudyn"),
}
"""Module and class of each."""


@cache
def simulator(name: str) -> Simulator:
    """One of the simulators.

    Args:
        name: a key of ``SIMULATORS``.

    Raises:
        InputError: there is none of that name, or its engine is not installed.
    """
    if name not in SIMULATORS:
        near = nearest(name, SIMULATORS)
        mend = f"did you mean {near!r}?" if near else "choose one of them; docs/extending.md says how one is added"
        raise InputError(f"simulator = {name!r}", f"the simulators are {', '.join(SIMULATORS)}", mend)
    module, owner = SIMULATORS[name]
    try:
        made: Simulator = getattr(import_module(module), owner)()
    except ModuleNotFoundError as missing:
        raise InputError(
            f"simulator = {name!r}: the package {missing.name!r} is not installed",
            f"{name} runs in its own engine",
            "pip install -r requirements.lock",
        ) from missing
    return made


__all__ = ["SIMULATORS", "Simulator", "simulator"]
