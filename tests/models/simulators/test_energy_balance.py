import numpy as np
import pytest

from models.simulators.protocol import EnergyBalance
from models.simulators.recorded import rate_of


def test_a_balance_that_holds_has_no_fault():
    supplied = np.array([0.0, 1.0, 3.0])
    damped, taken = 0.2 * supplied, 0.3 * supplied
    assert EnergyBalance(5.0 + 0.5 * supplied, supplied, damped, taken).fault == pytest.approx(0.0, abs=1e-15)


def test_what_nobody_accounts_for_is_told_as_a_share_of_what_moved():
    nothing = np.zeros(3)
    balance = EnergyBalance(np.array([2.0, 2.0, 2.3]), np.array([0.0, 1.0, -1.0]), nothing, nothing)
    assert balance.fault == pytest.approx(1.3 / 3.0)


def test_the_rate_of_what_starts_still_is_of_fourth_order():
    errors = []
    for n in (50, 100):
        time = np.arange(n + 1) / n
        found = rate_of((1.0 - np.cos(3.0 * time))[None], float(n))[0]
        errors.append(np.abs(found - 3.0 * np.sin(3.0 * time))[: n - 2].max())
    assert np.log2(errors[0] / errors[1]) == pytest.approx(4.0, abs=0.1)
