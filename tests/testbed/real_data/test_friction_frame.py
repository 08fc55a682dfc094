"""One weight of the published frame; the whole study, some minutes long, is in test_real_studies.py."""

import json
import os
from pathlib import Path

import pytest

from testbed.real_data import friction_frame
from testbed.real_data.friction_frame import FrictionFrame, read_halves, weight_result
from testbed.real_data.page import frame_json, frame_page

PUBLISHED = Path(__file__).parents[3] / "results" / "friction_frame" / "friction_frame.json"
FOLDER = Path(os.environ.get("TESTBED_DATA", "nowhere"), "friction_frame")
WEIGHT = 450
"""G."""


def assert_friction_does_what_no_linear_frame_does(weights):
    """On the halves kept aside, which no number was learnt from, at every weight; errors in mm."""
    for weight in weights:
        (first, *_), errors = weight["diagnosis"]["effects"], weight["errors_mm"]
        assert first["against"] == "ground"
        assert errors["updated"] <= 0.14
        assert min(errors["as given"], errors["calibrated"], errors["linear, loose"]) > 3.0 * errors["updated"]


@pytest.mark.real_data
@pytest.mark.slow
@pytest.mark.skipif(
    not (FOLDER / f"s_b_{WEIGHT}g_x.mat").is_file(), reason="TESTBED_DATA holds no friction_frame/s_b_450g_x.mat"
)
def test_it_rubs_and_the_page_says_so(monkeypatch):
    monkeypatch.setattr(friction_frame, "MOST_ADDED", 1)
    row = weight_result(read_halves(FOLDER, WEIGHT), 0)
    study = FrictionFrame([row], row.force, row.std, row.beside, {WEIGHT: {WEIGHT: row.loose[1]}})
    (weight,) = frame_json(study)["weights"]
    published = json.loads(PUBLISHED.read_text())["weights"][-1]
    assert_friction_does_what_no_linear_frame_does([weight])
    assert row.diagnosis.added[0].effect.kind == friction_frame.FRICTION
    assert row.force == pytest.approx(published["friction_force"]["value"], abs=3.0 * row.std)
    named, *_, refused = study.bars  # those between ask for several weights
    assert named.met
    assert refused.met
    page = frame_page(study, "testbed study friction-frame")
    assert f"| {WEIGHT} g | {row.force:.3f} +- {row.std:.3f} |" in page
