"""A plant as a compiled chain: its matrices, its ports, and the state at rest."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf
from typing import Any

import mujoco
import numpy as np
from scipy.linalg import eigh

from models.arrays import FloatArray
from models.chain.engine_call import engine_address
from models.chain.march import Chain, Engine, place_rows
from models.chain.mjcf import ChainSettings, build_spec, sway_of
from models.chain.native_contact import check_stops
from models.chain.segments import Segments
from models.equilibrium import find_rest, forces_at
from models.errors import InputError
from models.plant import Plant
from models.point_forces import PointForce, forces_on_structure, ports_of, round_contacts
from models.ports import Port

REST_ITERATIONS = 30
REST_TOLERANCE = 1e-12
"""Largest move of a port in the last iteration, m."""


@dataclass(frozen=True, eq=False)
class RigChain:
    """A plant in the engine, at rest.

    Attributes:
        plant: what was built.
        segments: the chain.
        model, data: the engine's own; ``data`` stands at rest.
        ports: of the point forces, contacts included.
        forces: all point forces that the engine does not know.
        rows: (n_ports, n_dofs) motion of the ports by coordinate at rest.
        rest: (n_dofs,) coordinates at rest.
        port_rest: (n_ports,) place of the ports at rest, m.
        spatial: whether it may leave the rig's plane.
    """

    plant: Plant
    segments: Segments
    model: Any
    data: Any
    ports: tuple[Port, ...]
    forces: tuple[PointForce, ...]
    rows: FloatArray
    rest: FloatArray
    port_rest: FloatArray
    spatial: bool

    @cached_property
    def mass(self) -> FloatArray:
        """(n_dofs, n_dofs) at rest, without armature."""
        full = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, full)
        return full - np.diag(self.model.dof_armature)

    @cached_property
    def tangent(self) -> FloatArray:
        """(n_dofs, n_dofs) stiffness at rest, with springs and closed sleeves."""
        nudge = 1e-9
        above = forces_at(self.port_rest + nudge, self.ports, self.forces)
        below = forces_at(self.port_rest - nudge, self.ports, self.forces)
        slope = (above - below) / (2.0 * nudge)
        for force in self.forces:
            if force.partner is not None and force.contact is not None:
                # A round contact's force turns with the place: across it, its spring is force over radius.
                at, centre = self.port_rest[self.ports.index(force.port)], force.contact[1]
                away = at - centre if at != centre else nudge
                slope[self.ports.index(force.partner)] += force.at_rest(centre + away) / away
        return np.asarray(np.diag(spring_stiffness(self.model)) - (self.rows.T * slope) @ self.rows)

    def natural_freqs(self, n: int) -> FloatArray:
        """(n,) of small undamped motion about rest, Hz."""
        square = eigh(self.tangent, self.mass, eigvals_only=True, subset_by_index=[0, n - 1])
        return np.asarray(np.sqrt(square) / (2.0 * np.pi))

    def compliance_of(self, port: Port) -> float:
        """1 / mass that a sudden force at a port meets, 1/kg."""
        row = self.rows[self.ports.index(port)]
        return float(row @ np.linalg.solve(self.mass, row))


def build_chain(plant: Plant, n: int, settings: ChainSettings) -> RigChain:
    """Build a plant in the engine and find where it rests.

    Args:
        plant: a beam with effects that the chain carries.
        n: segments.
        settings: step and inertia.

    Raises:
        InputError: no state at rest is found, or the engine has no such contact of its own.
    """
    if settings.native_contact:
        check_stops(plant)
    segments = Segments(plant.structure.length, n)
    model = build_spec(plant, segments, settings).compile()
    data = mujoco.MjData(model)
    forces = forces_on_structure(plant)
    if settings.spatial:
        forces = round_contacts(forces)
    ports = ports_of(forces)
    rows, place = _settle(model, data, readings(model, plant, segments, ports), ports, forces)
    return RigChain(plant, segments, model, data, ports, forces, rows, data.qpos.copy(), place, settings.spatial)


def held_at(chain: RigChain, position: float, force: float) -> FloatArray:
    """(n_dofs,) coordinates of a chain that a static force holds besides.

    Args:
        chain: at rest.
        position: of the force, m from the clamp.
        force: N, positive upwards.

    Raises:
        InputError: no state at rest is found.
    """
    forces = (*chain.forces, PointForce(Port(position), steady, (force,)))
    ports, data = ports_of(forces), mujoco.MjData(chain.model)
    data.qpos[:] = chain.rest
    _settle(chain.model, data, readings(chain.model, chain.plant, chain.segments, ports), ports, forces)
    return np.asarray(data.qpos.copy())


def steady(t: float, q: float, v: float, z: float, p: Sequence[float]) -> float:  # noqa: ARG001
    """A force that stays, with p = (force,)."""
    return p[0]


def _settle(
    model: Any, data: Any, chain: Chain, ports: tuple[Port, ...], forces: tuple[PointForce, ...]
) -> tuple[FloatArray, FloatArray]:
    """Put ``data`` at rest; (n_ports, n_dofs) rows of the ports there and (n_ports,) their places, m."""
    engine = engine_of(model, data)
    stiffness = spring_stiffness(model)
    place, own = np.zeros(len(ports)), np.zeros((len(ports), len(chain.dof)))
    rows = np.zeros((len(ports), model.nv))

    def look() -> None:
        mujoco.mj_forward(model, data)
        place_rows(engine, chain, own, place)
        rows[:, chain.dof] = own

    for _ in range(REST_ITERATIONS):
        look()
        q = data.qpos.copy()
        data.qpos[:] = find_rest(np.sqrt(stiffness), -data.qfrc_bias, rows, ports, forces, place - rows @ q)
        if max(np.abs(rows @ (data.qpos - q)).max(initial=0.0), np.abs(data.qpos - q).max()) < REST_TOLERANCE:
            look()
            return rows, place
    raise InputError(
        "the chain at rest: no equilibrium was found",
        "the beam rests where gravity, sleeves and effects balance",
        "look for a stiffness that is negative or a beam that bends beyond small angles",
    )


def spring_stiffness(model: Any) -> FloatArray:
    """(n_dofs,) of the joints' own springs, N m/rad or N/m."""
    return np.array(model.jnt_stiffness, float).reshape(model.njnt, -1)[:, 0]


def engine_of(model: Any, data: Any) -> Engine:
    """Views into the engine's memory; they live as long as ``data`` does."""
    return Engine(
        engine_address("mj_step1"),
        engine_address("mj_step2"),
        model._address,  # noqa: SLF001
        data._address,  # noqa: SLF001
        data.qpos,
        data.qvel,
        data.qfrc_applied,
        model.opt.gravity,
        data.xanchor,
        data.xaxis,
        data.xipos,
        data.ximat,
        data.qfrc_constraint,
    )


def readings(model: Any, plant: Plant, segments: Segments, ports: tuple[Port, ...], extra: Any = ()) -> Chain:
    """What is read of the chain: the ports, then ``extra`` places, (position, derivative) each."""
    names = [f"segment {i + 1}" for i in range(segments.n)]
    hinges = [f"hinge {i + 1}" for i in range(segments.n)]
    joints = {model.joint(i).name: model.joint(i).dofadr[0] for i in range(model.njnt)}
    clamp_turns = plant.structure.clamp_stiffness < inf
    places = [(port.position or 0.0, port.derivative) for port in ports] + list(extra)
    weights = [_weights(segments, position, derivative, clamp_turns) for position, derivative in places]
    if clamp_turns:
        names, hinges = ["clamp", *names], ["clamp", *hinges]
    width = len(names)
    turning = [(i, name) for i, hinge in enumerate(hinges) for name in (hinge, sway_of(hinge)) if name in joints]
    toward = [(1.0, 0.0) if port.across else (0.0, 1.0) for port in ports] + [(0.0, 1.0)] * len(extra)
    return Chain(
        body=np.array([model.body(name).id for name in names], np.int64),
        dof=np.array([joints[name] for _, name in turning], np.int64),
        segment=np.array([i for i, _ in turning], np.int64),
        heights=np.array([heights for heights, _ in weights]).reshape(-1, width),
        slopes=np.array([slopes for _, slopes in weights]).reshape(-1, width),
        toward=np.array(toward).reshape(-1, 2),
        damping=np.zeros((len(turning), len(turning))),
    )


def _weights(segments: Segments, position: float, derivative: int, clamp_turns: bool) -> tuple[FloatArray, FloatArray]:  # noqa: FBT001
    """Of the segments, with the clamp's own stub before them where it turns: near it they count from its angle on."""
    heights, slopes = segments.reading(position, derivative)
    if not clamp_turns:
        return heights, slopes
    near = segments.segment_at(position) == 0
    stub = (position if derivative == 0 else 1.0) - slopes.sum() if near else 0.0
    return np.append(0.0, heights), np.append(stub, slopes)
