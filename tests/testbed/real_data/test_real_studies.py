"""The three studies on the published files, which lie in the folder that TESTBED_DATA names."""

import json
import os
from pathlib import Path

import pytest

from testbed.cli.app import main
from tests.testbed.real_data.test_friction_frame import assert_friction_does_what_no_linear_frame_does

pytestmark = [pytest.mark.real_data, pytest.mark.slow, pytest.mark.study]

STUDIES = (
    ("silverbox", "silverbox", "SNLS80mV.mat"),
    ("friction-frame", "friction_frame", "s_b_450g_x.mat"),
    ("bolted-beam", "brake_reuss_beam", "ForcedFrequencyResponses.mat"),
)


@pytest.mark.parametrize(("study", "folder", "file"), STUDIES, ids=[row[0] for row in STUDIES])
def test_every_bar_is_kept(study, folder, file, tmp_path):
    data = Path(os.environ.get("TESTBED_DATA", "nowhere"), folder)
    if not (data / file).is_file():
        pytest.skip(f"TESTBED_DATA holds no {folder}/{file}")
    assert main(["study", study, str(data), "--out", str(tmp_path)]) == 0
    (written,) = tmp_path.glob("*.json")
    content = json.loads(written.read_text())
    assert content["reached"]
    assert all(bar["met"] for bar in content["bars"])
    assert (tmp_path / "README.md").is_file()
    assert list((tmp_path / "figures").glob("*.png"))
    if study == "friction-frame":
        assert_friction_does_what_no_linear_frame_does(content["weights"])
