import tomllib
from pathlib import Path

import numpy as np
import pytest

from models.rig_file import read_rig
from testbed.demo import make
from testbed.records.read import read_record

HERE = Path(make.__file__).parent
SHIPPED = sorted((HERE / "records").glob("*.uff"))
MOST_BYTES = 6_000_000


def test_two_records_and_one_held_out_ship_in_a_few_megabytes():
    assert len(SHIPPED) == 3
    assert sum("holdout" in path.stem for path in SHIPPED) == 1
    assert sum(path.stat().st_size for path in HERE.rglob("*") if path.suffix in {".uff", ".toml"}) < MOST_BYTES


def test_the_rig_of_the_demo_is_the_reference_rig():
    assert read_rig(HERE / "rig.toml") == read_rig(Path(__file__).parents[2] / "data/reference_rig.toml")


def test_no_shipped_record_or_rig_tells_the_truth():
    secret = tomllib.loads((HERE / "truth.toml").read_text())["effects"][0]["kind"].encode()
    assert all(secret not in path.read_bytes() for path in SHIPPED)
    assert read_rig(HERE / "rig.toml").effects == ()


def test_the_truth_lies_within_two_deviations_of_the_rig_file():
    truth = tomllib.loads((HERE / "truth.toml").read_text())["parameters"]
    for parameter in read_rig(HERE / "rig.toml").parameters():
        assert 0.0 < abs(truth[parameter.path] - parameter.value) <= 2.001 * parameter.std  # eight digits are written


@pytest.mark.slow
def test_the_shipped_files_are_what_the_command_makes(tmp_path):
    make.make(tmp_path)
    assert tomllib.loads((tmp_path / "truth.toml").read_text()) == tomllib.loads((HERE / "truth.toml").read_text())
    rig = read_rig(HERE / "rig.toml")
    for path in SHIPPED:
        shipped, made = read_record(path, rig), read_record(tmp_path / "records" / path.name, rig)
        # Another machine rounds otherwise, and impacts let that grow; the noise is 50 times as large.
        np.testing.assert_allclose(made.excitation, shipped.excitation, rtol=0, atol=1e-9)
        assert np.linalg.norm(made.responses - shipped.responses) < 1e-4 * np.linalg.norm(shipped.responses)
