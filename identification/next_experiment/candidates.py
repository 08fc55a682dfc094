"""Tests that can be done with what is at hand: other levels, bands, signals and places, a hammer, a hold, a sensor."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np

from identification.next_experiment.bench import Bench
from identification.next_experiment.costs import Costs, Limits
from identification.next_experiment.planned import PlannedTest
from models.band_limit import SCORE_EDGE
from models.rig import Beam

LEVELS = (0.3, 0.5, 1.0, 2.0, 4.0)
"""Of the excitation, times the loudest so far."""

LONGER = 4
"""How many times as long a repetition at the same level is."""

BLOW, SWING = 2e-3, 2.0
"""Width of a blow, s, and seconds that are recorded after it."""


def at_the_shaker(bench: Bench, costs: Costs) -> Iterator[PlannedTest]:
    """Levels in the band so far and up to what the recorder sees, a sweep, and one long repetition.

    Args:
        bench: what the rig was tested with.
        costs: minutes of each.
    """
    if bench.level == 0.0:
        return
    for level in LEVELS:
        yield steady(bench, costs, level, bench.band, "level")
    yield steady(bench, costs, 1.0, bench.band, "length", longer=LONGER)
    for edge in (3.0 * bench.band[1], WIDEST * bench.fs):
        if WIDER * bench.band[1] < edge <= WIDEST * bench.fs:
            for level in (0.3, 1.0, 2.0):
                yield steady(bench, costs, level, (bench.band[0], edge), "wide band")
    for level in (1.0, 2.0):
        yield swept(bench, costs, level)


WIDEST, WIDER = 0.95 * SCORE_EDGE, 1.3
"""Upper edge of a wide band as a fraction of fs; how much wider it must be to be another test."""


def in_bands(bench: Bench, costs: Costs, bands: Mapping[str, tuple[float, float]]) -> Iterator[PlannedTest]:
    """The whole level in a narrow band.

    Args:
        bench: what the rig was tested with.
        costs: minutes of each.
        bands: lowest and highest frequency, Hz, by what they hold.
    """
    for words, band in bands.items() if bench.level else ():
        for level in (1.0, 2.0, 4.0):
            yield steady(bench, costs, level, band, words)


def about(centre: float, band: tuple[float, float]) -> tuple[float, float]:
    """A narrow band about a frequency, Hz, within another, at whose edge it stands where the frequency lies outside.

    Args:
        centre: its middle, Hz.
        band: of the excitation, Hz.
    """
    centre = min(max(centre, band[0]), band[1])
    low = max(band[0], centre / ABOVE)
    return low, min(max(ABOVE * centre, low + LEAST_WIDTH), band[1])


ABOVE, LEAST_WIDTH = 1.3, 5.0
"""Edges of a narrow band about its middle, as a ratio, and its least width, Hz."""


def elsewhere(bench: Bench, costs: Costs) -> Iterator[PlannedTest]:
    """The shaker at other places along the beam."""
    if bench.level == 0.0 or not bench.is_pushed or not isinstance(bench.rig.structure, Beam):
        return
    for place in places(bench):
        for level in (1.0, 2.0):
            test = steady(bench, costs, level, bench.band, "shaker")
            table = {**test.excitation, "position": place}
            yield replace(
                test, words=f"move the shaker to {place:.3g} m; {test.words}", excitation=table, setup=costs.shaker
            )


def with_a_sensor(bench: Bench, costs: Costs, position: float) -> Iterator[PlannedTest]:
    """One more sensor.

    Args:
        bench: what the rig was tested with.
        costs: minutes of each.
        position: of the sensor, m from the clamp.
    """
    for level in (1.0, 2.0) if bench.level else ():
        test = steady(bench, costs, level, bench.band, "sensor")
        words = f"add a sensor at {position:.3g} m; {test.words}"
        yield replace(test, words=words, setup=costs.sensor, sensor=position)


def struck(bench: Bench, costs: Costs) -> Iterator[PlannedTest]:
    """A blow of 1 N at each place; ``scaled`` makes it as hard as the sensors bear."""
    if not bench.is_pushed:
        return
    table = {"kind": "hammer", "peak": 1.0, "width": BLOW, "blows": 1, "interval": SWING, "start": 0.05}
    if not isinstance(bench.rig.structure, Beam):
        yield PlannedTest("strike the mass", "hammer", table, bench.fs, costs.hammer)
        return
    for place in places(bench):
        yield PlannedTest(f"strike at {place:.3g} m", "hammer", {**table, "position": place}, bench.fs, costs.hammer)


def released(bench: Bench, costs: Costs) -> Iterator[PlannedTest]:
    """Held at the free end by 1 N, upwards and downwards, and let go."""
    if isinstance(bench.rig.structure, Beam):
        end = bench.rig.structure.length
        for force, way in ((1.0, "up"), (-1.0, "down")):
            table = {"kind": "release", "position": end, "force": force, "duration": SWING}
            yield PlannedTest(f"hold the free end {way} and let it go", "decay", table, bench.fs, costs.hold)


def scaled(test: PlannedTest, factor: float) -> PlannedTest:
    """A blow or a hold made larger, rounded to two digits as one would do it.

    Args:
        test: of unit size.
        factor: N.
    """
    key = "peak" if test.excitation["kind"] == "hammer" else "force"
    size = float(f"{factor * test.excitation[key]:.2g}")
    return replace(test, words=f"{test.words}, {abs(size):g} N", excitation={**test.excitation, key: size})


def steady(
    bench: Bench, costs: Costs, level: float, band: tuple[float, float], family: str, *, longer: int = 1
) -> PlannedTest:
    """A multisine.

    Args:
        bench: what the rig was tested with.
        costs: minutes of each.
        level: times the loudest so far.
        band: Hz.
        family: of tests.
        longer: times the usual length.
    """
    low, high = (float(f"{edge:.3g}") for edge in band)
    rms = float(f"{level * bench.level:.3g}")
    period = round(PERIOD * bench.fs) / bench.fs  # whole samples, whatever the rate
    periods = longer * round(bench.seconds / period)
    table: dict[str, Any] = {
        "kind": "multisine", "low": low, "high": high, "rms": rms, "period": period, "periods": periods
    }  # fmt: skip
    words = (
        f"a multisine of {rms:g} {_unit(bench)} rms, {_times(level)}, {low:g} to {high:g} Hz, {periods * period:.3g} s"
    )
    return PlannedTest(words, family, table, bench.fs, costs.setting)


PERIOD = 1.0
"""Seconds after which a multisine repeats: lines 1 Hz apart."""


def swept(bench: Bench, costs: Costs, level: float) -> PlannedTest:
    """A sweep of the same rms.

    Args:
        bench: what the rig was tested with.
        costs: minutes of each.
        level: times the loudest so far.
    """
    low, high = (float(f"{edge:.3g}") for edge in bench.band)
    amplitude = float(f"{np.sqrt(2.0) * level * bench.level:.3g}")
    table = {"kind": "sweep", "low": low, "high": high, "amplitude": amplitude, "duration": bench.seconds}
    words = f"a sweep of {amplitude:g} {_unit(bench)}, {low:g} to {high:g} Hz, {bench.seconds:g} s"
    return PlannedTest(words, "sweep", table, bench.fs, costs.setting)


def allowed(test: PlannedTest, bench: Bench, limits: Limits) -> bool:
    """Whether its excitation is within what a test may go beyond the records so far.

    Args:
        test: planned.
        bench: what the rig was tested with.
        limits: how far it may go.
    """
    if test.is_held or test.excitation["kind"] == "hammer":
        return True
    force = test.record("next", ()).excitation
    return force is None or float(np.abs(force).max()) <= limits.force * bench.peak * ROUNDED


ROUNDED = 1.1
"""Two signals of the same rms have peaks that differ by as much."""


def places(bench: Bench) -> list[float]:
    """Sensors' places, sleeves and the free end, m from the clamp, without those where the force acts already."""
    structure, excitation = bench.rig.structure, bench.rig.excitation
    assert isinstance(structure, Beam)
    here = None if excitation is None else excitation.position
    known = [sensor.position for sensor in bench.rig.sensors if sensor.position]
    apart: list[float] = []
    for place in sorted({*known, *(sleeve.position for sleeve in bench.rig.sleeves), structure.length}):
        if all(abs(place - other) > NEAR * structure.length for other in (*apart, *([here] if here else []))):
            apart.append(place)
    if not apart:
        return []
    few = np.unique(np.linspace(0, len(apart) - 1, MOST_PLACES).round().astype(int))
    return [apart[i] for i in few]


MOST_PLACES = 5
"""Places along the beam at which a force is tried."""

NEAR = 0.05
"""Share of the length within which two places are one."""


def between(bench: Bench) -> list[float]:
    """Middles between neighbouring sensors, sleeves and the free end, m: where one more sensor could sit."""
    structure = bench.rig.structure
    if not isinstance(structure, Beam):
        return []
    taken = [s.position for s in bench.rig.sensors if s.name in bench.sensors and s.position is not None]
    edges = sorted({*taken, *(sleeve.position for sleeve in bench.rig.sleeves), structure.length})
    middles = [round(0.5 * (one + other), 3) for one, other in pairwise(edges)]
    spots = [*middles, *(s.position for s in bench.rig.sleeves), structure.length]
    return [x for x in spots if all(abs(x - other) > NEAR * structure.length for other in taken)]


def _unit(bench: Bench) -> str:
    excitation = bench.rig.excitation
    quantity = "force" if excitation is None else excitation.quantity
    return {"force": "N", "base_acceleration": "m/s^2", "base_velocity": "m/s", "base_displacement": "m"}[quantity]


def _times(level: float) -> str:
    return "as loud as the loudest so far" if level == 1.0 else f"{level:g} times the loudest so far"
