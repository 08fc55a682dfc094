"""The article's rig and short tests of it by the modal model, for the tests of the study."""

from functools import cache

import numpy as np

from models.record import Record
from testbed.article.bench import BenchTest, struck_by, taps_of
from testbed.article.rig import calibrated
from testbed.article.truth import truth_of
from testbed.hidden_effects.truth import measure

FS = 2048.0


@cache
def geometry():
    return calibrated()


@cache
def bench_test_by_model(clearance, drive):
    """Both records, of the same truth as the study's, by the modal model, with little noise."""
    truth, rng = truth_of(geometry(), clearance, drive, "modal"), np.random.default_rng(1)
    tapped = taps_of(geometry(), drive).force(FS, 0, round(8.0 * FS))
    taps, _ = measure(truth, "taps", tapped, FS, rng)
    struck, noise = measure(truth, "struck", struck_by(drive), FS, rng)
    assert isinstance(taps, Record)
    return BenchTest(taps, struck, noise)
