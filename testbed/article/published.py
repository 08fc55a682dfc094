"""What the article printed."""

import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ConfigDict

FILE = Path(__file__).parent / "published.toml"

Four = tuple[float, float, float, float]
Eight = tuple[float, float, float, float, float, float, float, float]


class PrintedTest(BaseModel):
    """The tables of one clearance: four natural frequencies, and errors of the FRF at eight points.

    Attributes:
        clearance: m.
        measured_freqs, initial_freqs, updated_freqs: Hz, of the test, with constant and with time-varying damping.
        initial_mac, updated_mac: of the four mode shapes.
        initial_mre, initial_rmse, initial_frac, initial_csf, initial_csac: at the points, with constant damping.
        updated_mre, updated_rmse, updated_frac, updated_csf, updated_csac: with time-varying damping.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    clearance: float
    measured_freqs: Four
    initial_freqs: Four
    updated_freqs: Four
    initial_mac: Four
    updated_mac: Four
    initial_mre: Eight
    initial_rmse: Eight
    initial_frac: Eight
    initial_csf: Eight
    initial_csac: Eight
    updated_mre: Eight
    updated_rmse: Eight
    updated_frac: Eight
    updated_csf: Eight
    updated_csac: Eight


class PrintedProbability(BaseModel):
    """The article's section 4.3, four orders: shares of the frequencies.

    Attributes:
        stiffness_variation, damping_variation, clearance_variation: variation coefficients of table 6.
        coincidence: of figure 11.
        difference, difference_std, difference_low, difference_high: of table 7.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    stiffness_variation: Four
    damping_variation: Four
    clearance_variation: Four
    coincidence: Four
    difference: Four
    difference_std: Four
    difference_low: Four
    difference_high: Four


@cache
def published() -> tuple[PrintedTest, ...]:
    """The six clearances, the smallest first."""
    return tuple(PrintedTest.model_validate(test) for test in _content()["tests"])


@cache
def published_probability() -> PrintedProbability:
    """What the article says of uncertain numbers."""
    return PrintedProbability.model_validate(_content()["probability"])


def _content() -> dict[str, Any]:
    return tomllib.loads(FILE.read_text(encoding="utf-8"))
