"""Numbers that went far for what a model misses a little are brought back, and those that the records hold are not."""

from dataclasses import replace

import numpy as np
import pytest
from trial_records import REFERENCE

import identification.unstrained as room
from identification.evidence import misfit_of
from identification.fit import Fit
from identification.hypothesis import Hypothesis, coordinates, effect_unknowns, rig_unknowns
from identification.unstrained import FAR, moved_back, unstrained
from models.effects import Place
from models.effects.gap_offset import GapOffset

N = 100_000
OFFSET = GapOffset(Place(sleeve="sleeve 1"), 3e-5)
HYPOTHESIS = Hypothesis(REFERENCE, effects=(OFFSET,))
UNKNOWNS = (*rig_unknowns(REFERENCE), *effect_unknowns(HYPOTHESIS))
CLEARANCE = next(i for i, u in enumerate(UNKNOWNS) if getattr(u, "parameter", None) and "clearance" in u.parameter.path)
LAST = len(UNKNOWNS) - 1


def found(clearance, chi2=float(N)):
    """A fit with a clearance so many deviations from its own, its offset known together with it alone."""
    hypothesis = UNKNOWNS[CLEARANCE].set(HYPOTHESIS, clearance)
    covariance = 1e-4 * np.eye(len(UNKNOWNS))
    covariance[CLEARANCE, LAST] = covariance[LAST, CLEARANCE] = 0.99e-4
    empty = np.zeros((len(UNKNOWNS), 1))
    return Fit(hypothesis, UNKNOWNS, chi2, clearance**2, N, np.array([chi2**0.5]), empty, covariance)


@pytest.fixture
def fitted(monkeypatch):
    """What a fit from the other place ends with, by the chi-square asked for; and where looks and fits began."""
    begun = []

    def ending_with(chi2, of_look=None, slope=0.0):
        def fit(evaluator, start, unknowns, *, precise=False, **how):
            assert precise or how["keep"]
            begun.append(coordinates(start, unknowns))
            ended = found(0.0, chi2 if precise or of_look is None else of_look)
            slopes = ended.jacobian[: len(unknowns)].copy()
            slopes[-1] = slope  # of the offset, of which nobody knows anything beforehand
            return replace(ended, hypothesis=start, unknowns=tuple(unknowns), jacobian=slopes)

        monkeypatch.setattr(room, "fit", fit)
        return begun

    return ending_with


def test_what_is_near_stays(fitted):
    begun = fitted(0.0)
    near = found(0.9 * FAR)
    assert unstrained(None, near) is near
    assert begun == []


def test_a_far_number_comes_back_with_what_is_known_together_with_it(fitted):
    begun = fitted(N + 0.1 * misfit_of(found(-3.0)))
    back = unstrained(None, found(-3.0))
    assert coordinates(back.hypothesis, UNKNOWNS)[CLEARANCE] == pytest.approx(0.0, abs=1e-9)
    moved = begun[0] - coordinates(found(-3.0).hypothesis, UNKNOWNS)
    assert moved[LAST] == pytest.approx(0.99 * 3.0)


def test_what_the_records_hold_there_stays(fitted):
    begun = fitted(N + 20.0 * misfit_of(found(-3.0)), of_look=N)
    far = found(-3.0)
    assert unstrained(None, far) is far
    assert len(begun) == 2


def test_a_look_that_promises_nothing_likelier_is_not_followed(fitted):
    begun = fitted(N, of_look=N + 20.0 * misfit_of(found(-3.0)))
    far = found(-3.0)
    assert unstrained(None, far) is far
    assert len(begun) == 1


def test_a_look_that_is_less_likely_and_promises_more_is_followed(fitted):
    begun = fitted(N, of_look=N + 20.0 * misfit_of(found(-3.0)), slope=400.0)
    far = found(-3.0)
    assert unstrained(None, far) is not far
    assert len(begun) == 2


@pytest.mark.parametrize(("far", "tried"), [(-2.9, 0), (-3.1, 2)])
def test_of_a_calibration_without_effects_only_what_was_pulled_is_tried_elsewhere(fitted, far, tried):
    begun = fitted(N)
    whole = found(far)
    bare = replace(
        whole,
        hypothesis=replace(whole.hypothesis, effects=()),
        unknowns=UNKNOWNS[:LAST],
        covariance=whole.covariance[:LAST, :LAST],
    )

    back = unstrained(None, bare)

    assert len(begun) == tried
    assert (back is bare) == (tried == 0)


def test_it_is_told_where_each_far_number_is_now():
    words = moved_back(found(-3.0), found(-2.5))

    assert words.endswith("clearance of sleeve 1 at -2.5 standard deviations instead of -3.0")
    assert moved_back(found(-3.0), found(-2.97)) == ""
