"""The state at rest of a discretised plant, found in its own coordinates."""

import numpy as np

from models.arrays import FloatArray
from models.errors import NoRestError
from models.point_forces import PointForce, Stretch
from models.ports import Port

TOLERANCE = 1e-13
"""Largest change of a port's position in the last iteration, m."""

MAX_ITERATIONS = 200

SMALLEST_SHARE = 1e-9
"""Of a Newton step; where even less of it brings no gain, round-off is reached or the search continues elsewhere."""


def forces_at(place: FloatArray, ports: tuple[Port | Stretch, ...], forces: tuple[PointForce, ...]) -> FloatArray:
    """(n_ports,) forces on the structure, N, where the ports stand still at a place, (n_ports,) m."""
    total, index = np.zeros(len(ports)), {port: i for i, port in enumerate(ports)}
    for force in forces:
        i = index[force.port]
        total[i] += force.at_rest(float(place[i]))
    return total


def find_rest(
    omega: FloatArray,
    weight: FloatArray,
    rows: FloatArray,
    ports: tuple[Port | Stretch, ...],
    forces: tuple[PointForce, ...],
    origin: FloatArray | float = 0.0,
) -> FloatArray:
    """(n,) coordinates where omega^2 q = weight + rows' F, by Newton's method with step control.

    Args:
        omega: (n,) rad/s.
        weight: (n,) generalised force of gravity.
        rows: (n_ports, n) motion of the ports.
        ports: of the rows.
        forces: what acts there.
        origin: (n_ports,) place of the ports at q = 0, m.

    Raises:
        NoRestError: none is found.
    """

    def slopes(q: FloatArray) -> FloatArray:
        place = origin + rows @ q
        nudge = 1e-9 * (1.0 + np.abs(place))  # each law sees its own port only, so all are nudged at once
        return (forces_at(place + nudge, ports, forces) - forces_at(place, ports, forces)) / nudge

    def unbalance(q: FloatArray) -> FloatArray:
        return np.asarray(weight + rows.T @ forces_at(origin + rows @ q, ports, forces) - omega**2 * q)

    q = np.zeros(len(omega))
    held = np.abs(rows.T * slopes(q)).sum(axis=1)
    scale = 1.0 / np.sqrt(omega**2 + 1e-3 * held + 1e-9)  # residuals in units of energy, not of stiff high modes
    for _ in range(MAX_ITERATIONS):
        now = unbalance(q)
        if not np.any(now):
            return q
        tangent = np.diag(omega**2) - (rows.T * slopes(q)) @ rows
        step = scale * np.linalg.lstsq(tangent * np.outer(scale, scale), now * scale, rcond=1e-15)[0]
        share, size = 1.0, np.linalg.norm(now * scale)
        while np.linalg.norm(unbalance(q + share * step) * scale) > size and share > SMALLEST_SHARE:
            share *= 0.5
        q = np.asarray(q + share * step)
        if np.abs(rows @ step).max(initial=0.0) < TOLERANCE:
            return q
    raise NoRestError(
        "the state at rest: no equilibrium was found",
        "the structure rests where gravity, sleeves and effects balance",
        "look for a stiffness that is negative or an offset larger than the structure can reach",
    )
