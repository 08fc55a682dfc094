"""What a model leaves of the records that it was not fitted to, in the same tests, where a passing event gives way.

Where a motion just meets a wall or just misses it, noise of the force decides, and for a second the records have
several times the noise of their mean. Any law with a few numbers can be bent to that second. What is missing in the rig
is there for as long as the test lasts.
"""

import numpy as np

from identification.evaluate import TimeTarget
from identification.fit import Fit
from identification.prepare import MIN_SAMPLES
from identification.session import Session
from models.arrays import FloatArray
from models.band_limit import SCORE_EDGE
from models.errors import DivergenceError


def left_unseen(session: Session, found: Fit) -> float | None:
    """Residual over noise in what was not fitted of the time records, as far as it can be predicted.

    Args:
        session: with the records.
        found: fitted to ``session.fitting``.

    Returns:
        None where everything was fitted, or the motion leaves the finite numbers.
    """
    fitted = {target.record.name: target.record.n_samples for target in session.fitting.timed}
    try:
        responses = session.everything.responses(found.hypothesis)
    except DivergenceError:
        return None
    squares = []
    for target, limit, response in zip(session.everything.timed, session.limits, responses, strict=True):
        first, last = fitted.get(target.record.name, 0), round(limit.seconds * target.record.fs)
        error = response.channels[:, first:last] - target.record.responses[:, first:last]
        if error.shape[1] >= MIN_SAMPLES:
            squares.append(np.mean(error**2 / _variance(target)[:, None]))
    return float(np.sqrt(np.mean(squares))) if squares else None


def _variance(target: TimeTarget) -> FloatArray:
    """(n_sensors,) of the noise in the time domain: the sensors' at all frequencies, the force's in the scored band."""
    own = target.with_noise(target.noise).density.mean(axis=1)
    return np.asarray(own + 2.0 * SCORE_EDGE * np.maximum(target.density.mean(axis=1) - own, 0.0))
