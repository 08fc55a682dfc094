"""How much noise alone may leave of a record: many draws of the measured force's noise, carried through a model.

Where walls are struck a little of the force's noise decides whether one blow more or less is struck, and where damping
is low it all comes through a few resonances: what it leaves of one record is no normal number, and may be twice the
mean (docs/theory.md, section 21). A few draws tell the mean; whether a record can be noise is asked of many. What is
more than any of 99 draws leave is noise in one of a hundred records.

Source: G. A. Barnard, J. R. Stat. Soc. B 25 (1963) 294; A. C. A. Hope, J. R. Stat. Soc. B 30 (1968) 582.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from identification.evaluate import Evaluator, TimeTarget, carry_noise
from identification.hypothesis import Hypothesis
from models.arrays import FloatArray

DRAWS, AT_ONCE = 99, 9
"""Of the force's noise, and of these as many as are held in memory together."""


@dataclass(frozen=True, eq=False)
class Drawn:
    """What noise leaves of a record in each of ``DRAWS`` draws; of what carries none of the force's, always as much.

    Attributes:
        n_judged: of the record, its weight among others.
        nrmse: (DRAWS,) error of a perfect model.
        ratio: (DRAWS,) its residual over noise.
    """

    n_judged: int
    nrmse: FloatArray
    ratio: FloatArray

    @classmethod
    def of(cls, evaluator: Evaluator, target: TimeTarget, hypothesis: Hypothesis, seed: int) -> Self:
        """Drawn anew, by other noise than that which the record's own was carried by.

        Args:
            evaluator: in which the record is.
            target: the record, as far as it is judged, and its noise.
            hypothesis: the model that carries the force's noise, with the state in which the record begins.
            seed: of the noise.

        Raises:
            DivergenceError: the motion leaves the finite numbers.
        """
        rng = np.random.default_rng([seed, 1])
        if not len(target.carried):
            return cls(target.n_judged, np.full(DRAWS, target.nrmse_of_noise), np.ones(DRAWS))
        nrmse, ratio = np.empty(0), np.empty(0)
        while len(nrmse) < DRAWS:
            (more,) = carry_noise(evaluator.with_targets([target]), hypothesis, rng, min(AT_ONCE, DRAWS - len(nrmse)))
            assert isinstance(more, TimeTarget)
            draws = [target.with_carried(one[None]) for one in more.carried]
            nrmse = np.append(nrmse, [each.nrmse_of_noise for each in draws])
            ratio = np.append(ratio, [np.sqrt(np.mean(each.density / target.density)) for each in draws])
        return cls(target.n_judged, nrmse, ratio)


def drawn(evaluator: Evaluator, hypothesis: Hypothesis, seed: int) -> dict[str, Drawn]:
    """What noise leaves of each time record, by its name.

    Args:
        evaluator: with the records.
        hypothesis: the model that carries the force's noise.
        seed: of the noise.

    Raises:
        DivergenceError: a motion leaves the finite numbers.
    """
    return {target.record.name: Drawn.of(evaluator, target, hypothesis, seed) for target in evaluator.timed}


def most_together(draws: dict[str, Drawn]) -> float:
    """The most that noise leaves of several records together, as residual over noise.

    Args:
        draws: of each of them.
    """
    weights = [each.n_judged for each in draws.values()]
    return float(np.sqrt(np.average([each.ratio**2 for each in draws.values()], axis=0, weights=weights)).max())
