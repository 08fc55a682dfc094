"""What every search for a minimum shares: the result, the box, and an objective that is never asked twice."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from models.arrays import FloatArray
from models.errors import InputError

Objective = Callable[[FloatArray], float]
"""A position (n_var,) in, a number to be made small out."""


@dataclass(frozen=True, eq=False)
class Search:
    """How a minimum was looked for, and what was found.

    Attributes:
        best: (n_var,) the position of the lowest value, the first one where several are as low.
        value: the lowest value.
        history: (n_iterations,) the lowest value known after each iteration.
        points: (evaluations, n_var) every position evaluated, in order and none of them twice.
        values: (evaluations,) the objective there.
        reason: why the search stopped.
        method: the name of the search.
    """

    best: FloatArray
    value: float
    history: FloatArray
    points: FloatArray
    values: FloatArray
    reason: str
    method: str

    @property
    def evaluations(self) -> int:
        """How often the objective was evaluated."""
        return len(self.values)


class RememberingObjective:
    """An objective that evaluates a position once and answers from memory after that.

    Args:
        objective: takes (n_var,), returns a number; inf marks a position that cannot be used.
    """

    def __init__(self, objective: Objective) -> None:
        self._objective = objective
        self._known: dict[tuple[float, ...], float] = {}

    def __call__(self, position: FloatArray) -> float:
        """Value at a position.

        Args:
            position: (n_var,).

        Raises:
            InputError: the objective returned nan.
        """
        key = tuple(position.tolist())
        if key not in self._known:
            value = float(self._objective(np.array(key, dtype=float)))
            if math.isnan(value):
                raise InputError(
                    f"an objective of nan at {list(key)}",
                    "a search compares numbers",
                    "return inf where the objective cannot be computed, or narrow the box",
                )
            self._known[key] = value
        return self._known[key]

    @property
    def evaluations(self) -> int:
        """How many positions have been evaluated."""
        return len(self._known)

    def close(self, method: str, reason: str, history: FloatArray | None = None) -> Search:
        """Sum up a search that has evaluated at least one position.

        Args:
            method: the name of the search.
            reason: why it stopped.
            history: (n_iterations,) the lowest value after each iteration; None where each evaluation is one.
        """
        points, values = np.array(list(self._known), dtype=float), np.array(list(self._known.values()))
        lowest = int(np.argmin(values))
        return Search(
            best=points[lowest],
            value=float(values[lowest]),
            history=np.minimum.accumulate(values) if history is None else history,
            points=points,
            values=values,
            reason=reason,
            method=method,
        )


def check_box(lower: FloatArray, upper: FloatArray) -> None:
    """Refuse a box that no search can look through.

    Args:
        lower: (n_var,) lower bounds.
        upper: (n_var,) upper bounds.

    Raises:
        InputError: sizes that differ or are not (n_var,), a bound that is not finite, or no width.
    """
    if lower.ndim != 1 or lower.shape != upper.shape or lower.size == 0:
        raise InputError(
            f"lower bounds of size {lower.shape} and upper bounds of size {upper.shape}",
            "both are (n_var,) with one variable or more",
            "pass one lower and one upper bound per variable",
        )
    for i, (low, high) in enumerate(zip(lower.tolist(), upper.tolist(), strict=True)):
        if not (math.isfinite(low) and math.isfinite(high)):
            raise InputError(
                f"variable {i} from {low:g} to {high:g}",
                "a search needs finite bounds",
                "bound the variable on both sides",
            )
        if not low < high:
            raise InputError(
                f"variable {i} from {low:g} to {high:g}",
                "the lower bound is below the upper",
                "exchange them, or leave a variable that is known out of the search",
            )
