"""All models against the tests of one clearance that none of them was made with, as the rows of the tables."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from models.plant import build_plant
from testbed.article.bench import BenchTest
from testbed.article.judging import Judged, Measured, judged, measured
from testbed.article.rig import Geometry
from testbed.article.three_models import DIAGNOSED, INITIAL, UPDATED, ThreeModels
from testbed.article.truth import truth_of
from testbed.article.updating import closed_at_rest, identified_without_error
from testbed.outputs import Json

EXACT, EXACT_RIG, PERFECT = "identified without error", "and all numbers true", "perfect"
"""Three that nobody has. The updated model as an identifier without error would make it; the same with clearances and
the rod's own damping true besides, which no frequency tells; and the modal model with all that is hidden. What one of
them leaves less than the one before tells what that part of the error comes from."""

JUDGED = (INITIAL, UPDATED, DIAGNOSED, EXACT, EXACT_RIG, PERFECT)


@dataclass(frozen=True, eq=False)
class Compared:
    """One clearance.

    Attributes:
        clearance: m.
        seen: the table test by each engine.
        models: each on the table test by each engine.
    """

    clearance: float
    seen: Mapping[str, Measured]
    models: Mapping[str, Mapping[str, Judged]]


def compared(geometry: Geometry, clearance: float, three: ThreeModels, tests: Mapping[str, BenchTest]) -> Compared:
    """Hold the models against the table test.

    Args:
        geometry: of the rig.
        clearance: of both sleeves, m.
        three: the models.
        tests: the table test by engine.

    Raises:
        DivergenceError: a model's motion left the finite numbers.
    """
    rig = geometry.rig(clearance, "table")
    seen = {engine: measured(rig, test) for engine, test in tests.items()}
    plants = {name: build_plant(model) for name, model in three.driven_like(rig).items()}
    truth = truth_of(geometry, clearance, "table", "modal")
    exact, dampings = identified_without_error(truth, rig, closed_at_rest(rig))
    plants[EXACT] = build_plant(exact, dampings)
    plants[EXACT_RIG] = build_plant(truth.built, dampings)
    plants[PERFECT] = truth.plant
    return Compared(
        clearance,
        seen,
        {name: {engine: judged(plants[name], one) for engine, one in seen.items()} for name in JUDGED},
    )


def rows_of(found: Compared) -> Json:
    """What the tables show.

    Args:
        found: one clearance.
    """
    return {
        "clearance": found.clearance,
        "tests": {
            engine: {
                "natural_freqs": seen.modes.mean_freqs,
                "damping_ratios": seen.modes.damping_ratios.mean(axis=0),
                "noise": seen.test.noise,
            }
            for engine, seen in found.seen.items()
        },
        "models": {
            name: {engine: _row(one) for engine, one in by_engine.items()} for name, by_engine in found.models.items()
        },
    }


NUMBERS = (
    "natural_freqs",
    "damping_ratios",
    "freq_errors",
    "mac",
    "mre",
    "rmse",
    "frac",
    "csf",
    "csac",
    "mre_fourth",
    "nrmse",
)


def _row(one: Judged) -> Json:
    return {name: np.asarray(getattr(one, name)) for name in NUMBERS}
