"""A rig as built: its toleranced numbers a little off the drawing."""

import numpy as np

from models.rig import Rig

FARTHEST = 2.0
"""Largest departure from the drawing in standard deviations of the tolerance."""


def perturbed(rig: Rig, rng: np.random.Generator) -> Rig:
    """The rig with every toleranced number drawn from a normal distribution about its value, cut at two deviations.

    Args:
        rig: as its owner describes it.
        rng: draws the numbers.
    """
    values = {}
    for parameter in rig.parameters():
        draw = rng.standard_normal()
        while abs(draw) > FARTHEST:
            draw = rng.standard_normal()
        values[parameter.path] = parameter.value + draw * parameter.std
    return rig.with_values(values)
