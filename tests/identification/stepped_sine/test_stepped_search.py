"""Made-up stepped sines: the effect that they hold is found, and its rivals are not."""

import numpy as np
import pytest
from test_balance import RIG, record_of

from identification.evaluate import Evaluator
from identification.fit import fit
from identification.hypothesis import Hypothesis, rig_unknowns
from identification.progress import silent
from identification.stepped_sine.balance import Balance
from identification.stepped_sine.record import SteppedSine
from identification.stepped_sine.search import add_effects, on_trial
from identification.stepped_sine.target import SteppedTarget, scatter
from models.effects import EFFECTS
from models.effects.bouc_wen import BoucWen
from models.effects.cubic_stiffness import CubicStiffness
from models.effects.protocol import Place

NOISE = 0.05
SOME = {name: EFFECTS[name] for name in ("cubic_stiffness", "bouc_wen", "coulomb_friction", "point_damping")}


def measured(truth, forces, seed=0):
    rng, model = np.random.default_rng(seed), Hypothesis(RIG).with_effects(*truth)
    levels = []
    for k, force in enumerate(forces):
        blank = record_of(force=force)
        noise = NOISE * (rng.standard_normal((2, 1, len(blank.frequency))).T @ [1.0, 1j]).T
        values = (Balance.of(model, blank).steady_state() + noise) / blank.force
        levels.append(SteppedSine(f"level {k}", blank.frequency, ("a",), values, force=blank.force))
    return levels


def calibrated(levels):
    evaluator = Evaluator([SteppedTarget(level, NOISE) for level in levels], 1)
    return evaluator, fit(evaluator, Hypothesis(RIG), rig_unknowns(RIG), precise=True)


@pytest.mark.parametrize(
    ("truth", "number", "within"),
    [
        (CubicStiffness(Place(), 2e11), "stiffness", 0.02),
        pytest.param(BoucWen(Place(), 6.0, 2e-4, 1.0), "force", 0.2, marks=pytest.mark.slow),
    ],
)
def test_the_effect_is_named_with_its_numbers(truth, number, within):
    evaluator, base = calibrated(measured([truth], (0.1, 0.3, 1.0)))
    rounds, decisions = add_effects(evaluator, base, SOME, silent)
    assert [found.fit.hypothesis.effects[-1].kind for found in rounds] == [truth.kind]
    assert rounds[0].odds > 12.0
    assert rounds[0].fit.ratio == pytest.approx(1.0, abs=0.15)  # noise of its own size is left
    assert getattr(rounds[0].fit.hypothesis.effects[0], number) == pytest.approx(getattr(truth, number), rel=within)
    assert truth.kind in decisions[0]


@pytest.mark.slow
@pytest.mark.study
def test_each_of_two_effects_wins_against_all_others_in_its_place():
    truth = [CubicStiffness(Place(), 1e11), BoucWen(Place(), 6.0, 2e-4, 1.0)]
    evaluator, base = calibrated(measured(truth, (0.2, 1.0, 2.0)))
    rounds, _ = add_effects(evaluator, base, SOME, silent)
    found = rounds[-1].fit
    kinds = [effect.kind for effect in found.hypothesis.effects]
    assert set(kinds) == {"cubic_stiffness", "bouc_wen"}
    again = on_trial(evaluator, found, 0, SOME, silent)
    assert again.ranked[0].effect.kind == kinds[0]
    assert again.ranked[0].log_evidence - again.ranked[1].log_evidence > 12.0


def test_nothing_is_added_to_a_linear_oscillator():
    evaluator, base = calibrated(measured([], (0.1, 1.0)))
    assert add_effects(evaluator, base, SOME, silent) == ([], [])


def test_the_scatter_of_neighbouring_lines_is_the_noise():
    level = measured([], (0.01,))[0]
    assert scatter(level) == pytest.approx(NOISE, rel=0.35)  # a median of 38 third differences
