"""What each way explains is weighed by exact algebra, whatever its layout in memory."""

import numpy as np
import pytest

from identification.locating.lines import Lines
from identification.locating.weigh import DENSITIES, MULTIPLIED, _log_of_product, _Way


@pytest.mark.parametrize("lines", [1, MULTIPLIED - 1, MULTIPLIED, MULTIPLIED + 1, 1000])
def test_the_logarithm_of_a_product_is_the_sum_of_the_logarithms(lines):
    rng = np.random.default_rng(lines)
    factors = 1.0 + 10.0 ** rng.uniform(-12.0, 15.0, (3, lines, 2))

    assert _log_of_product(factors) == pytest.approx(np.log(factors).sum(axis=1), rel=1e-12)


def test_so_many_factors_of_a_million_lines_are_no_overflow():
    largest = np.full((1, MULTIPLIED, 1), 1.0 + DENSITIES[-1] * 1e6)
    assert _log_of_product(largest) == pytest.approx(MULTIPLIED * np.log(largest[:, 0]))


def test_what_is_seen_along_a_way_and_what_is_left_without_it_are_those_of_complex_lines():
    rng = np.random.default_rng(1)
    left, ways, common = (rng.standard_normal((2, 30, 4, *n)) for n in ((), (3,), (5,)))
    lines = Lines(*(real + 1j * imag for real, imag in (left, ways, common)), np.zeros(2))
    way, x, share = _Way(lines), rng.standard_normal((3, 5)), rng.random((30, 3))
    unit = lines.ways / np.linalg.norm(lines.ways, axis=1, keepdims=True)
    along = np.einsum("lcw,lc->lw", unit.conj(), lines.left)
    across = np.einsum("lcw,lck->lwk", unit.conj(), lines.common)

    seen, freed = way.seen(x), way.freed(share)

    assert seen == pytest.approx(along - np.einsum("lwk,wk->lw", across, x))
    b = np.einsum("lck,lc->k", lines.common.conj(), lines.left).real
    n = np.einsum("lck,lcj->kj", lines.common.conj(), lines.common).real
    assert freed.b == pytest.approx(b - np.einsum("lw,lwk,lw->wk", share, across.conj(), along).real)
    assert freed.n == pytest.approx(n - np.einsum("lw,lwk,lwj->wkj", share, across.conj(), across).real)
