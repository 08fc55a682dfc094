"""A sleeve as a ring of steel: its mesh, for the eye and for its inertia."""

from typing import Any

import trimesh
from trimesh.transformations import rotation_matrix

WALL = 0.25
"""Thickness of the wall, as a share of the inner radius."""

WIDTH = 1.0
"""Length along the beam, as a share of the inner radius."""

SECTIONS = 96
"""Corners around; the polygon's area is 0.07 % below the circle's."""


def sleeve_mesh(inner: float, wall: float | None = None, width: float | None = None) -> Any:
    """A watertight ring around the x axis, its centre in the origin.

    Args:
        inner: radius of the hole, m.
        wall: thickness, m; by default ``WALL`` of the inner radius.
        width: m; by default ``WIDTH`` of the inner radius.
    """
    ring = trimesh.creation.annulus(
        inner,
        inner + (WALL * inner if wall is None else wall),
        WIDTH * inner if width is None else width,
        sections=SECTIONS,
    )
    ring.apply_transform(rotation_matrix(1.5707963267948966, [0.0, 1.0, 0.0]))
    return ring
