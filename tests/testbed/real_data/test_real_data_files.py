"""What the studies say where a published file is missing or is another one, and what their smaller parts compute."""

from math import exp
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.io import savemat

from models.errors import InputError
from testbed.cli.app import main
from testbed.real_data.bars import Bar, bars_table
from testbed.real_data.bolted_beam import read_levels, rig_of
from testbed.real_data.files import read_variables
from testbed.real_data.friction_frame import FrictionFrame, predicted_force, read_halves, sigmas_of

STUDIES = ("silverbox", "friction-frame", "bolted-beam")


@pytest.mark.parametrize("study", STUDIES)
def test_a_missing_file_is_told_in_three_parts(study, tmp_path, capsys):
    assert main(["study", study, str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "no such file" in said
    assert "get it from" in said
    assert not (tmp_path / "out" / "README.md").exists()


@pytest.mark.parametrize("study", STUDIES)
def test_a_missing_folder_is_told_in_three_parts(study, tmp_path, capsys):
    assert main(["study", study, str(tmp_path / "nowhere"), "--out", str(tmp_path / "out")]) == 2
    assert "no such folder" in capsys.readouterr().err


def test_another_file_of_the_name_is_refused(tmp_path):
    (tmp_path / "text.mat").write_text("this is no MATLAB file, however long it may go on and on " * 10)
    with pytest.raises(InputError, match="cannot be read"):
        read_variables(tmp_path / "text.mat", ("V1",), "its authors")
    savemat(tmp_path / "other.mat", {"V3": np.zeros(3)})
    with pytest.raises(InputError, match="no variable V1"):
        read_variables(tmp_path / "other.mat", ("V1",), "its authors")


def test_levels_of_another_shape_are_refused(tmp_path):
    savemat(tmp_path / "ForcedFrequencyResponses.mat", {"FRdata": {"ForceControl": {"frequency": 1.0}}})
    with pytest.raises(InputError, match="not as published"):
        read_levels(tmp_path)


def made_up_levels(folder, mass=2.0, freq=80.0, damping=3.0):
    omega = 2.0 * np.pi * np.linspace(79.0, 81.0, 21)
    force = np.full(21, 0.2)
    motion = force / (mass * (2.0 * np.pi * freq) ** 2 - mass * omega**2 + 1j * omega * damping)
    level = {
        "frequency": omega / (2.0 * np.pi),
        "force": force,
        "amplitude": omega**2 * np.abs(motion),
        "phase": np.angle(motion),
    }
    rows = np.empty(2, object)
    rows[:] = [level, level]
    savemat(folder / "ForcedFrequencyResponses.mat", {"FRdata": {"ForceControl": rows}})


def test_the_lowest_level_gives_the_mode(tmp_path):
    made_up_levels(tmp_path)
    levels = read_levels(tmp_path)
    assert [level.name for level in levels] == ["level 1", "level 2"]
    mode = rig_of(levels[0]).structure
    assert mode.mass == pytest.approx(2.0, rel=1e-6)  # rounding of a difference of large numbers
    assert mode.stiffness == pytest.approx(2.0 * (2.0 * np.pi * 80.0) ** 2, rel=1e-6)
    assert mode.damping == pytest.approx(3.0, rel=1e-6)


def test_a_frames_test_is_halved_in_metres(tmp_path):
    t = np.arange(100) * 0.004
    for axis in "xy":
        savemat(tmp_path / f"s_b_250g_{axis}.mat", {axis: np.sin(t), "t": t})
    halves = read_halves(tmp_path, 250)
    assert halves.first.fs == pytest.approx(250.0)
    assert (halves.first.n_samples, halves.second.n_samples) == (50, 50)
    np.testing.assert_allclose(halves.second.responses[0], 1e-3 * np.sin(t[50:]))


def test_a_line_through_two_forces_carries_their_standard_deviations():
    force, std = predicted_force([(250, 0.6, 0.03), (350, 1.0, 0.02)], 450)
    assert force == pytest.approx(1.4)
    assert std == pytest.approx(np.hypot(0.03, 2.0 * 0.02))
    assert predicted_force([(250, 0.6, 0.03), (350, 1.0, 0.02)], 350) == pytest.approx((1.0, 0.02))


def test_a_stiffness_is_counted_in_its_tolerance():
    assert sigmas_of(1191.0 * np.exp(0.02)) == pytest.approx(1.0)
    assert sigmas_of(80.0) > 100.0


def test_a_bar_is_kept_or_not():
    bars = [Bar("error", 0.4, 0.5, "mV"), Bar("error", 0.6, 0.5, "mV"), Bar("named", "a", "a"), Bar("named", "b", "a")]
    assert [bar.met for bar in bars] == [True, False, True, False]
    assert "**no**" in list(bars_table(bars))[3]
    assert bars[1].json()["met"] is False


def test_the_absurd_linear_fit_is_refused_with_reasons_made_of_its_numbers():
    loose = ((250, 1191.0 * exp(-2.0), 0.30, 0.10), (350, 1191.0 * exp(-3.0), 0.60, 0.05))
    free = SimpleNamespace(verdict="unexplained")
    rows = [SimpleNamespace(weight=w, loose=(k, error), updated=best, unheld=free) for w, k, error, best in loose]
    stiffness, weights, aside, verdicts = FrictionFrame(rows, {}).reasons
    assert "100 to 150 standard deviations off the authors' 1191 N/m" in stiffness  # 2 and 3 over the 2 % of tolerance
    assert "161, 59 N/m" in weights
    assert "3.0 to 12.0 times" in aside
    assert "`unexplained` at 250 g, `unexplained` at 350 g" in verdicts
