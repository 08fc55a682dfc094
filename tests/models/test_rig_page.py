"""The rig that ``docs/rig.md`` shows is one, with every key of its tables that a beam's rig needs."""

import re
from pathlib import Path

from models.rig_file import read_rig

PAGE = (Path(__file__).parents[2] / "docs" / "rig.md").read_text(encoding="utf-8")


def test_the_minimal_rig_is_read(tmp_path):
    (text,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    (tmp_path / "rig.toml").write_text(text)
    rig = read_rig(tmp_path / "rig.toml")
    assert [sleeve.name for sleeve in rig.sleeves] == ["sleeve 1"]
    assert [sensor.sensitivity for sensor in rig.sensors] == ["100 mV/g"]
    assert {parameter.path for parameter in rig.parameters()} == {"youngs_modulus", "sleeves[0].clearance"}
    assert len(text.splitlines()) < 35
