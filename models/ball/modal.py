"""The ball in the modal model: one mode of no frequency."""

import numpy as np

from models.ball.ball import Ball, Strike
from models.record import Record
from models.simulate import Settings, simulate

STEPS_PER_SAMPLE = 8


def strike(ball: Ball) -> Strike:
    """One strike, stepped as the reduced model steps a beam.

    Args:
        ball: on its way.
    """
    n = ball.n_steps // STEPS_PER_SAMPLE
    record = Record("ball", 1.0 / (STEPS_PER_SAMPLE * ball.step), np.zeros(n), ("ball",), np.zeros((1, n)))
    settings = Settings(steps_per_sample=STEPS_PER_SAMPLE, trace=True)
    start = np.array([0.0, ball.speed * np.sqrt(ball.mass)])
    trace = simulate(ball.plant, record, settings, start).trace
    assert trace is not None
    time = np.arange(trace.q.shape[1]) / trace.fs
    return Strike.until_back(ball, np.stack([time, trace.q[0], trace.v[0], -trace.contact_forces[0]]))
