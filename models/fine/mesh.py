"""Where the finite-element nodes lie: on every named place, close enough together everywhere."""

from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from models.arrays import FloatArray

SHORTEST = 0.2
"""Shortest element as a share of the longest; stiffness grows with the inverse cube, so shorter ones cost digits."""


def place_nodes(length: float, named: Iterable[float], n_elements: int) -> FloatArray:
    """Nodes of a mesh with one on every named place.

    Args:
        length: of the beam, m.
        named: places that want a node, m, the most important first; one that lies too close to the node of an earlier
            one gets none of its own and is reached by the elements' cubic shapes.
        n_elements: the longest element is the length over this.

    Returns:
        (n_nodes,) m, from 0 to the length.
    """
    longest = length / n_elements
    fixed = [0.0, length]
    for place in named:
        if min(abs(place - other) for other in fixed) >= SHORTEST * longest:
            fixed.append(place)
    fixed.sort()
    pieces = [
        np.linspace(start, end, int(np.ceil((end - start) / longest - 1e-9)) + 1)[:-1] for start, end in pairwise(fixed)
    ]
    return np.concatenate([*pieces, [length]])
