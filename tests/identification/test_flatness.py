"""A number whose valley is flatter than its slopes say has a wider interval, and no other has."""

import numpy as np
import pytest
from trial_records import REFERENCE

from identification.fit import Fit
from identification.flatness import FARTHEST, MOVE, flattened
from identification.hypothesis import Hypothesis, coordinates, effect_unknowns
from models.effects import Place
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain

GAIN, WIDE = SensorGain(Place(sensor="P4"), gain=1.2), 0.1
UNKNOWNS = effect_unknowns(Hypothesis(REFERENCE, effects=(GAIN,)))


class Valley:
    """Stands for records whose residual is a function of one coordinate, beside some noise."""

    def __init__(self, shape, unknowns=UNKNOWNS):
        self.shape, self.unknowns = shape, unknowns
        self.noise = np.random.default_rng(0).standard_normal(1000)

    def residuals(self, asked):
        return [self.noise + self.shape(coordinates(model, self.unknowns)[0] - self.centre) for model, _ in asked]

    def fitted(self, effect=GAIN, slope=None):
        """At its centre, with the slope there and the deviation that this gives."""
        model = Hypothesis(REFERENCE, effects=(effect,))
        self.centre = coordinates(model, self.unknowns)[0]
        step = 1e-6
        jacobian = (self.shape(step) - self.shape(-step))[None] / (2.0 * step)
        covariance = 1.0 / (jacobian @ jacobian.T)
        (residual,) = self.residuals([(model, None)])
        chi2 = float(residual @ residual)
        return Fit(model, self.unknowns, chi2, 0.0, len(residual), residual, jacobian, covariance)


ALONG = np.zeros(1000)
ALONG[0] = 1.0 / WIDE


def factor_of(valley, **about):
    found = valley.fitted(**about)
    return float(flattened(valley, found).std()[0] / found.std()[0])


def test_a_straight_valley_is_as_wide_as_its_slopes_say():
    assert factor_of(Valley(lambda x: x * ALONG)) == 1.0


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_valley_that_levels_out_to_one_side_is_wider(side):
    """The residual stops growing a deviation away."""
    factor = factor_of(
        Valley(lambda x: WIDE * np.tanh(np.maximum(side * x, 0.0) / WIDE) * ALONG + np.minimum(side * x, 0.0) * ALONG)
    )
    assert factor > 2.0


def test_a_valley_that_closes_is_no_narrower():
    assert factor_of(Valley(lambda x: WIDE * np.sinh(x / WIDE) * ALONG)) == 1.0


def test_how_far_is_looked_is_bounded():
    assert factor_of(Valley(lambda x: WIDE * np.tanh(x / WIDE) * ALONG)) <= 2.0 * FARTHEST / MOVE


def test_what_is_at_its_bound_is_not_moved_beyond():
    """The lightest mass that there is: below it nothing changes, and that tells nothing."""
    mass = PointMass(Place(sleeve="sleeve 1", position=0.45), mass=1e-30)
    unknowns = effect_unknowns(Hypothesis(REFERENCE, effects=(mass,)))
    about = unknowns[0].about
    lightest = PointMass(mass.place, mass=max(about.lower, 1e-30))
    assert factor_of(Valley(lambda x: x * ALONG, unknowns), effect=lightest) == 1.0


def test_numbers_of_the_rig_alone_are_left_as_they_are():
    bare = Fit(Hypothesis(REFERENCE), (), 1.0, 0.0, 1, np.zeros(1), np.zeros((0, 1)), np.zeros((0, 0)))
    assert flattened(Valley(lambda x: x), bare) is bare
