"""A mass that strikes one stop, moved by each simulator: what a contact law does where nothing else is in the way."""

from collections.abc import Callable, Mapping
from importlib import import_module

from models.ball.ball import Ball, Strike

STRIKES: Mapping[str, str] = {
    "modal": "models.ball.modal",
    "mujoco": "models.ball.mujoco",
    "exudyn": "models.ball.exudyn",
}
"""Module of each simulator, whose engine is loaded when it is asked for."""


def striker(simulator: str) -> Callable[[Ball], Strike]:
    """How a simulator lets a ball strike.

    Args:
        simulator: a key of ``STRIKES``.
    """
    strike: Callable[[Ball], Strike] = import_module(STRIKES[simulator]).strike
    return strike


__all__ = ["STRIKES", "Ball", "Strike", "striker"]
