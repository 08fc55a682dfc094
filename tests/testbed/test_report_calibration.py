"""The report tells beside the calibrated numbers what one set of them does not explain, and tells it once."""

from dataclasses import replace

import pytest
from made_up_diagnosis import made_up_diagnosis

from identification.consistency.finding import CalibrationFinding
from models.rig_file import read_rig
from testbed.loop import diagnosis_json
from testbed.report import Provenance, write_report

MADE = Provenance("testbed diagnose", "2025-01-01T00:00:00+00:00", 7, (), ())
HEAD = "What one set of numbers does not explain"
DRIFT = CalibrationFinding(
    "records", "youngs_modulus", ("at 3 N", "at 10 N"), (2.1e11, 2.2e11), (1e9, 1e9), "Pa", 9.0, "it grows with <level>"
)


@pytest.fixture(scope="module")
def rig():
    whole = read_rig("tests/data/reference_rig.toml")
    return whole.model_copy(update={"sensors": whole.sensors[:1]})


def test_a_contradiction_stands_once_and_under_its_own_head(rig, tmp_path):
    found = replace(made_up_diagnosis(rig), calibration=(DRIFT,))

    assert DRIFT.told in diagnosis_json(found)["where"]["findings"]
    page = write_report(found, rig, tmp_path, MADE).read_text(encoding="utf-8")

    assert page.count("it grows with &lt;level&gt;") == 1
    assert page.index(HEAD) < page.index("it grows with &lt;level&gt;") < page.index("What was noticed in the records")
    assert "P4: dead" in page


def test_without_contradictions_there_is_no_head(rig, tmp_path):
    assert HEAD not in write_report(made_up_diagnosis(rig), rig, tmp_path, MADE).read_text(encoding="utf-8")
