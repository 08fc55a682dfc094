"""The force that the model lacks where laws act, so that a person sees a dead zone, a loop or a drift."""

from collections.abc import Sequence

from identification.evaluate import Evaluator
from identification.hypothesis import Hypothesis
from identification.locating.beside import BesideRun, runs_beside
from identification.result import MissingForce


def missing_forces(evaluator: Evaluator, hypothesis: Hypothesis) -> tuple[MissingForce, ...]:
    """The force that a model lacks at each sleeve, other place of a law, or mass, in each time record.

    Args:
        evaluator: records, with the noise of each line.
        hypothesis: the calibrated model.

    Returns:
        one a record and place, records first; none for a beam on which no law acts.

    Raises:
        DivergenceError: the model's motion left the finite numbers.
    """
    return forces_of(runs_beside(evaluator, hypothesis))


def forces_of(runs: Sequence[BesideRun]) -> tuple[MissingForce, ...]:
    """The same from the records beside the model's own runs of them.

    Args:
        runs: one a record.
    """
    return tuple(force for run in runs for force in _forces_in(run))


def _forces_in(run: BesideRun) -> list[MissingForce]:
    at, settled = [run.port_of(place) for place in run.places], run.settled
    if not at:
        return []
    q, v = run.recorded(settled.q[at]), run.recorded(settled.v[at])
    return [
        MissingForce(run.name_of(place), run.record.name, q[i], v[i], settled.missing[i], run.record.fs)
        for i, place in enumerate(run.places)
    ]
