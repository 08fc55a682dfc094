"""The tests on the bench: soft taps, after which the sleeves stay as they are, and a multisine that strikes both.

The shaker on the rod gives the records by which models are updated and diagnosed; the shaker table gives those by which
they are judged, and nothing is learnt from these.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np

from models.arrays import FloatArray
from models.excitations import random_phase_multisine
from models.plant import build_plant
from models.record import Record
from testbed.article.published import published
from testbed.article.rig import Drive, Geometry
from testbed.article.strikes import EXCITED, LEVELS
from testbed.article.truth import SEED, truth_of
from testbed.cosim.taps import Taps, rehearse
from testbed.hidden_effects.truth import measure

FS = 2048.0
"""Hz."""

TAPS, STRUCK = "taps", "struck"
"""Names of the two records of a test."""

TAP_EVERY, TAP_WIDTH = 1.0, 6e-3
"""s; a half sine of this width reaches beyond the fourth mode, and between two taps that mode drowns."""

TAPPED = 8.0
"""s of taps: as long as the multisine, since the grease changes meanwhile."""

PERIOD, PERIODS = 2.0, 4
"""s, of the multisine; the first period holds the start and is not judged."""


@dataclass(frozen=True, eq=False)
class BenchTest:
    """What one test gave.

    Attributes:
        taps: record of the soft taps.
        struck: record of the multisine.
        noise: NRMSE that the noise leaves of a perfect model, of the multisine.
    """

    taps: Record
    struck: Record
    noise: float


@cache
def taps_of(geometry: Geometry, drive: Drive) -> Taps:
    """The taps, as planned from the rig files: at all clearances those that the most delicate one bears.

    What rubs and what squeezes answers a stronger tap in another way, so taps of one strength can be compared.

    Args:
        geometry: of the rig.
        drive: which test.
    """
    taps = Taps(TAP_EVERY, TAP_WIDTH, 1.0)
    rigs = (geometry.rig(test.clearance, drive) for test in published())
    return replace(taps, peak=min(rehearse(build_plant(rig), taps, FS).peak for rig in rigs))


def struck_by(drive: Drive) -> FloatArray:
    """(N,) the multisine, m/s^2 of the table or N of the shaker.

    Args:
        drive: which test.
    """
    rng = np.random.default_rng([SEED, 2, int(drive == "table")])
    n_samples = round(PERIOD * FS) * PERIODS
    return random_phase_multisine(rng, FS, n_samples, PERIODS, *EXCITED, rms=LEVELS[drive])


def bench_test(geometry: Geometry, clearance: float, drive: Drive, engine: str) -> BenchTest:
    """Carry out one test.

    Args:
        geometry: of the rig.
        clearance: of both sleeves, m, one of the article's.
        drive: which test.
        engine: that moves the rig.

    Raises:
        DivergenceError: the engine lost the motion.
    """
    truth = truth_of(geometry, clearance, drive, engine)
    tapped = taps_of(geometry, drive).force(FS, 0, round(TAPPED * FS))
    rng = np.random.default_rng([SEED, 3, round(1e6 * clearance), int(drive == "table")])
    taps, _ = measure(truth, TAPS, tapped, FS, rng)
    struck, noise = measure(truth, STRUCK, struck_by(drive), FS, rng)
    return BenchTest(taps, struck, noise)
