"""One test of a chain from rest: the engine's steps, what the sensors saw and where the energy went."""

from math import cos, inf, sin
from typing import Any

import mujoco
import numpy as np

from models.arrays import FloatArray
from models.chain.engine_call import without_warnings
from models.chain.march import Chain, Course, Log, march, place_rows
from models.chain.native_contact import forces_of_stops, has_stops
from models.chain.rig_chain import RigChain, engine_of, held_at, readings, spring_stiffness
from models.equilibrium import forces_at
from models.errors import DivergenceError
from models.point_forces import compile_items
from models.ports import Port
from models.simulators.protocol import EnergyBalance
from models.simulators.recorded import Steps


def move_chain(
    chain: RigChain,
    force: FloatArray,
    base: FloatArray,
    every: int,
    hold: tuple[float, float] | None = None,
    angle: float = 0.0,
) -> Steps:
    """Move a chain through a given course.

    Args:
        chain: at rest.
        force: (M,) N at every step.
        base: (3, M) displacement, velocity and acceleration of the base, or (3, 0).
        every: steps per sample.
        hold: (position m, force N) that deflects the chain until the first step, or None.
        angle: of the force from the rig's plane, rad; the chain must bend in space where it is not 0.

    Raises:
        DivergenceError: the motion left the finite numbers.
    """
    plant, model, step = chain.plant, chain.model, float(chain.model.opt.timestep)
    sensors = [(s.position or 0.0, 1 if s.quantity == "angular_velocity" else 0) for s in plant.sensors]
    driven_at = None if plant.excitation is None else plant.excitation.position
    places = [(plant.structure.length if driven_at is None else driven_at, 0), *sensors]
    seen = readings(model, plant, chain.segments, chain.ports, places)
    seen.toward[len(chain.ports)] = sin(angle), cos(angle)
    seen = seen._replace(damping=_damping_left(chain, seen))
    data = mujoco.MjData(model)
    data.qpos[:] = chain.rest
    mujoco.mj_forward(model, data)
    engine = engine_of(model, data)
    rows, place = np.zeros((len(seen.heights), len(seen.dof))), np.zeros(len(seen.heights))
    place_rows(engine, seen, rows, place)
    at_rest = place[len(chain.ports) + 1 :].copy()
    if hold is not None:
        data.qpos[:] = held_at(chain, *hold)
        mujoco.mj_forward(model, data)
        place_rows(engine, seen, rows, place)
    native = has_stops(model)
    own = tuple(force for force in chain.forces if force.contact is None) if native else chain.forces
    pushed = forces_at(place[: len(chain.ports)], chain.ports, own)
    data.qfrc_applied[seen.dof] = pushed @ rows[: len(chain.ports)] + force[0] * rows[len(chain.ports)]
    if base.shape[1]:
        model.opt.gravity[2] -= base[2, 0]
    mujoco.mj_forward(model, data)
    data.qvel[:] = -0.5 * step * data.qacc  # half a step before the start, so that it starts with no velocity
    items = compile_items(own, chain.ports)
    m = len(force)
    log = Log(
        read=np.empty((len(sensors), m)),
        motion=np.empty((len(chain.ports), m)),
        forces=np.empty((len(own), m)),
        across=np.zeros((len(own) if chain.spatial else 0, m)),
        work=np.empty((3, m)),
        qpos=np.empty((m, model.nq)),
        qvel=np.empty((m, model.nv)),
        constrained=np.empty((m if native else 0, model.nv)),
    )
    absolute = np.array([1.0 if port.frame == "ground" else 0.0 for port in chain.ports])
    weight = plant.structure.gravity
    with without_warnings():
        done = march(engine, seen, Course(force, base, absolute, weight, step), items, log)
    model.opt.gravity[2] = -weight
    if done < m:
        raise DivergenceError(
            f"mujoco: the motion grew without bound {done * step:.4f} s after the start with steps of {step:.3g} s; "
            "take more steps per sample (--steps), or look for a negative stiffness or damping among the effects"
        )
    log.read[:] -= at_rest[:, None]
    if native:
        log = _with_stops(chain, data, log)
    return _accounted(chain, log, np.array(data.qvel), base, step, every)


def _with_stops(chain: RigChain, data: Any, log: Log) -> Log:
    """The log with the forces of the engine's own contacts, and what they took."""
    plant = chain.plant
    forces = forces_of_stops(chain.model, data, plant, log.constrained)
    place = log.motion[[chain.ports.index(Port(contact.position)) for contact in plant.contacts]]
    log.work[2] -= _summed(0.5 * np.sum((forces[:, 1:] + forces[:, :-1]) * np.diff(place), axis=0))
    return log._replace(forces=np.vstack([log.forces, forces]))


def _damping_left(chain: RigChain, seen: Chain) -> FloatArray:
    """(n, n) damping in proportion to the beam's own mass; that of its stiffness is the hinges'."""
    structure = chain.plant.structure
    hung = np.array([chain.model.joint(f"absorber {i + 1}").dofadr[0] for i in range(len(structure.absorbers))], int)
    own = chain.mass.copy()
    for number, dof in enumerate(hung):
        # An absorber's mass is not the beam's: its coordinate carries it, and the hinges carry it along.
        own -= np.outer(chain.mass[:, dof], chain.mass[dof]) / structure.absorbers[number].mass
    beam = own[np.ix_(seen.dof, seen.dof)]
    return np.ascontiguousarray(structure.damping_scale * structure.rayleigh[0] * beam)


def _accounted(chain: RigChain, log: Log, last: FloatArray, base: FloatArray, step: float, every: int) -> Steps:
    """The motion with its energy, in the sums that leapfrog keeps: products of velocities about a position."""
    model = chain.model
    damping = np.array(model.dof_damping, float).reshape(model.nv, -1)[:, 0]
    after = np.concatenate([log.qvel[1:], last[None]])
    amid, pieces = 0.5 * (log.qvel + after), after[:-1]
    inertia = chain.mass + np.diag(model.dof_armature + 0.5 * step * damping)
    carried = _carried(chain)
    bent = log.qpos - chain.rest
    stored = 0.5 * np.einsum("mi,mi->m", log.qvel @ inertia, after)
    stored += 0.5 * (log.qpos**2 - chain.rest**2) @ spring_stiffness(model)
    stored += chain.plant.structure.gravity * (bent @ carried)
    in_hinges = 0.5 * step * np.einsum("mi,mi->m", pieces * damping, amid[:-1] + amid[1:])
    supplied = log.work[0]
    if base.shape[1]:
        shaken = -0.5 * (base[2, :-1] + base[2, 1:])
        supplied = supplied + _summed(step * shaken * (pieces @ carried))
    ways = (stored, supplied, log.work[1] + _summed(in_hinges), log.work[2])
    across = log.across[len(log.across) - len(chain.plant.contacts) :] if chain.spatial else None
    return Steps(log.read, log.motion, log.forces, EnergyBalance(*(way[::every] for way in ways)), across)


def _summed(pieces: FloatArray) -> FloatArray:
    return np.concatenate([[0.0], np.cumsum(pieces)])


def _carried(chain: RigChain) -> FloatArray:
    """(n_dofs,) height of all that moves, times its mass, by coordinate, kg m/rad."""
    root = "clamp" if chain.plant.structure.clamp_stiffness < inf else "segment 1"
    number = chain.model.body(root).id
    jacobian = np.zeros((3, chain.model.nv))
    mujoco.mj_jacSubtreeCom(chain.model, chain.data, jacobian, number)
    return np.asarray(jacobian[2] * chain.model.body_subtreemass[number])
