"""Every finding of every file, not only the first."""

import pytest
from cli_files import RIG_TOML, make_files

from models.errors import InputError
from testbed.check import check_files
from testbed.inputs import read_inputs


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return make_files(tmp_path_factory.mktemp("check"))


def silenced(folder, *names):
    """A copy of the sweep in which some channels are 0."""
    lines = (folder / "sweep.csv").read_text().splitlines()
    head = next(i for i, line in enumerate(lines) if line.startswith("time"))
    columns = [i for i, label in enumerate(lines[head].split(",")) if label.split(" ")[0] in names]
    for number in range(head + 1, len(lines)):
        cells = lines[number].split(",")
        for column in columns:
            cells[column] = "0"
        lines[number] = ",".join(cells)
    path = folder / f"dead-{'-'.join(names)}.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def test_fine_files_say_what_they_hold(folder):
    rig, record = check_files(folder / "rig.toml", [folder / "sweep.csv"])
    assert (rig.severity, rig.text) == ("fine", "beam; 2 sleeves, 3 sensors, 0 effects")
    assert (record.severity, record.text) == ("fine", "3 sensors, 1 s at 512 Hz, from rest")


@pytest.mark.parametrize(
    ("key", "value", "doubt"),
    [
        ("length = 1.2", "length = 1200.0", "are both in m?"),
        ("diameter = 0.02", "diameter = 20.0", "are both in m?"),
        ("youngs_modulus = 210e9", "youngs_modulus = 210e3", "in SI units?"),
        ("clearance = 3e-4", "clearance = 0.3", "is it in m?"),
        ("rayleigh_damping = [4.0, 2e-5]", "rayleigh_damping = [2e-5, 4.0]", "and eta2 the second, in s?"),
    ],
)
def test_numbers_in_another_unit_are_doubted(folder, key, value, doubt):
    path = folder / "units.toml"
    path.write_text(RIG_TOML.replace(key, value))

    (found,) = check_files(path, [])

    assert (found.severity, found.text.endswith(doubt)) == ("finding", True)


def test_a_record_that_an_odd_rig_refuses_names_the_rig_too(folder):
    path = folder / "soft.toml"
    path.write_text(RIG_TOML.replace("youngs_modulus = 210e9", "youngs_modulus = 210"))
    with pytest.raises(InputError, match=r"sweep.csv: .* one period of the first mode, .*; or see soft.toml: the beam"):
        read_inputs(path, [folder / "sweep.csv"])


def test_a_run_carries_what_is_odd_about_its_rig(folder):
    path = folder / "wide.toml"
    path.write_text(RIG_TOML.replace("clearance = 3e-4", "clearance = 0.02"))
    (first, *_) = read_inputs(path, [folder / "sweep.csv"]).findings
    assert first.startswith("wide.toml: ")
    assert first.endswith("is it in m?")


def test_a_file_is_named_once_in_a_line(folder):
    (folder / "empty.csv").write_text("")
    (line,) = (f.line for f in check_files(folder / "rig.toml", [folder / "empty.csv"]) if f.severity == "error")
    assert line.count("empty.csv") == 1


def test_all_effects_that_do_not_fit_are_told(folder):
    path = folder / "effects.toml"
    path.write_text(
        RIG_TOML + '[[effects]]\nkind = "squeeze_film"\nsleeve = "sleeve 9"\ndamping = 1.0\n'
        '[[effects]]\nkind = "greese"\n'
    )  # fmt: skip
    errors = [finding.text for finding in check_files(path, [])]
    assert len(errors) >= 1
    assert "sleeve 9" in errors[0]


def test_a_rig_that_cannot_be_read_does_not_hide_the_records(folder):
    path = folder / "broken.toml"
    path.write_text("[structure")
    (folder / "bad.csv").write_text("")
    found = check_files(path, [folder / "bad.csv", folder / "sweep.csv", folder / "missing.csv"])
    assert [finding.severity for finding in found] == ["error", "error", "finding", "error"]


def test_dead_channels_are_errors_with_the_way_out(folder):
    found = check_files(folder / "rig.toml", [silenced(folder, "P1", "P3")])
    errors = [finding.text for finding in found if finding.severity == "error"]
    assert len(errors) == 1
    assert "channel P1 is dead" in errors[0]
    assert "channel P3 is dead" in errors[0]
    assert "--without P1 --without P3" in errors[0]


def test_a_channel_left_out_is_no_error(folder):
    found = check_files(folder / "rig.toml", [silenced(folder, "P2")], ["P2"])
    assert [finding.severity for finding in found] == ["fine", "fine"]


def test_two_records_of_one_name_are_told(folder):
    path = folder / "sweep.csv"
    assert sum(f.severity == "error" for f in check_files(folder / "rig.toml", [path, path])) == 2
