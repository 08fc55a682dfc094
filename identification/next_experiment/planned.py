"""A test that could be done: its excitation as an experiment file says it, and the record of it before it is made."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import numpy as np

from models.arrays import FloatArray
from models.excitations import half_sine_hammer, logarithmic_sweep, random_phase_multisine
from models.record import Record

SEED = 0
"""Of the phases; an experiment file with this seed makes the very signal that was weighed here."""


@dataclass(frozen=True)
class PlannedTest:
    """One test.

    Attributes:
        words: what to do.
        family: what is varied: tests of one family are much alike.
        excitation: keys and values of the ``[excitation]`` table of an experiment file (docs/experiments.md), SI.
        fs: rate of the record, Hz.
        setup: minutes before the record.
        sensor: where one more sensor sits, m from the clamp, or None.
    """

    words: str
    family: str
    excitation: Mapping[str, Any]
    fs: float
    setup: float
    sensor: float | None = None

    @property
    def seconds(self) -> float:
        """Length of the record."""
        table = self.excitation
        if table["kind"] == "multisine":
            return float(table["period"] * table["periods"])
        if table["kind"] == "hammer":
            return float(table["start"] + table["blows"] * table["interval"])
        return float(table["duration"])

    @property
    def minutes(self) -> float:
        """Set-up and record."""
        return self.setup + self.seconds / 60.0

    @property
    def is_steady(self) -> bool:
        """Whether every second of it tells as much as any other."""
        return bool(self.excitation["kind"] == "multisine")

    @property
    def is_held(self) -> bool:
        """Whether the rig is let go at the first sample, without an excitation channel."""
        return bool(self.excitation["kind"] == "release")

    def record(self, name: str, sensors: tuple[str, ...], seconds: float | None = None) -> Record:
        """The record with its excitation and silent sensors.

        Args:
            name: of the record.
            sensors: that listen.
            seconds: of a steady test, whole periods; all of it by default.
        """
        n = round((seconds or self.seconds) * self.fs)
        force = None if self.is_held else SIGNALS[self.excitation["kind"]](self.excitation, self.fs, n)
        return Record(
            name=name,
            fs=self.fs,
            excitation=force,
            sensors=sensors,
            responses=np.zeros((len(sensors), n)),
            excitation_position=None if self.is_held else self.excitation.get("position"),
            moving_start=self.is_held,
        )


def _multisine(table: Mapping[str, Any], fs: float, n: int) -> FloatArray:
    rng, periods = np.random.default_rng(SEED), round(n / (table["period"] * fs))
    return random_phase_multisine(rng, fs, n, periods, table["low"], table["high"], table["rms"])


def _sweep(table: Mapping[str, Any], fs: float, n: int) -> FloatArray:
    return logarithmic_sweep(fs, n, table["low"], table["high"], table["amplitude"])


def _blows(table: Mapping[str, Any], fs: float, n: int) -> FloatArray:
    starts = (table["start"] + number * table["interval"] for number in range(table["blows"]))
    return np.asarray(
        np.sum([half_sine_hammer(fs, n, start, table["width"], table["peak"]) for start in starts], axis=0)
    )


SIGNALS: Mapping[str, Callable[[Mapping[str, Any], float, int], FloatArray]] = MappingProxyType(
    {"multisine": _multisine, "sweep": _sweep, "hammer": _blows}
)
"""By kind of excitation; a rig that is held and let go has none."""
