"""The article's improvements, and ours beside them: what was asked for, what was reached."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from models.arrays import FloatArray
from testbed.article.three_models import DIAGNOSED, INITIAL, UPDATED
from testbed.outputs import Json

MAC_GAIN, MAC_ENOUGH = 0.4397, 0.98
MRE_LESS, RMSE_LESS = 0.326, 0.1819
LEAST_FRAC, LARGEST_FREQ_ERROR = 0.95, 0.0054
DIAGNOSED_LESS, DIAGNOSED_FRAC = 0.8, 0.99


@dataclass(frozen=True)
class Bar:
    """One figure.

    Attributes:
        what: in words.
        asked: in words.
        reached: on the tests of one engine.
        is_met: whether that is enough.
    """

    what: str
    asked: str
    reached: str
    is_met: bool


def all_of(rows: Sequence[Json], model: str, engine: str, what: str) -> FloatArray:
    """(n_clearances, n) one figure of one model at all clearances.

    Args:
        rows: as ``compared.rows_of`` gives them.
        model: name.
        engine: whose tests.
        what: key.
    """
    return np.array([row["models"][model][engine][what] for row in rows], float)


def bars_of(rows: Sequence[Json], engine: str, updated: str = UPDATED) -> list[Bar]:
    """From the initial to the updated model and to the diagnosed one, all clearances together.

    Args:
        rows: one a clearance.
        engine: whose tests.
        updated: model that is held against the updated one's bars.
    """

    def mean(model: str, what: str) -> float:
        return float(all_of(rows, model, engine, what).mean())

    def less(model: str, what: str) -> float:
        return 1.0 - mean(model, what) / mean(INITIAL, what)

    mac, gain = mean(updated, "mac"), mean(updated, "mac") / mean(INITIAL, "mac") - 1.0
    frac = {model: float(all_of(rows, model, engine, "frac").min()) for model in (updated, DIAGNOSED)}
    freq = float(np.abs(all_of(rows, updated, engine, "freq_errors")).max())
    bars = [
        Bar(
            "updated: mean MAC",
            f"+{MAC_GAIN:.2%}, or above {MAC_ENOUGH:g}",
            f"{gain:+.2%}, to {mac:.4f}",
            gain >= MAC_GAIN or mac > MAC_ENOUGH,
        )
    ]
    for name, model, what, asked in (
        (UPDATED, updated, "mre", MRE_LESS),
        (UPDATED, updated, "rmse", RMSE_LESS),
        (DIAGNOSED, DIAGNOSED, "mre", DIAGNOSED_LESS),
        (DIAGNOSED, DIAGNOSED, "rmse", DIAGNOSED_LESS),
    ):
        reached = less(model, what)
        bars.append(Bar(f"{name}: {what.upper()} of the FRF", f"-{asked:.2%}", f"{-reached:+.2%}", reached >= asked))
    for name, model, asked in ((UPDATED, updated, LEAST_FRAC), (DIAGNOSED, DIAGNOSED, DIAGNOSED_FRAC)):
        bars.append(
            Bar(f"{name}: least FRAC of all points", f"above {asked:g}", f"{frac[model]:.4f}", frac[model] > asked)
        )
    bars.append(
        Bar(
            "updated: largest frequency error",
            f"at most {LARGEST_FREQ_ERROR:.2%}",
            f"{freq:.2%}",
            freq <= LARGEST_FREQ_ERROR,
        )
    )
    return bars
