"""The ball in Exudyn: a mass in one direction, with our laws as they act on the cable."""

from typing import Any

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    MarkerNodeCoordinate,
    Mass1D,
    Node1D,
    NodePointGround,
    ObjectConnectorCoordinateSpringDamper,
)

from models.ball.ball import Ball, Strike
from models.cable.moving import in_time, solved
from models.cable.port_law import PortLaw
from models.errors import DivergenceError
from models.point_forces import forces_on_structure

AT_ONCE = 1000
"""Steps after which it is asked whether the ball is back."""


def strike(ball: Ball) -> Strike:
    """One strike.

    Args:
        ball: on its way.

    Raises:
        DivergenceError: Exudyn gave up.
    """
    container = exu.SystemContainer()
    system = container.AddSystem()
    ground = system.AddNode(NodePointGround(referenceCoordinates=[0.0, 0.0, 0.0]))
    node = system.AddNode(Node1D(referenceCoordinates=[0.0], initialVelocities=[ball.speed]))
    system.AddObject(Mass1D(mass=ball.mass, nodeNumber=node))
    markers = [system.AddMarker(MarkerNodeCoordinate(nodeNumber=number, coordinate=0)) for number in (ground, node)]
    forces = forces_on_structure(ball.plant)
    law = PortLaw(forces, ball.step)
    stop = [force.contact is not None for force in forces].index(True)

    def felt(mbs: Any, t: float, item: int, q: float, v: float, *rest: float) -> float:  # noqa: ARG001
        return -law(t, q, v)

    asked: Any = felt
    system.AddObject(ObjectConnectorCoordinateSpringDamper(markerNumbers=markers, springForceUserFunction=asked))
    system.Assemble()
    rows = [(0.0, 0.0, ball.speed, 0.0)]

    def keep(mbs: Any, t: float) -> bool:  # noqa: ARG001
        (q,), (v,) = system.systemData.GetODE2Coordinates(), system.systemData.GetODE2Coordinates_t()
        rows.append((t, float(q), float(v), -law.felt[stop]))
        return True

    system.SetPostStepUserFunction(keep)
    settings = in_time(AT_ONCE, ball.step)
    for _ in range(ball.n_steps // AT_ONCE):
        if not solved(lambda: system.SolveDynamic(settings, showHints=False, updateInitialValues=True)):
            raise DivergenceError(f"exudyn: the ball was lost {rows[-1][0]:.4g} s after the start")
        settings.timeIntegration.startTime = rows[-1][0]
        settings.timeIntegration.endTime = rows[-1][0] + AT_ONCE * ball.step
        if rows[-1][1] <= 0.0 and rows[-1][2] < 0.0:
            break
    return Strike.until_back(ball, np.array(rows).T)
