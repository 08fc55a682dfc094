"""The ball in MuJoCo: a body on a slide, with our laws around the engine's step, as for the chain."""

import mujoco
import numpy as np

from models.ball.ball import Ball, Strike
from models.chain.march import contact_force
from models.point_forces import compile_items, forces_on_structure, ports_of


def strike(ball: Ball) -> Strike:
    """One strike.

    Args:
        ball: on its way.
    """
    model = _model(ball)
    data = mujoco.MjData(model)
    contacts = [force for force in forces_on_structure(ball.plant) if force.contact is not None]
    items = compile_items(contacts, ports_of(contacts))
    motion = np.zeros((4, ball.n_steps))
    data.qvel[0] = before = ball.speed
    n = 0
    for n in range(ball.n_steps):
        mujoco.mj_step1(model, data)
        time, q, now = n * ball.step, float(data.qpos[0]), float(data.qvel[0])
        at_place = 1.5 * now - 0.5 * before  # the engine's speeds are those of half a step before
        pushed = contact_force(items, 0, time, ball.step, q, at_place)
        motion[:, n] = time, q, at_place, -pushed
        if q <= 0.0 and now < 0.0:
            break
        data.qfrc_applied[0] = pushed + sum(film.force(time, q, at_place, 0.0, film.parameters) for film in ball.films)
        before = now
        mujoco.mj_step2(model, data)
    return Strike.until_back(ball, motion[:, : n + 1])


def _model(ball: Ball) -> mujoco.MjModel:
    spec = mujoco.MjSpec()
    spec.option.timestep, spec.option.gravity = ball.step, [0.0, 0.0, 0.0]
    spec.option.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    body = spec.worldbody.add_body(name="ball")
    body.mass, body.ipos, body.inertia, body.explicitinertial = ball.mass, [0.0, 0.0, 0.0], [ball.mass] * 3, True
    body.add_joint(name="way", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[0.0, 0.0, 1.0])
    return spec.compile()
