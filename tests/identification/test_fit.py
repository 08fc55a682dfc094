"""The fit: exact where the problem is linear, within its bounds, and back to the truth from a wrong start."""

from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
import pytest
from trial_records import REFERENCE, evaluator_of, measured, moved, multisine, oscillator, sweep

from identification.fit import LEAST_ACTING, _along_step, _bent, _least_change, _State, fit, fit_to_its_end
from identification.hypothesis import (
    Hypothesis,
    OffsetUnknown,
    RigUnknown,
    StartUnknown,
    Unknown,
    effect_unknowns,
    rig_unknowns,
)
from identification.prepare import start_unknowns
from models.effects import Place
from models.effects.contact_stiffness import ContactStiffness
from models.effects.force_gain import ForceGain
from models.effects.youngs_modulus import YoungsModulus


@dataclass(frozen=True)
class Number(Unknown):
    """A number in a hypothesis that nobody simulates."""

    name: str
    lower: float = -np.inf
    upper: float = np.inf
    prior: bool = False
    step: float = 1e-3
    record: str | None = None

    def get(self, hypothesis):
        return hypothesis.values.get(self.name, 0.0)

    def set(self, hypothesis, x):
        return replace(hypothesis, values={**hypothesis.values, self.name: min(max(x, self.lower), self.upper)})


def target(name, n_data):
    """So many numbers of a record."""
    return SimpleNamespace(record=SimpleNamespace(name=name), n_data=n_data)


class Linear:
    """Residuals A x - b, and how often they were asked for."""

    jobs, repeats = 1, 1.0

    def __init__(self, matrix, right, unknowns):
        self.matrix, self.right, self.unknowns = matrix, right, unknowns
        self.n_data, self.n_judged, self.n_asked = len(right), len(right), 0
        self.targets = (target("test", self.n_data),)

    def residuals(self, hypotheses):
        self.n_asked += len(hypotheses)
        return [self.matrix @ [u.get(h) for u in self.unknowns] - self.right for h, _ in hypotheses]


class Impact:
    """The force K (q - gap)^n over a press: what K, in two e-folds, n, in 0.4, and the gap do is nearly the same."""

    jobs, targets, repeats = 1, (target("test", 400),), 1.0
    unknowns = (Number("K", step=0.01), Number("n", step=0.01), Number("gap", -4.0, 4.0, prior=True, step=0.05))
    press, deepest = np.linspace(0.0, 4e-4, 400), 1e5

    def __init__(self, truth):
        self.n_data = self.n_judged = len(self.press)
        self.unit = self.deepest / self.force(truth, 1.0).max()
        self.measured = self.force(truth, self.unit) + np.random.default_rng(0).standard_normal(self.n_data)

    def force(self, hypothesis, unit):
        stiffness, exponent, gap = (u.get(hypothesis) for u in self.unknowns)
        return (
            unit * np.exp(2.0 * stiffness) * np.maximum(self.press - 5e-5 * np.exp(0.03 * gap), 0.0) ** (0.4 * exponent)
        )

    def residuals(self, hypotheses):
        return [self.force(h, self.unit) - self.measured for h, _ in hypotheses]


class Rough:
    """Only a sum of two gaps is seen, and what it does has kinks everywhere, as the motion between many impacts has."""

    jobs, targets, repeats = 1, (target("test", 400),), 1.0
    unknowns = (Number("one", prior=True, step=0.05), Number("other", prior=True, step=0.05))
    share, kinks, weight = 0.02, 400.0, 0.4

    def __init__(self):
        rng = np.random.default_rng(0)
        self.slope, self.phase = 150.0 * rng.standard_normal(400), 2.0 * np.pi * rng.random(400)
        self.measured, self.n_data, self.n_judged = rng.standard_normal(400), 400, 400

    def residuals(self, hypotheses):
        rows = []
        for hypothesis, _ in hypotheses:
            one, other = (unknown.get(hypothesis) for unknown in self.unknowns)
            seen = one + self.weight * other
            kinked = self.share * np.arcsin(np.sin(self.kinks * (seen + one) + self.phase)) / self.kinks
            rows.append(self.slope * (seen + kinked) - self.measured)
        return rows


class TwoRecords(Rough):
    """A clock that both records share and a phase that each has for itself: only their sums are seen."""

    unknowns = (Number("clock", prior=True, step=0.05), *(Number(r, step=0.05, record=r) for r in "ab"))
    targets = tuple(target(name, 200) for name in "ab")

    def residuals(self, hypotheses):
        rows = []
        for hypothesis, only in hypotheses:
            clock, *phases = (unknown.get(hypothesis) for unknown in self.unknowns)
            seen = np.repeat([clock + phases[0], 1.3 * clock + phases[1]], 200)
            kinked = self.share * np.arcsin(np.sin(self.kinks * (seen + clock) + self.phase)) / self.kinks
            rows.append(self.slope * (seen + kinked) - self.measured)
            rows[-1][np.repeat([only not in (None, name) for name in "ab"], 200)] = 0.0
        return rows


RNG = np.random.default_rng(1)
MATRIX, RIGHT = 30.0 * RNG.standard_normal((40, 3)), 30.0 * RNG.standard_normal(40)
NAMES = ("a", "b", "c")
NOWHERE = Hypothesis(oscillator())


@pytest.mark.parametrize("prior", [False, True])
def test_a_linear_problem_is_solved_exactly(prior):
    unknowns = tuple(Number(name, prior=prior) for name in NAMES)
    normal = MATRIX.T @ MATRIX + prior * np.eye(3)

    found = fit(Linear(MATRIX, RIGHT, unknowns), NOWHERE, unknowns)

    best = np.linalg.solve(normal, MATRIX.T @ RIGHT)
    # The last step is the one that no longer pays, and the damping leaves 1e-4 of it or less.
    np.testing.assert_allclose([u.get(found.hypothesis) for u in unknowns], best, atol=1e-6)
    np.testing.assert_allclose(found.covariance, np.linalg.inv(normal), rtol=1e-6, atol=1e-12)
    np.testing.assert_allclose(found.jacobian, MATRIX.T, rtol=1e-6, atol=1e-6)
    assert found.chi2 == pytest.approx(np.sum((MATRIX @ best - RIGHT) ** 2), rel=1e-9)
    assert found.penalty == pytest.approx(prior * best @ best, abs=1e-4)  # a difference of two costs of 1e4
    assert found.cost == found.chi2 + found.penalty
    assert found.ratio == pytest.approx(np.sqrt(found.chi2 / 40))


def test_a_far_minimum_is_reached_in_bounded_steps():
    unknowns = (Number("a"),)
    problem = Linear(np.full((5, 1), 100.0), np.full(5, 700.0), unknowns)

    begun, ended = fit(problem, NOWHERE, unknowns, max_iterations=1), fit(problem, NOWHERE, unknowns)

    assert begun.hypothesis.values["a"] == pytest.approx(2.0)
    assert ended.hypothesis.values["a"] == pytest.approx(7.0, abs=1e-4)
    assert begun.unfinished == pytest.approx(1.0 - 9.0 / 25.0)  # a step of 2 of the 5 that are left
    assert ended.unfinished < 1e-6


def test_a_fit_that_stops_before_its_end_goes_on():
    unknowns = (Number("a"),)
    problem = Linear(np.full((50, 1), 100.0), np.full(50, 700.0), unknowns)

    found = fit_to_its_end(problem, NOWHERE, unknowns, 1)

    assert found.hypothesis.values["a"] == pytest.approx(7.0, abs=1e-4)


class Valley(Linear):
    """Residuals of a parabola's floor that is a hundred times as steep across as along it."""

    def __init__(self, unknowns):
        super().__init__(np.zeros((3, 2)), np.zeros(3), unknowns)

    def residuals(self, hypotheses):
        rows = []
        for hypothesis, _ in hypotheses:
            self.n_asked += 1
            x, y = (unknown.get(hypothesis) for unknown in self.unknowns)
            rows.append(np.array([3e3 * (y - x**2), 30.0 * (1.0 - x), 0.0]))
        return rows


@pytest.mark.parametrize("bend", [True, False])
def test_a_step_that_is_bent_follows_a_curved_valley(bend, monkeypatch):
    if not bend:
        monkeypatch.setattr("identification.fit.LARGEST_BEND", 0.0)
    unknowns = (Number("a"), Number("b"))
    start = replace(NOWHERE, values={"a": -1.2, "b": 1.44})

    found = fit(Valley(unknowns), start, unknowns, max_iterations=60, tolerance=0.0, precise=True)

    assert (found.cost < 1e-3) == bend


def test_a_bend_is_half_the_answer_to_the_second_derivative():
    unknowns = (Number("a"), Number("b"))
    problem, start = Valley(unknowns), replace(NOWHERE, values={"a": -1.2, "b": 1.44})
    rows = fit(problem, start, unknowns, max_iterations=0).jacobian
    (residual,) = problem.residuals([(start, None)])
    state = _State(start, np.array([-1.2, 1.44]), residual, float(residual @ residual))
    normal, step = rows @ rows.T + np.eye(2), np.array([0.02, -0.048])

    (bent,) = _bent(problem, state, unknowns, rows, [normal], [step])

    second = np.array([-2.0 * 3e3 * step[0] ** 2, 0.0, 0.0])  # of 3e3 (y - x^2) along the step, twice
    expected = step - 0.5 * np.linalg.solve(normal, rows @ second)
    np.testing.assert_allclose(bent, expected, rtol=0.02, atol=1e-6)


def test_a_fit_that_brings_nothing_is_not_repeated():
    """What no parameter explains stays, whatever is asked."""
    unknowns = (Number("a"),)
    problem = Linear(np.full((5, 1), 100.0), np.array([700.0, 300.0, 500.0, 500.0, 500.0]), unknowns)

    fit(problem, NOWHERE, unknowns, max_iterations=6, tolerance=0.0, precise=True)
    asked = problem.n_asked
    fit_to_its_end(problem, NOWHERE, unknowns, 6)

    assert problem.n_asked == 2 * asked


class Mild(Linear):
    """Residuals that are a little curved everywhere, far from where they are least."""

    def residuals(self, hypotheses):
        rows = super().residuals(hypotheses)
        return [row + 1e-4 * row**2 for row in rows]


def mild():
    """Of three numbers, each of which two steps of the largest size bring to where the residual vanishes."""
    unknowns = tuple(Number(name) for name in NAMES)
    return Mild(MATRIX, MATRIX @ np.array([3.0, -3.5, 2.5]), unknowns), unknowns


def test_slopes_that_follow_the_steps_lead_to_the_same_end_with_fewer_residuals(monkeypatch):
    problem, unknowns = mild()
    found = fit(problem, NOWHERE, unknowns)
    monkeypatch.setattr("identification.fit.FOLLOWED_SHARE", 1.0)
    again, _ = mild()
    anew = fit(again, NOWHERE, unknowns)

    assert problem.n_asked < again.n_asked
    for each in (found, anew):
        np.testing.assert_allclose([u.get(each.hypothesis) for u in unknowns], [3.0, -3.5, 2.5], atol=1e-5)


def test_slopes_after_a_step_agree_with_it_in_each_record():
    problem = TwoRecords()
    rows = np.random.default_rng(3).standard_normal((3, 400))
    rows[1, 200:] = rows[2, :200] = 0.0  # a phase acts in its own record alone
    step, change = np.array([0.1, -0.2, 0.4]), np.random.default_rng(4).standard_normal(400)
    before = rows.copy()

    _along_step(problem, rows, step, change)

    np.testing.assert_allclose(step @ rows, change, atol=1e-12)
    assert not rows[1, 200:].any()
    assert not rows[2, :200].any()
    # What the step moves most is changed most: by the square of its norm.
    clock, phase = (np.linalg.norm((rows - before)[k, :200]) for k in (0, 1))
    sizes = np.sum(before[:, :200] ** 2, axis=1)
    assert clock / phase == pytest.approx(0.1 * sizes[0] / (0.2 * sizes[1]))


def test_a_fit_nearby_tells_how_far_to_move_for_the_first_difference():
    unknowns = tuple(Number(name, step=10.0) for name in NAMES)  # as they are, far too wide
    alone, beside = Linear(MATRIX, RIGHT, unknowns), Linear(MATRIX, RIGHT, unknowns)
    nearby = fit(Linear(MATRIX[:20], RIGHT[:20], unknowns), NOWHERE, unknowns)

    fit(alone, NOWHERE, unknowns, max_iterations=0)
    found = fit(beside, NOWHERE, unknowns, max_iterations=0, like=nearby)

    assert beside.n_asked == alone.n_asked - len(unknowns)
    np.testing.assert_allclose(found.jacobian, MATRIX.T, rtol=1e-6, atol=1e-6)


def test_slopes_that_were_followed_are_formed_where_the_fit_ends():
    problem, unknowns = mild()

    found = fit(problem, NOWHERE, unknowns, max_iterations=1)  # of which two go by steps of the largest size

    x = np.array([u.get(found.hypothesis) for u in unknowns])
    away = MATRIX @ (x - np.array([3.0, -3.5, 2.5]))
    np.testing.assert_allclose(found.jacobian, MATRIX.T * (1.0 + 2e-4 * away), rtol=1e-3, atol=1e-3)


class Bent(Linear):
    """One number whose slope is 10 where it is 0, and 35 as a difference over half a unit."""

    def residuals(self, hypotheses):
        return [np.array([10.0 * (a + 5.0 * a**2)]) for a in (self.unknowns[0].get(h) for h, _ in hypotheses)]


def test_a_precise_fit_that_takes_no_step_forms_its_slopes_again_where_they_were_too_wide():
    unknowns = (Number("a", step=0.5),)
    problem = Bent(np.zeros((1, 1)), np.zeros(1), unknowns)

    plain, precise = (fit(problem, NOWHERE, unknowns, max_iterations=0, precise=each) for each in (False, True))

    assert plain.jacobian[0, 0] == pytest.approx(35.0)
    assert precise.jacobian[0, 0] == pytest.approx(10.0, rel=0.5)


@pytest.mark.parametrize("precise", [False, True])
def test_a_precise_fit_that_is_stopped_forms_what_it_was_given_where_it_ends(precise):
    """Columns a little off lead on well enough, and no covariance is to be formed of them."""
    unknowns = tuple(Number(name) for name in NAMES)
    problem = Linear(MATRIX, MATRIX @ np.array([3.0, -3.5, 2.5]), unknowns)

    found = fit(problem, NOWHERE, unknowns, jacobian=1.05 * MATRIX.T[:2], max_iterations=1, precise=precise)

    np.testing.assert_allclose(found.jacobian[2], MATRIX.T[2], rtol=1e-6, atol=1e-6)
    assert np.allclose(found.jacobian[:2], MATRIX.T[:2], rtol=1e-6, atol=1e-6) == precise


def test_a_run_that_goes_on_begins_with_the_slopes_of_the_last_and_leaves_a_valley():
    unknowns = (Number("a"), Number("b"))
    problem, start = Valley(unknowns), replace(NOWHERE, values={"a": -0.5, "b": 0.25})
    problem.n_judged = 5000  # the noise is met, so that little is left to be promised

    found = fit_to_its_end(problem, start, unknowns, 8)

    assert found.cost < 1e-3
    assert found.unfinished * found.cost < 1.0


def test_a_fit_far_away_tells_no_step():
    """Its slopes are so steep that what they ask for is lost in rounding: the difference is taken over a longer way."""
    unknowns = tuple(Number(name) for name in NAMES)
    nearby = fit(Linear(1e12 * MATRIX, RIGHT, unknowns), NOWHERE, unknowns, max_iterations=0)

    found = fit(Linear(MATRIX, RIGHT, unknowns), NOWHERE, unknowns, max_iterations=0, like=nearby)

    np.testing.assert_allclose(found.jacobian, MATRIX.T, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("at_start", [0.0, 0.1], ids=["inside", "at the bound"])
def test_bounds_hold_and_the_others_settle_beside_them(at_start):
    best = np.linalg.lstsq(MATRIX, RIGHT, rcond=None)[0]
    bound = 0.1 if best[0] > 0.1 else best[0] - 0.2
    unknowns = (Number("a", upper=bound), Number("b"), Number("c"))
    start = replace(NOWHERE, values={"a": min(at_start, bound)})

    found = fit(Linear(MATRIX, RIGHT, unknowns), start, unknowns)

    others = np.linalg.lstsq(MATRIX[:, 1:], RIGHT - MATRIX[:, 0] * bound, rcond=None)[0]
    np.testing.assert_allclose([u.get(found.hypothesis) for u in unknowns], [bound, *others], atol=1e-4)
    assert found.unfinished < 1e-6  # what is held at its bound promises nothing


def test_known_columns_are_not_formed_again():
    unknowns = tuple(Number(name) for name in NAMES)
    fresh, known = Linear(MATRIX, RIGHT, unknowns), Linear(MATRIX, RIGHT, unknowns)

    fit(fresh, NOWHERE, unknowns)
    found = fit(known, NOWHERE, unknowns, jacobian=MATRIX.T, keep=True)

    assert known.n_asked < fresh.n_asked
    np.testing.assert_allclose(
        [u.get(found.hypothesis) for u in unknowns], np.linalg.lstsq(MATRIX, RIGHT, rcond=None)[0], atol=1e-6
    )


def test_columns_that_are_kept_may_follow_the_steps():
    """Of a model nearby whose slopes are turned: they are learnt on the way, and the same steps lead farther."""
    unknowns, true = tuple(Number(name) for name in NAMES), np.array([0.5, -0.3, 0.4])
    turned = MATRIX.T + 0.5 * np.roll(MATRIX.T, 1, axis=0)
    off = {}
    for along_steps in (False, True):
        known = Linear(MATRIX, MATRIX @ true, unknowns)
        found = fit(known, NOWHERE, unknowns, jacobian=turned, keep=True, along_steps=along_steps, max_iterations=6)
        off[along_steps] = float(np.linalg.norm([u.get(found.hypothesis) for u in unknowns] - true))

    assert off[True] < 0.1 * off[False]


def test_a_misfit_widens_the_intervals():
    unknowns = (Number("a"),)
    small = fit(Linear(np.ones((50, 1)) * 10, np.zeros(50), unknowns), NOWHERE, unknowns)
    large = fit(Linear(np.ones((50, 1)) * 10, np.tile([5.0, -5.0], 25), unknowns), NOWHERE, unknowns)

    assert large.std()[0] == pytest.approx(5.0 * small.std()[0], rel=1e-6)


def test_a_start_that_diverges_is_refused():
    evaluator = evaluator_of(measured(NOWHERE, sweep(512)))

    with pytest.raises(ArithmeticError, match="start from diverges"):
        fit(evaluator, replace(NOWHERE, values={"damping": -1e6}), ())


@pytest.mark.parametrize(
    ("rig", "sigmas", "force"),
    [
        (oscillator(), (1.0, -1.5, 2.0), multisine()),
        (REFERENCE, (1.0, -1.5, 1.0, 1.2, -1.0, 1.5, -1.0, 0.8, -1.4), multisine(3072, rms=2.0, low=10.0)),
    ],
    ids=["oscillator", "beam"],
)
def test_perturbed_numbers_come_back(rig, sigmas, force):
    truth = moved(rig, *sigmas)
    evaluator = evaluator_of(measured(truth, force))
    unknowns = rig_unknowns(rig)

    found = fit(evaluator, Hypothesis(rig), unknowns)

    errors = [(u.get(found.hypothesis) - s) / std for u, s, std in zip(unknowns, sigmas, found.std(), strict=True)]
    assert np.abs(errors).max() < 4.0
    assert found.ratio == pytest.approx(1.0, abs=0.1)
    # Young's modulus, or the spring, is told far better than it was known.
    assert min(found.std()) < 0.1


def test_what_is_known_beforehand_stays_where_the_data_are_silent():
    rig = oscillator(freq=60.0)
    evaluator = evaluator_of(measured(Hypothesis(rig), 1e-3 * multisine(1024), noise=1e3))

    found = fit(evaluator, Hypothesis(rig), rig_unknowns(rig))

    np.testing.assert_allclose(found.std(), 1.0, atol=0.05)


def test_starts_of_two_records_are_kept_apart():
    rig = oscillator("velocity")
    truth = Hypothesis(rig)
    for entry, scale in enumerate((1e-3, 0.5)):
        truth = StartUnknown(entry, 2, scale, "a").set(truth, 1.0)
        truth = StartUnknown(entry, 2, scale, "b").set(truth, -2.0)
    pairs = [measured(truth, sweep(768), seed=k, name=name, moving_start=True) for k, name in enumerate("ab")]
    evaluator = evaluator_of(*pairs, rig=rig)
    unknowns = start_unknowns(Hypothesis(rig), [record for record, _ in pairs])

    found = fit(evaluator, Hypothesis(rig), unknowns)

    half = evaluator.n_data // 2
    for unknown, row, std in zip(unknowns, found.jacobian, found.std(), strict=True):
        own, other = (row[:half], row[half:]) if unknown.record == "a" else (row[half:], row[:half])
        assert np.any(own != 0.0)
        assert np.all(other == 0.0)
        assert abs(unknown.get(found.hypothesis) - unknown.get(truth)) < 4.0 * std
    assert found.ratio == pytest.approx(1.0, abs=0.1)


def test_the_rest_reading_of_a_channel_is_found():
    rig = oscillator("displacement")
    record, noise = measured(Hypothesis(rig), sweep(2048), moving_start=True)
    shifted = replace(record, excitation=record.excitation + 0.8)
    unknowns = start_unknowns(Hypothesis(rig), [shifted])

    found = fit(evaluator_of((shifted, noise), rig=rig), Hypothesis(rig), unknowns)

    offset = next(i for i, u in enumerate(unknowns) if isinstance(u, OffsetUnknown))
    error = found.hypothesis.offsets["test"] - 0.8
    assert abs(error) < 4.0 * found.std()[offset] * unknowns[offset].scale
    assert not any(isinstance(u, RigUnknown) for u in unknowns)


def test_two_names_for_one_number_are_known_no_better_than_their_tolerance():
    truth = Hypothesis(REFERENCE, effects=(YoungsModulus(Place(), ratio=0.95),))
    evaluator = evaluator_of(measured(truth, multisine(2048, rms=5.0)))
    unknowns = (*rig_unknowns(REFERENCE), *effect_unknowns(truth))

    found = fit(evaluator, truth, unknowns, max_iterations=3, precise=True)

    tolerance = REFERENCE.tolerances["youngs_modulus"]
    std = float(found.std()[-1]) * YoungsModulus.parameters()["ratio"].spread  # its coordinate is a logarithm
    assert 0.8 * tolerance < std < 1.3 * tolerance


@pytest.mark.parametrize("exponent", [1.5, 3.2])
def test_numbers_that_nearly_imitate_each_other_are_told_apart(exponent):
    """A fit that took differences over a hundredth of a spread crawled here, and ended with the gap at its bound."""
    truth = replace(NOWHERE, values={"K": 0.0, "n": 2.4 / 0.4, "gap": 0.3})
    start = replace(NOWHERE, values={"K": 0.5 * (2.4 - exponent) * np.log(3e-4), "n": exponent / 0.4, "gap": 0.0})

    found = fit(Impact(truth), start, Impact.unknowns)

    assert found.ratio < 1.1
    assert found.hypothesis.values["n"] == pytest.approx(2.4 / 0.4, abs=4.0 * found.std()[1])
    assert found.hypothesis.values["gap"] == pytest.approx(0.3, abs=4.0 * found.std()[2])


def test_rough_differences_close_no_valley():
    """Two columns that are each wrong by a hundredth seemed to tell the gaps apart."""
    found = fit(Rough(), replace(NOWHERE, values={"one": 0.4, "other": -1.0}), Rough.unknowns, precise=True)

    assert found.penalty < 0.1
    along = np.array([-Rough.weight, 1.0]) / np.hypot(Rough.weight, 1.0)
    assert along @ found.covariance @ along == pytest.approx(1.0, rel=0.2)


def test_what_one_record_has_for_itself_has_no_slope_in_another():
    """What a valley's correction laid there was of rounding's size, and was divided by as a record was left out."""
    found = fit(TwoRecords(), replace(NOWHERE, values={"clock": 0.4, "a": -1.0}), TwoRecords.unknowns, precise=True)

    assert not found.jacobian[1, 200:].any()
    assert not found.jacobian[2, :200].any()
    along = np.array([1.0, -1.0, -1.3]) / np.linalg.norm([1.0, -1.0, -1.3])
    assert np.linalg.norm(along @ found.jacobian) < 1e-3 * np.linalg.norm(found.jacobian[0])
    assert found.std()[0] == pytest.approx(1.0, rel=0.2)


@pytest.mark.parametrize("of_each", [(0.9, 0.8), (0.3, 0.2)], ids=["all of it", "its share"])
def test_what_two_valleys_miss_is_added_at_once_to_what_acts(of_each):
    """One after the other they undo each other, where what acts makes them no longer orthogonal."""
    turned = np.linalg.qr(np.random.default_rng(3).standard_normal((5, 5)))[0]
    acts = np.array([True, True, True, False, False])
    directions = directions_with(of_each, turned)
    missed = np.random.default_rng(4).standard_normal((2, 7))

    change = _least_change(directions, acts, missed)

    assert not change[~acts].any()
    shares, axes = np.linalg.eigh(directions[:3].T @ directions[:3])
    np.testing.assert_allclose(np.sort(shares), np.sort(of_each))
    added = np.minimum(shares / LEAST_ACTING, 1.0)
    np.testing.assert_allclose(axes.T @ directions.T @ change, added[:, None] * (axes.T @ missed), atol=1e-12)


def directions_with(shares, turned):
    """(5, 2) two orthonormal directions, of which the first three rows hold these shares, along two axes of theirs."""
    acting, resting = np.linalg.qr(turned[:3, :3])[0][:, :2], np.linalg.qr(turned[3:, :2])[0]
    both = np.vstack([acting * np.sqrt(shares), resting * np.sqrt(1.0 - np.array(shares))])
    return both @ np.array([[0.8, 0.6], [-0.6, 0.8]])


def test_only_the_prior_splits_a_product_that_the_data_tell():
    """A fit that begins down the valley comes back to the tolerance's middle, not only to its floor."""
    stiffer = ContactStiffness(Place(sleeve="sleeve 2"), ratio=0.5)
    truth = Hypothesis(REFERENCE, effects=(stiffer,))
    evaluator = evaluator_of(measured(truth, multisine(2048, rms=20.0)))
    unknowns = (*rig_unknowns(REFERENCE), *effect_unknowns(truth))
    spring = next(u for u in unknowns if isinstance(u, RigUnknown) and u.parameter.path == "sleeves[1].stiffness")
    down = spring.set(truth, 2.0)
    share = down.values[spring.parameter.path] / spring.parameter.value
    down = replace(down, effects=(replace(stiffer, ratio=0.5 / share),))

    found = fit(evaluator, down, unknowns, max_iterations=8, tolerance=0.0, precise=True)

    assert abs(spring.get(found.hypothesis)) < 0.1
    assert found.hypothesis.effects[0].ratio == pytest.approx(0.5, rel=0.02)
    assert found.std()[unknowns.index(spring)] == pytest.approx(1.0, abs=0.05)


def test_what_the_data_do_not_tell_is_not_known():
    unknowns = [Number(name) for name in NAMES]
    silent = MATRIX * np.array([1.0, 1.0, 0.0])

    found = fit(Linear(silent, RIGHT, unknowns), NOWHERE, unknowns, max_iterations=2)

    assert found.std()[2] > 100.0
    assert max(found.std()[:2]) < 1.0


def test_a_slope_that_no_valley_can_have_is_not_believed(monkeypatch):
    """Mass, stiffness and the force's gain nearly cancel; a difference over next to nothing is no slope of theirs."""
    rig, evaluator = REFERENCE, evaluator_of(measured(Hypothesis(REFERENCE), multisine(rms=2.0)))
    hypothesis = Hypothesis(rig, effects=(ForceGain(Place(), gain=1.01),))
    unknowns, asked = (*rig_unknowns(rig), *effect_unknowns(hypothesis)), []

    def fitted(slope):
        monkeypatch.setattr("identification.fit.NEARLY_CANCELLED", 1.0)
        monkeypatch.setattr("identification.fit._slope_along", lambda *_: asked.append(slope) or slope)
        return fit(evaluator, hypothesis, unknowns, precise=True).covariance

    np.testing.assert_array_equal(fitted(np.full(evaluator.n_data, 1e6)), fitted(None))
    assert len(asked) > 2
