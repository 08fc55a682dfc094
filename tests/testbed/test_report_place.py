"""The place of the missing force in the report and in diagnosis.json."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_up_diagnosis import made_up_diagnosis

from identification.locating.located import Curve, FreedChannel, Located, PlacedForce, Shape
from models.rig_file import read_rig
from testbed.loop import diagnosis_json
from testbed.report import provenance, write_report
from testbed.report.place_figure import place_picture
from testbed.report.words import headline, second_line

RIG = Path("tests/data/reference_rig.toml")
WORDS = "one force at sleeve 2, 1.000 m from the clamp explains 93% of the misfit"


def made_up_place():
    time = np.arange(400) / 100.0
    force = PlacedForce("sweep.csv", 100.0, 1e-3 * np.sin(time), 1e-3 * np.cos(time), -np.sin(time), np.ones(140))
    x = np.linspace(-1e-3, 1e-3, 9)
    names = ("displacement", "velocity", "acceleration", "time", "amplitude")
    curves = tuple(Curve(name, x, -1e3 * x, np.full(9, 0.01)) for name in names)
    shape = Shape((("displacement", 0.83),), ("it follows the displacement (83%)",), curves, (force,), 0.0)
    positions = np.linspace(0.1, 1.4, 14)
    explained, channels = np.exp(-((positions - 1.0) ** 2) / 0.02), (FreedChannel("P1", 0.1, 4.0),)
    return Located(
        positions, explained, channels,
        5.0, 1.1, 1.0, (0.99, 1.01), "sleeve 2", None, 0.93, enough=True, words=WORDS, forces=(force,), shape=shape,
    )  # fmt: skip


@pytest.fixture(scope="module")
def diagnosis():
    return replace(made_up_diagnosis(read_rig(RIG)), located=made_up_place())


def test_the_json_names_place_interval_and_shape(diagnosis):
    where = diagnosis_json(diagnosis)["where"]

    place = where["place"]
    assert (place["position"], place["interval"], place["explained"], place["enough"]) == (
        1.0,
        [0.99, 1.01],
        0.93,
        True,
    )
    assert place["sleeve"] == "sleeve 2"
    assert where["shape"] == ["it follows the displacement (83%)"]
    assert len(where["profile"]["position"]) == len(where["profile"]["explained"]) == 14
    assert where["channels"][0] == {"sensor": "P1", "explained": 0.1}


def test_the_report_shows_words_profile_and_shape(diagnosis, tmp_path):
    rig = read_rig(RIG)

    page = write_report(diagnosis, rig, tmp_path, provenance(RIG, [], 0, "testbed diagnose")).read_text()

    assert WORDS[1:] in page
    assert "<li>it follows the displacement (83%)</li>" in page
    assert f"Place of the missing force: {WORDS}" in page


def test_the_caption_speaks_of_no_force_where_none_is_drawn(diagnosis):
    drawn, bare = (
        place_picture(replace(diagnosis, located=replace(made_up_place(), shape=shape)), read_rig(RIG))
        for shape in (made_up_place().shape, None)
    )
    assert "Below: the force" in drawn.caption
    assert "its course in the record where it is largest" in drawn.caption
    assert bare.caption.startswith("How much of the misfit")
    assert "Below" not in bare.caption


def pictures_of(diagnosis, folder):
    """The pictures of the page, in order, and which of them stand before its sections."""
    page = write_report(diagnosis, read_rig(RIG), folder, provenance(RIG, [], 0, "testbed diagnose")).read_text()
    above, below = page.split("<main>")
    return [re.findall('<img [^>]*alt="([^"]*)"', part) for part in (above, below)]


def test_the_picture_that_shows_the_verdict_stands_under_it_and_nowhere_else(diagnosis, tmp_path):
    above, below = pictures_of(diagnosis, tmp_path)
    assert above[1:] == [f"Place of the missing force: {WORDS}"]
    assert not set(above) & set(below)

    above, below = pictures_of(replace(diagnosis, located=None), tmp_path)
    assert above[1:] == ["Missing force at sleeve 2"]
    assert not set(above) & set(below)


def test_of_a_complete_model_the_error_and_what_is_left_are_the_pictures(diagnosis, tmp_path):
    nothing = replace(
        diagnosis, verdict="complete", added=(), candidates=(), indistinguishable=(), stages=diagnosis.stages[:2]
    )
    above, below = pictures_of(nothing, tmp_path)
    assert [text.split(":")[0] for text in above] == ["Error by model", "What the models leave of P1 in sweep.csv"]
    assert f"Place of the missing force: {WORDS}" in below


def test_without_a_place_neither_speaks_of_one(tmp_path):
    rig = read_rig(RIG)
    bare = made_up_diagnosis(rig)

    assert "place" not in diagnosis_json(bare)["where"]
    assert (
        "Place of the missing force"
        not in write_report(bare, rig, tmp_path, provenance(RIG, [], 0, "testbed diagnose")).read_text()
    )


def test_a_place_elsewhere_than_the_effect_is_no_evidence_for_it(diagnosis, tmp_path):
    elsewhere = replace(diagnosis, located=replace(made_up_place(), place=0.5, interval=(0.48, 0.52), sleeve=None))

    above, below = pictures_of(elsewhere, tmp_path)

    assert above[1].startswith("What the models leave of P1")
    assert f"Place of the missing force: {WORDS}" in below


def test_a_record_kept_aside_alone_that_is_unexplained_is_no_force_that_is_placed(diagnosis):
    """The calibrated model meets what it was fitted to: what its channels lack is noise."""
    met = replace(diagnosis.stages[1], score=diagnosis.stages[2].score)
    found = replace(diagnosis, verdict="unexplained", added=(), stages=(diagnosis.stages[0], met), times_noise=1.02)
    missed = replace(found, not_predicted=("on loud, kept aside, the model leaves 9 times the noise",))

    assert "the calibrated model meets what it was fitted to" in headline(missed)
    assert headline(found).startswith("Something is missing, and no effect of the library is sure to be it")
    assert second_line(missed).endswith("On loud, kept aside, the model leaves 9 times the noise.")
    assert "N rms" not in second_line(missed)
    assert "N rms" in second_line(found)


@pytest.mark.parametrize(("times", "told"), [(1.02, False), (0.95, False), (0.8, True)])
def test_a_model_below_the_noise_says_that_it_was_estimated_too_high(diagnosis, times, told):
    low = replace(diagnosis, times_noise=times)

    words = (
        "The model leaves 0.80 times the noise line by line: the sensors' or the force's noise was estimated too high"
    )
    assert second_line(low).startswith(words) == told
    assert ("estimated too high" in second_line(low)) == told


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, "It acts at sleeve 2, 0.516 N rms in sweep.csv and largest there at 1.57 s."),
        ({"sleeve": None}, "It acts at 1 m, 0.516 N rms"),
        ({"enough": False}, f"Where along the beam: {WORDS}."),
        ({"place": None, "sensor": "P4", "forces": ()}, "What is left lies in channel P4."),
    ],
)
def test_what_is_unexplained_is_placed_by_the_profile_and_in_time(diagnosis, changes, words):
    located = replace(made_up_place(), **changes)
    found = replace(diagnosis, verdict="unexplained", added=(), stages=diagnosis.stages[:2], located=located)

    assert words in second_line(found)
