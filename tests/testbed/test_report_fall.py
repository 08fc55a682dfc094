"""Where the error falls: the range of frequencies, the channel, the time and the level, told from the maps alone."""

from dataclasses import replace

import numpy as np
import pytest
from made_up_diagnosis import made_up_diagnosis

from testbed.report.evidence import because
from testbed.report.fall import narrowest, where_it_falls
from tests.identification.trial_records import REFERENCE

RIG = REFERENCE.model_copy(update={"sensors": REFERENCE.sensors[2:5]})
BANDS = np.geomspace(10.0, 160.0, 5)


def diagnosis_of(before, late=1.0, levels=(3.0,), errors=(1.0,)):
    """A diagnosis whose error falls from these maps, (n_sensors, 5), to a hundredth, later by a factor."""
    made_up = made_up_diagnosis(RIG)
    by_time = np.ones((3, 8)) * np.where(np.arange(8) < 4, 1.0, np.sqrt(late))
    first = replace(made_up.where[0], frequency=BANDS, by_time=by_time)
    maps = tuple(
        replace(first, level=level, by_frequency=error * before) for level, error in zip(levels, errors, strict=True)
    )
    updated = tuple(replace(each, by_frequency=0.01 * before, by_time=0.01 * by_time) for each in maps)
    return replace(made_up, where=maps, updated_maps=updated)


def one_band(band, sensor=None):
    before = np.full((3, 5), 0.01)
    before[slice(None) if sensor is None else sensor, band] = 0.3
    return before


def test_it_lies_in_the_bands_that_hold_most_of_it():
    words = where_it_falls(diagnosis_of(one_band(2)))

    assert words.startswith(
        "In sweep.csv most of the error that goes lies between 28.3 and 56.6 Hz, spread over the channels,"
    )


def test_the_ends_of_the_range_are_those_of_the_excitation():
    assert "between 10 and 14.1 Hz" in where_it_falls(diagnosis_of(one_band(0)))
    assert "between 113 and 160 Hz" in where_it_falls(diagnosis_of(one_band(4)))


def test_what_is_spread_over_the_band_has_no_range():
    assert "over the whole band, spread over the channels" in where_it_falls(diagnosis_of(np.full((3, 5), 0.2)))


def test_one_channel_is_named():
    sensor = RIG.sensors[1].name
    assert f"Hz, 99 % of it in {sensor}." in where_it_falls(diagnosis_of(one_band(1, sensor=1)))


@pytest.mark.parametrize(
    ("late", "told"), [(1.2, " first."), (2.0, ", and more of it late than early"), (0.5, ", and more of it early")]
)
def test_what_grows_is_told(late, told):
    assert told in where_it_falls(diagnosis_of(one_band(1), late))


@pytest.mark.parametrize(
    ("error", "told"), [(2.0, "it grows with the level"), (0.5, "it falls with"), (1.1, "it hardly changes with")]
)
def test_how_the_error_goes_with_the_level_is_told(error, told):
    words = where_it_falls(diagnosis_of(one_band(1), levels=(3.0, 6.85), errors=(1.0, error)))

    share = np.sqrt(0.3**2 + 4 * 0.01**2)
    assert f"As a share of the motion {told}" in words
    assert f"{100 * share:.0f} % at 3 N rms" in words
    assert words.endswith(f"{100 * share * error:.0f} % at 6.85.")


def test_levels_that_are_nearly_one_say_nothing():
    assert "level" not in where_it_falls(diagnosis_of(one_band(1), levels=(3.0, 3.3), errors=(1.0, 2.0)))


def test_where_nothing_falls_nothing_is_said():
    made_up = diagnosis_of(one_band(1))
    assert where_it_falls(replace(made_up, updated_maps=made_up.where)) == ""
    assert where_it_falls(replace(made_up, where=(), updated_maps=())) == ""


def test_it_is_among_what_speaks_for_a_verdict():
    diagnosis = diagnosis_of(one_band(2))
    assert where_it_falls(diagnosis) in because(diagnosis)


def test_the_narrowest_range_is_found_and_not_the_first():
    assert narrowest(np.array([1.0, 0.0, 3.0, 4.0, 0.0, 2.0]), 0.7) == (2, 4)
    assert narrowest(np.array([1.0, 1.0]), 1.0) == (0, 2)
