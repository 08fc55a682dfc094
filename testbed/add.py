"""One effect added by hand: the best of its trial values at its place, then fitted with everything else."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from identification.assess import calibrate_effects, fit_effects
from identification.calibrate import calibrate, unknowns_of
from identification.evaluate import Evaluator
from identification.fit import Fit
from identification.hypothesis import Hypothesis
from identification.in_step import tried_with
from identification.prepare import prepare
from identification.scene import scenes
from models.effects import EFFECTS, Effect, build_effect
from models.effects.protocol import Parameter
from models.errors import DivergenceError
from models.record import Record
from models.rig import EffectEntry, Rig
from testbed.compare import Comparison, compare


@dataclass(frozen=True, eq=False)
class Added:
    """The model before and after.

    Attributes:
        before: the rig as given.
        fit: calibrated, with the effect.
        comparison_before: as given.
        comparison_after: with the effect.
    """

    before: Hypothesis
    fit: Fit
    comparison_before: Comparison
    comparison_after: Comparison

    @property
    def after(self) -> Hypothesis:
        """Calibrated, with the effect."""
        return self.fit.hypothesis

    @property
    def effect(self) -> Effect:
        """What was added, fitted."""
        return self.after.effects[-1]


def add_effect(rig: Rig, entry: EffectEntry, records: Sequence[Record], *, seed: int, jobs: int) -> Added:
    """Add one effect and fit it with the rig's toleranced numbers.

    Args:
        rig: as its owner describes it.
        entry: kind, place and options of the effect, without its parameters.
        records: to fit to.
        seed: of the noise that is carried through the model.
        jobs: cores.

    Raises:
        InputError: a kind or place that does not fit the rig.
        ArithmeticError: there is no trial value under which the motion stays finite.
    """
    pattern = pattern_of(rig, entry)
    before = Hypothesis(rig)
    evaluator = prepare(before, records, jobs, np.random.default_rng(seed))
    found = fit_effects(_begun(evaluator, before, pattern, entry.settings), records, jobs=jobs, seed=seed)
    comparisons = [compare(hypothesis, records, seed=seed, jobs=jobs) for hypothesis in (before, found.hypothesis)]
    return Added(before, found, *comparisons)


def _begun(evaluator: Evaluator, given: Hypothesis, pattern: Effect, options: dict[str, Any]) -> Hypothesis:
    """Where the fit begins: from the rig as given, or as calibrated without the effect, whichever leads to less.

    Beside numbers as given the best trial may be one that stands for what their faults leave; beside calibrated ones,
    which have moved to stand for the effect, it may be too small.

    Raises:
        ArithmeticError: from neither is there a trial value under which the motion stays finite.
    """
    models, found = [given], []
    with suppress(ArithmeticError):  # without a calibration the rig as given is left
        models.append(calibrate(evaluator, given, unknowns_of(given, evaluator)).hypothesis)
    for model in models:
        try:
            best = _best(evaluator, model, trials_at(evaluator, model, pattern, options), pattern)
            found.append(calibrate_effects(evaluator, tried_with(evaluator, model, best)))
        except ArithmeticError:
            if model is models[-1] and not found:
                raise
    return min(found, key=lambda each: each.cost).hypothesis


def pattern_of(rig: Rig, entry: EffectEntry) -> Effect:
    """The effect with placeholders for its parameters, so that its kind, place and options are checked and resolved.

    Args:
        rig: that is to have it.
        entry: kind, place and options.

    Raises:
        InputError: a kind or place that does not fit the rig.
    """
    kind = EFFECTS.get(entry.kind)
    parameters = kind.parameters() if kind is not None else {}
    values = {name: _placeholder(about) for name, about in parameters.items()}
    given = {key: value for key, value in entry.model_dump().items() if value is not None}
    return build_effect(EffectEntry(**{**values, **given}), rig, EFFECTS)


def _placeholder(about: Parameter) -> float | tuple[float, ...]:
    value = min(max(1.0, about.lower), about.upper)
    return (value, value + 1.0) if about.table else value


def trials_at(
    evaluator: Evaluator, hypothesis: Hypothesis, pattern: Effect, options: dict[str, Any]
) -> tuple[Effect, ...]:
    """The kind's trial values for what moves at the effect's place, with the options that were asked for.

    Args:
        evaluator: with the records.
        hypothesis: the model so far.
        pattern: of the kind, at the place.
        options: key -> value.
    """
    scene = scenes(evaluator, hypothesis, (pattern.place,))[pattern.place]
    return tuple(dict.fromkeys(replace(trial, **options) for trial in type(pattern).trials(scene)))


def _best(evaluator: Evaluator, hypothesis: Hypothesis, trials: Sequence[Effect], pattern: Effect) -> Effect:
    rows = evaluator.residuals([(tried_with(evaluator, hypothesis, trial), None) for trial in trials])
    sizes = [np.inf if row is None else float(row @ row) for row in rows]
    if not np.isfinite(sizes).any():
        raise DivergenceError(f"{pattern.label()}: the motion grew without bound for every trial value")
    return trials[int(np.argmin(sizes))]
