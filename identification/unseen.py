"""What a model leaves of the records that it was not fitted to, in the same tests, where a passing event gives way.

Where a motion just meets a wall or just misses it, noise of the force decides, and for a second the records have
several times the noise of their mean. Any law with a few numbers can be bent to that second. What is missing in the rig
is there for as long as the test lasts.
"""

from dataclasses import dataclass

import numpy as np

from identification.evaluate import TimeTarget
from identification.fit import Fit
from identification.prepare import MIN_SAMPLES
from identification.session import Session
from models.arrays import FloatArray
from models.band_limit import SCORE_EDGE
from models.errors import DivergenceError


@dataclass(frozen=True)
class Unseen:
    """What two models leave of what was not fitted, in the mean over the records, over the noise.

    Attributes:
        before: residual of the model without an effect.
        after: of the one with it.
        between: difference of the two models there; where it is small, as after a blow has rung down, the rest of the
            records does not tell which of them is right.
    """

    before: float
    after: float
    between: float


def left_unseen(session: Session, without: Fit, found: Fit) -> Unseen | None:
    """What was not fitted of the time records, as far as it can be predicted, by a model without an effect and with it.

    Args:
        session: with the records.
        without: fitted to ``session.fitting``, without the effect.
        found: the same with it.

    Returns:
        None where everything was fitted, or a motion leaves the finite numbers.
    """
    fitted = {target.record.name: target.record.n_samples for target in session.fitting.timed}
    rests = [
        (target, slice(fitted.get(target.record.name, 0), round(limit.seconds * target.record.fs)))
        for target, limit in zip(session.everything.timed, session.limits, strict=True)
    ]
    rests = [(target, rest) for target, rest in rests if rest.stop - rest.start >= MIN_SAMPLES]
    if not rests:
        return None
    evaluator = session.everything.with_targets([target for target, _ in rests])
    try:
        runs = [evaluator.responses(each.hypothesis) for each in (without, found)]
    except DivergenceError:
        return None
    squares = []
    for (target, rest), one, other in zip(rests, *runs, strict=True):
        before, after = (target.at_its_zero(each.channels)[:, rest] for each in (one, other))
        measured, variance = target.record.responses[:, rest], _variance(target)[:, None]
        errors = (before - measured, after - measured, before - after)
        squares.append([np.mean(error**2 / variance) for error in errors])
    return Unseen(*np.sqrt(np.mean(squares, axis=0)).tolist())


def _variance(target: TimeTarget) -> FloatArray:
    """(n_sensors,) of the noise in the time domain: the sensors' at all frequencies, the force's in the scored band."""
    own = target.with_noise(target.noise).density.mean(axis=1)
    return np.asarray(own + 2.0 * SCORE_EDGE * np.maximum(target.density.mean(axis=1) - own, 0.0))
