"""The compiled loop around the engine's step: motion of the ports, forces there, and where the energy went.

The engine steps by leapfrog: velocities lie half a step before the positions. A force acts over the half steps on both
sides of its position, so a contact that begins or ends there acts only on the part in which it is closed; a law reads
the velocity at the position itself, extrapolated from the two half steps before.
"""

from typing import NamedTuple

import numpy as np

from models.arrays import FloatArray, IntArray
from models.chain.engine_call import call_engine
from models.compiled import compiled
from models.law_call import call_law
from models.point_forces import BILATERAL, CLEARANCE, GROWTH, IS_CONTACT, OFFSET, Items, about_centre, closed_part

FINITE = 1e12
"""Angles and velocities beyond it count as lost."""


part_closed = compiled(closed_part)
centred = compiled(about_centre)


class Engine(NamedTuple):
    """Views into the engine's own memory, and its functions.

    Attributes:
        step1, step2: addresses of the two halves of a step.
        model, data: addresses of the engine's structures.
        qpos, qvel, qfrc: (n_dofs,) positions, velocities and applied forces.
        gravity: (3,) m/s^2.
        anchor, axis: (n_joints, 3) place of each joint, m, and its direction.
        centre: (n_bodies, 3) of mass, m.
        turned: (n_bodies, 9) rotation of each body.
        constrained: (n_dofs,) forces of the engine's own contacts.
    """

    step1: int
    step2: int
    model: int
    data: int
    qpos: FloatArray
    qvel: FloatArray
    qfrc: FloatArray
    gravity: FloatArray
    anchor: FloatArray
    axis: FloatArray
    centre: FloatArray
    turned: FloatArray
    constrained: FloatArray


class Chain(NamedTuple):
    """Segments, from the clamp on, and what is read of them.

    Attributes:
        body: (n_segments,) number of each segment's body in the engine.
        dof, segment: (n,) number of each hinge in the engine, and of the segment that it turns first.
        heights, slopes: (n_rows, n_segments) weights of ``Segments.reading``; the ports first, then where the force
            acts, then the sensors.
        toward: (n_rows, 2) direction that each row reads, across the rig's plane (y) and in it (z).
        damping: (n, n) N m s/rad between the hinges that the engine's own hinge damping leaves.
    """

    body: IntArray
    dof: IntArray
    segment: IntArray
    heights: FloatArray
    slopes: FloatArray
    toward: FloatArray
    damping: FloatArray


class Course(NamedTuple):
    """What is known beforehand, at every step.

    Attributes:
        force: (M,) N.
        base: (3, M) displacement, velocity and acceleration of the base; (3, 0) where it stands still.
        absolute: (n_ports,) 1 where a port reads absolute motion.
        weight: m/s^2 of gravity, downwards.
        h: s.
    """

    force: FloatArray
    base: FloatArray
    absolute: FloatArray
    weight: float
    h: float


class Log(NamedTuple):
    """What is kept, at every step; filled.

    Attributes:
        read: (n_sensors, M) m or rad.
        motion: (n_ports, M) m.
        forces: (n_items, M) N on the structure.
        across: (n_items, M) N on the structure across the plane, or (0, M) where it moves in the plane.
        work: (3, M) J since the first step: supplied, damped outside of the hinges, taken by laws and contacts.
        qpos, qvel: (M, n_dofs).
        constrained: (M, n_dofs) forces of the engine's own contacts, or (0, n_dofs) where it has none.
    """

    read: FloatArray
    motion: FloatArray
    forces: FloatArray
    across: FloatArray
    work: FloatArray
    qpos: FloatArray
    qvel: FloatArray
    constrained: FloatArray


@compiled
def place_rows(engine: Engine, chain: Chain, rows: FloatArray, place: FloatArray) -> None:
    """Fill in (n_rows, n) motion of each reading by hinge angle, and (n_rows,) the readings, where the chain is now."""
    n, centre, turned = chain.dof.shape[0], engine.centre, engine.turned
    for r in range(rows.shape[0]):
        y, z = chain.toward[r, 0], chain.toward[r, 1]
        place[r], reach, k = 0.0, 0.0, chain.body.shape[0]
        sum_x, sum_y, sum_z = 0.0, 0.0, 0.0
        for i in range(n - 1, -1, -1):
            while k > chain.segment[i]:  # all segments beyond a hinge turn with it
                k -= 1
                a, b = chain.heights[r, k], chain.slopes[r, k]
                if a != 0.0 or b != 0.0:
                    body = chain.body[k]
                    reach += a
                    sum_x += a * centre[body, 0] + b * turned[body, 0]
                    sum_y += a * centre[body, 1] + b * turned[body, 3]
                    sum_z += a * centre[body, 2] + b * turned[body, 6]
            anchor, axis = engine.anchor[chain.dof[i]], engine.axis[chain.dof[i]]
            x = sum_x - reach * anchor[0]
            up = axis[0] * (sum_y - reach * anchor[1]) - axis[1] * x
            aside = axis[2] * x - axis[0] * (sum_z - reach * anchor[2])
            rows[r, i] = y * aside + z * up
        place[r] = y * sum_y + z * sum_z


@compiled
def contact_force(items: Items, j: int, t: float, h: float, q: float, v: float) -> float:
    """Mean force of contact j on the structure over a step h about t, on the part in which it is closed."""
    u, growth = q - items.contact[j, OFFSET], items.contact[j, GROWTH]
    side = 1.0 if u >= 0.0 else -1.0
    p, rate = side * u - items.contact[j, CLEARANCE] - growth * t, side * v - growth
    law, first = items.law[j], items.first[j]
    if items.contact[j, BILATERAL] > 0.0:
        both: float = call_law(law, t, p, rate, 0.0, items.values, first)
        return -side * both
    share, amid = part_closed(p, rate, h)
    if share == 0.0:
        return 0.0
    normal: float = call_law(law, t, amid, rate, 0.0, items.values, first)
    return -side * share * max(0.0, normal)


@compiled
def round_force(
    items: Items, j: int, t: float, h: float, q: float, y: float, v: float, w: float
) -> tuple[float, float]:
    """Mean force of a round contact on the structure over a step, in the plane and across it, towards its centre.

    Args:
        items: with the contact.
        j: its number.
        t: s.
        h: s.
        q: place in the plane, m.
        y: across it, m.
        v: dq/dt, m/s.
        w: dy/dt, m/s.
    """
    r, up, aside = centred(q - items.contact[j, OFFSET], y, v, w)
    at = items.contact[j, OFFSET] + r
    force: float = contact_force(items, j, t, h, at, v * up + w * aside)
    around = 0.0
    if items.contact[j, BILATERAL] > 0.0:  # without a gap it is a bushing, whose dashpot acts around too
        around = contact_force(items, j, t, h, at, w * up - v * aside) - contact_force(items, j, t, h, at, 0.0)
    return force * up - around * aside, force * aside + around * up


@compiled
def internal_state(items: Items, j: int, t: float, h: float, q: float, v: float, z: float) -> float:
    """Z of law j a step h later, by the midpoint rule, with the motion halfway."""
    half = z
    for _ in range(4):
        half = z + 0.5 * h * call_law(items.rate[j], t, q, v, half, items.values, items.first[j])
    return 2.0 * half - z


@compiled
def march(engine: Engine, chain: Chain, course: Course, items: Items, log: Log) -> int:  # noqa: C901, PLR0912, PLR0915
    """Step the engine over a course from where it stands.

    Returns:
        steps done; less than there are columns in ``log`` where the motion left the finite numbers.
    """
    n, n_items, n_steps = chain.dof.shape[0], items.port.shape[0], len(course.force)
    n_rows, n_sensors, h = chain.heights.shape[0], log.read.shape[0], course.h
    n_ports = n_rows - n_sensors - 1
    rows, place = np.zeros((n_rows, n)), np.zeros(n_rows)
    before, ahead, velocity, early = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n_ports)
    z = np.zeros(n_items)
    supplied, damped, taken = 0.0, 0.0, 0.0
    was_supplied, was_damped, was_taken = np.zeros(n), np.zeros(n), np.zeros(n)
    now_supplied, now_damped, now_taken = np.zeros(n), np.zeros(n), np.zeros(n)
    for i in range(n):
        before[i] = engine.qvel[chain.dof[i]]
    for step in range(n_steps):
        t = step * h
        moving = course.base.shape[1] > 0
        if moving:
            engine.gravity[2] = -course.weight - course.base[2, step]
        call_engine(engine.step1, engine.model, engine.data)
        place_rows(engine, chain, rows, place)
        for i in range(n):
            ahead[i] = engine.qvel[chain.dof[i]]
            velocity[i] = 1.5 * ahead[i] - 0.5 * before[i]
            now_supplied[i] = rows[n_ports, i] * course.force[step]
            now_taken[i] = 0.0
        for i in range(n):
            total = 0.0
            for k in range(n):
                total += chain.damping[i, k] * velocity[k]
            now_damped[i] = total
        for j in range(n_items):
            r = items.port[j]
            q, v = place[r], 0.0
            for i in range(n):
                v += rows[r, i] * velocity[i]
            if course.absolute[r] > 0.0 and moving:
                q += course.base[0, step]
                v += course.base[1, step]
            partner = items.partner[j]
            if partner >= 0:
                w = 0.0
                for i in range(n):
                    w += rows[partner, i] * velocity[i]
                force, aside = round_force(items, j, t, h, q, place[partner], v, w)
                log.across[j, step] = aside
                for i in range(n):
                    now_taken[i] -= rows[partner, i] * aside
            elif items.contact[j, IS_CONTACT] > 0.0:
                force = contact_force(items, j, t, h, q, v)
            else:
                if items.rate[j] != 0 and step > 0:
                    between = 0.0
                    for i in range(n):
                        between += rows[r, i] * ahead[i]
                    if course.absolute[r] > 0.0 and moving:
                        between += 0.5 * (course.base[1, step] + course.base[1, step - 1])
                    z[j] = internal_state(items, j, t - 0.5 * h, h, 0.5 * (q + early[r]), between, z[j])
                force = call_law(items.law[j], t, q, v, z[j], items.values, items.first[j])
            log.forces[j, step] = force
            for i in range(n):
                now_taken[i] -= rows[r, i] * force
        for r in range(n_ports):
            early[r] = place[r]
            log.motion[r, step] = place[r]
            if course.absolute[r] > 0.0 and moving:
                early[r] += course.base[0, step]
        for r in range(n_sensors):
            log.read[r, step] = place[n_ports + 1 + r]
        size = 0.0
        for i in range(n):
            dof = chain.dof[i]
            engine.qfrc[dof] = now_supplied[i] - now_damped[i] - now_taken[i]
            if step > 0:
                supplied += 0.5 * h * ahead[i] * (now_supplied[i] + was_supplied[i])
                damped += 0.5 * h * ahead[i] * (now_damped[i] + was_damped[i])
                taken += 0.5 * h * ahead[i] * (now_taken[i] + was_taken[i])
            was_supplied[i], was_damped[i], was_taken[i] = now_supplied[i], now_damped[i], now_taken[i]
            before[i] = ahead[i]
            size += abs(ahead[i]) + abs(engine.qpos[dof])
        log.work[0, step], log.work[1, step], log.work[2, step] = supplied, damped, taken
        for i in range(log.qpos.shape[1]):
            log.qpos[step, i] = engine.qpos[i]
            log.qvel[step, i] = engine.qvel[i]
        if not size < FINITE:
            return step
        call_engine(engine.step2, engine.model, engine.data)
        if log.constrained.shape[0] > 0:
            for i in range(log.qpos.shape[1]):
                log.constrained[step, i] = engine.constrained[i]
    return n_steps
