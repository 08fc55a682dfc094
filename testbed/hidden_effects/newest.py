"""The newest reported cases that are enough by themselves: what the diagnosis reaches as it has become."""

from collections.abc import Mapping, Sequence

from testbed.hidden_effects.bars import ENOUGH, ENOUGH_NOTHING
from testbed.hidden_effects.plan import NOTHING
from testbed.hidden_effects.sets import Batch
from testbed.outputs import Json


def newest_of(cases: Sequence[Json], batches: Mapping[int, Batch]) -> list[Json]:
    """Cases of whole batches, the newest first, until they are enough; all where they never are.

    Args:
        cases: of one set.
        batches: of that set, seed -> batch, the newest last.
    """
    newest: list[Json] = []
    for seed in reversed(batches):
        newest += [case for case in cases if case["seed"] == seed]
        if len(newest) >= ENOUGH and sum(case["kind"] == NOTHING for case in newest) >= ENOUGH_NOTHING:
            break
    return newest
