"""Laws described in more detail, where what is there asks for it."""

from collections.abc import Callable, Iterator

from identification.evaluate import Evaluator
from identification.evidence import Ranked, with_evidence
from identification.fit import Fit, fit
from identification.hypothesis import but_for_effects, effect_unknowns
from identification.reached import NOISE_REACHED, tells_much


def in_more_detail(evaluator: Evaluator, result: Fit, tell: Callable[[str], None], which: slice = slice(None)) -> Fit:
    """The effects described in more detail as long as that tells much: a long table imitates what is not there.

    What was too coarse a table for may only show once another effect stands beside it, so all are tried.

    Args:
        evaluator: records and noise.
        result: the model, fitted to them.
        tell: told what is described in more detail.
        which: of the effects, if not all.
    """
    while result.ratio > NOISE_REACHED:
        asked = range(len(result.hypothesis.effects))[which]
        finer = [row for index in asked for row in _finer(evaluator, result, index)]
        now = Ranked.of(result)
        best = with_evidence([now, *finer])[0]
        if best.fit is result or not tells_much(result, best.fit):
            return result
        tell(f"{best.effect.label()} described in more detail: residual {best.fit.ratio:.2f} times the noise")
        result = best.fit
    return result


def _finer(evaluator: Evaluator, result: Fit, index: int) -> Iterator[Ranked]:
    """The fit with one of its effects in more detail, begun where it says the same."""
    shared = but_for_effects(result.unknowns)
    for effect in result.hypothesis.effects[index].refined():
        hypothesis = result.hypothesis.with_effect_at(index, effect)
        try:
            found = fit(evaluator, hypothesis, (*shared, *effect_unknowns(hypothesis)), precise=True)
        except ArithmeticError:
            continue
        yield Ranked.of(found, index)
