import numpy as np
import pytest

from identification.decay.damping_terms import shares_of, three_terms
from models.errors import InputError


def test_each_term_alone_and_any_weights_are_the_same_dashpot():
    omega, ratio = np.array([np.sqrt(160.0)]), np.array([0.01])
    expected = 2.0 * 0.01 * omega * 5.0
    for weights in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (0.2, 0.3, 0.5)):
        assert three_terms(ratio, omega, 5.0, 800.0, weights).dashpot == pytest.approx(expected)


def test_the_energy_lost_in_a_cycle_is_counted_once():
    """Force times velocity over one cycle, the complex term as loss stiffness times the signal a quarter period on."""
    m, k, ratio = 5.0, 800.0, 0.02
    omega = np.sqrt(k / m)
    terms = three_terms(np.array([ratio]), np.array([omega]), m, k)
    t = np.linspace(0.0, 2.0 * np.pi / omega, 2000, endpoint=False)
    v = -omega * np.sin(omega * t)
    turned = -np.sin(omega * t)  # j x of x = cos
    force = (terms.mass_term + terms.stiffness_term) * v + terms.hysteretic_term * turned
    lost = np.mean(force * v) * 2.0 * np.pi / omega
    stored = 0.5 * k
    assert lost / stored == pytest.approx(4.0 * np.pi * ratio, rel=1e-9)


def test_weights_that_count_the_loss_three_times_are_refused():
    with pytest.raises(InputError, match=r"weights \(1.0, 1.0, 1.0\) .* sum to 1, or the loss is counted .*; divide"):
        three_terms(np.array([0.01]), np.array([10.0]), 1.0, 100.0, (1.0, 1.0, 1.0))
    with pytest.raises(InputError, match="mass of 0 kg"):
        three_terms(np.array([0.01]), np.array([10.0]), 0.0, 100.0)


@pytest.mark.parametrize("truth", [(1.2, 0.0, 0.0), (0.0, 6e-6, 0.0), (0.0, 0.0, 0.01), (1.2, 6e-6, 0.004)])
def test_the_mechanism_is_recovered_from_several_modes(truth):
    omega = 2.0 * np.pi * np.array([9.0, 40.0, 91.0, 189.0])
    ratios = 0.5 * (truth[0] / omega + truth[1] * omega + truth[2])
    found = shares_of(omega, ratios)
    assert found.coefficients == pytest.approx(truth, rel=1e-6, abs=1e-9)
    assert found.weights.sum(axis=1) == pytest.approx(1.0)
    assert found.misfit < 1e-9


def test_one_mode_shares_equally():
    found = shares_of(np.array([10.0]), np.array([0.02]))
    assert found.weights[0] == pytest.approx([1 / 3, 1 / 3, 1 / 3])
    assert 0.5 * (found.coefficients[0] / 10.0 + found.coefficients[1] * 10.0 + found.coefficients[2]) == pytest.approx(
        0.02
    )
