"""Every finding of every file, not only the first."""

import re

import pytest
from cli_files import RIG_TOML, make_files

from models.errors import InputError
from models.rig_file import read_rig
from testbed.check import check_files
from testbed.inputs import read_inputs
from testbed.records.read import read_record
from testbed.records.write import write_record


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
    rig, record = check_files(folder / "rig.toml", [folder / "sweep.csv"]).findings
    assert (rig.severity, rig.text) == ("fine", "beam; 2 sleeves, 3 sensors, 0 effects")
    assert (record.severity, record.text) == ("fine", "3 sensors, 1 s at 512 Hz, from rest")


@pytest.mark.parametrize(
    ("key", "value", "doubt"),
    [
        ("length = 1.2", "length = 1200.0", "all lengths are in m: if length is in mm, write length = 1.2"),
        ("diameter = 0.02", "diameter = 20.0", "all lengths are in m: if diameter is in mm, write diameter = 0.02"),
        ("youngs_modulus = 210e9", "youngs_modulus = 210e3", "if youngs_modulus is in MPa, write 2.1e+11"),
        ("youngs_modulus = 210e9", "youngs_modulus = 210.0", "if youngs_modulus is in GPa, write 2.1e+11"),
        ("density = 7850.0", "density = 7.85e6", "correct the one that is not in this unit"),
        ("clearance = 3e-4", "clearance = 0.3", "if it is in mm, write clearance = 0.0003"),
        ("rayleigh_damping = [4.0, 2e-5]", "rayleigh_damping = [2e-5, 4.0]", "and eta2 the second, in s?"),
    ],
)
def test_numbers_in_another_unit_are_doubted(folder, key, value, doubt):
    path = folder / "units.toml"
    path.write_text(RIG_TOML.replace(key, value))

    (found,) = check_files(path, []).findings

    assert (found.severity, found.text.endswith(doubt)) == ("finding", True)


def scaled(text, *keys, factor=1000.0):
    """The rig with some lengths in another unit than m."""
    return re.sub(rf"\b({'|'.join(keys)}) = (\S+)", lambda m: f"{m[1]} = {factor * float(m[2]):g}", text)


def test_lengths_in_mm_beside_positions_in_m_are_told_with_the_numbers_to_write(folder):
    path = folder / "mm.toml"
    path.write_text(scaled(RIG_TOML, "length", "diameter"))
    (found,) = check_files(path, []).findings
    assert found.text == (
        "length = 1200 m and diameter = 20 m; a beam on a bench is no longer than 50 m, and all sleeves, sensors and "
        "forces of this one lie within 1.2 m from the clamp, 0.10% of its length; all lengths are in m: if length and "
        "diameter are in mm, write length = 1.2 and diameter = 0.02"
    )


def test_a_short_beam_in_mm_is_told_by_where_its_parts_are(folder):
    path = folder / "short.toml"
    short = scaled(RIG_TOML, "length", "position", factor=0.03)
    path.write_text(scaled(short, "length", "diameter"))
    (found,) = check_files(path, []).findings
    assert found.text.startswith(
        "length = 36 m and diameter = 20 m; a beam is 5 to 1000 times as long as thick, and all"
    )
    path.write_text(scaled(RIG_TOML, "length", "diameter", factor=100.0))
    (found,) = check_files(path, []).findings
    assert found.text.endswith("if length and diameter are in cm, write length = 1.2 and diameter = 0.02")


def test_a_rig_all_in_mm_is_to_be_written_in_m_throughout(folder):
    path = folder / "all_mm.toml"
    path.write_text(scaled(RIG_TOML, "length", "diameter", "position", "clearance"))
    (found,) = check_files(path, []).findings
    assert found.text.endswith("write length = 1.2 and diameter = 0.02, and each position in m too")


def test_a_record_that_an_odd_rig_refuses_names_the_rig_too(folder):
    path = folder / "soft.toml"
    path.write_text(RIG_TOML.replace("youngs_modulus = 210e9", "youngs_modulus = 210"))
    with pytest.raises(InputError, match=r"sweep.csv: .* one period of the first mode, .*; see soft.toml: length"):
        read_inputs(path, [folder / "sweep.csv"])


def test_a_run_carries_what_is_odd_about_its_rig(folder):
    path = folder / "wide.toml"
    path.write_text(RIG_TOML.replace("clearance = 3e-4", "clearance = 0.02"))
    (first, *_) = read_inputs(path, [folder / "sweep.csv"]).findings
    assert first.startswith("wide.toml: ")
    assert first.endswith("if it is in mm, write clearance = 2e-05")


def test_a_file_is_named_once_in_a_line(folder):
    (folder / "empty.csv").write_text("")
    records = [folder / "empty.csv", folder / "nowhere.csv", folder]
    lines = [f.line for f in check_files(folder / "rig.toml", records).findings if f.severity == "error"]
    assert [line.count(str(path)) for line, path in zip(lines, records, strict=True)] == [1, 1, 1]
    (line, *_) = (f.line for f in check_files(folder / "nowhere.toml", []).findings)
    assert line == f"error: {folder / 'nowhere.toml'}: does not exist; a rig is a TOML file; correct the path"


def test_all_effects_that_do_not_fit_are_told(folder):
    path = folder / "effects.toml"
    path.write_text(
        RIG_TOML + '[[effects]]\nkind = "squeeze_film"\nsleeve = "sleeve 9"\ndamping = 1.0\n'
        '[[effects]]\nkind = "greese"\n'
    )  # fmt: skip
    errors = [finding.text for finding in check_files(path, []).findings]
    assert len(errors) >= 1
    assert "sleeve 9" in errors[0]


def test_a_rig_that_cannot_be_read_does_not_hide_the_records(folder):
    path = folder / "broken.toml"
    path.write_text("[structure")
    (folder / "bad.csv").write_text("")
    found = check_files(path, [folder / "bad.csv", folder / "sweep.csv", folder / "missing.csv"]).findings
    assert [finding.severity for finding in found] == ["error", "error", "finding", "error"]


def test_a_record_that_is_refused_for_its_channels_shows_their_levels(folder):
    dead = silenced(folder, "P1")
    levels = check_files(folder / "rig.toml", [dead, folder / "missing.csv"]).levels
    assert [(level.record, level.channel, level.rms > 0.0) for level in levels] == [
        (dead.name, name, name != "P1") for name in ("shaker", "P1", "P2", "P3")
    ]


def test_dead_channels_are_errors_with_the_way_out(folder):
    found = check_files(folder / "rig.toml", [silenced(folder, "P1", "P3")]).findings
    errors = [finding.text for finding in found if finding.severity == "error"]
    assert len(errors) == 1
    assert "channel P1 is dead" in errors[0]
    assert "channel P3 is dead" in errors[0]
    assert "--without P1 --without P3" in errors[0]


def test_a_dead_force_under_a_motion_that_does_not_die_away_is_told(folder):
    found = check_files(folder / "rig.toml", [silenced(folder, "shaker")]).findings
    assert [finding.severity for finding in found] == ["fine", "error", "finding"]
    assert "the excitation shaker is dead" in found[1].text
    assert "the motion does not die away" in found[2].text


def test_a_channel_left_out_is_no_error(folder):
    found = check_files(folder / "rig.toml", [silenced(folder, "P2")], ["P2"]).findings
    assert [finding.severity for finding in found] == ["fine", "fine"]


def test_two_records_of_one_name_are_told(folder):
    path = folder / "sweep.csv"
    assert sum(f.severity == "error" for f in check_files(folder / "rig.toml", [path, path]).findings) == 2


def test_a_sensitivity_of_another_quantity_is_an_error_and_stops_the_others(folder):
    path = folder / "newtons.toml"
    path.write_text(RIG_TOML.replace('name = "P2"', 'name = "P2"\nsensitivity = "100 mV/N"'))
    rig, _ = check_files(path, [folder / "sweep.csv"]).findings
    assert (rig.severity, rig.text[:52]) == ("error", 'newtons.toml: P2: sensitivity = "100 mV/N"; P2 measu')
    with pytest.raises(InputError, match=r"newtons.toml: P2: sensitivity"):
        read_inputs(path, [folder / "sweep.csv"])


def test_a_time_in_ms_that_is_read_as_s_is_an_error(folder):
    _, names, *rows = (folder / "sweep.csv").read_text().splitlines()
    cells = [row.split(",") for row in rows]
    text = [",".join([repr(1e3 * float(time)), *samples]) for time, *samples in cells]
    (folder / "slow.csv").write_text("\n".join([names, *text]) + "\n")
    _, record = check_files(folder / "rig.toml", [folder / "slow.csv"]).findings
    assert record.severity == "error"
    assert "at 0.512 Hz, 1000 s; a record holds frequencies up to half its rate" in record.text
    assert "if its time column is in ms" in record.text


def renamed(folder, old, file, of="burst.csv"):
    """A copy of a record in which one channel is another sensor's, that the rig does not have."""
    path = folder / file
    path.write_text((folder / of).read_text().replace(f"{old} [", f"Q{old[1]} ["))
    return path


def test_records_of_different_channels_are_refused_with_one_way_out_that_leads_out(folder):
    files = [renamed(folder, "P1", "no1.csv"), renamed(folder, "P3", "no3.csv", of="sweep.csv")]
    with pytest.raises(InputError) as caught:
        read_inputs(folder / "rig.toml", files)
    assert "no1.csv: no channel for P1; no3.csv: no channel for P3; a comparison" in str(caught.value)
    assert str(caught.value).endswith("leave out with --without P1 --without P3")
    read = read_inputs(folder / "rig.toml", files, without=["P1", "P3"])
    assert [record.sensors for record in read.records] == [("P2",), ("P2",)]


def test_records_without_a_channel_in_common_are_to_be_taken_one_at_a_time(folder):
    files = [renamed(folder, f"P{i}", f"without{i}.csv") for i in (1, 2, 3)]
    with pytest.raises(InputError, match=r"mend the records, or take each by itself, with a --without for each"):
        read_inputs(folder / "rig.toml", files)


def test_a_record_kept_aside_is_compared_by_its_samples(folder):
    rig, burst = folder / "rig.toml", folder / "burst.csv"
    (folder / "commented.csv").write_text(f"# another byte\n{burst.read_text()}")
    write_record(read_record(burst, read_rig(rig)), read_rig(rig), folder / "again.h5")
    for name in ("commented.csv", "again.h5"):
        with pytest.raises(InputError, match=rf"--holdout {name}: the same samples as burst.csv; a record kept aside"):
            read_inputs(rig, [folder / "sweep.csv", burst], [folder / name], strict=False)
    read_inputs(rig, [burst], [folder / "sweep.csv"], strict=False)


def test_a_record_that_is_given_twice_is_refused(folder):
    rig, burst = folder / "rig.toml", folder / "burst.csv"
    (folder / "twice.csv").write_text(f"# the same\n{burst.read_text()}")
    with pytest.raises(InputError, match=r"twice.csv: the same samples as burst.csv; every record is another test"):
        read_inputs(rig, [burst, folder / "sweep.csv", folder / "twice.csv"], strict=False)
    parts = [renamed(folder, name, f"part of it without {name}.csv") for name in ("P1", "P3")]
    assert len(read_inputs(rig, parts, strict=False).records) == 2  # each holds what the other lacks


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (RIG_TOML.replace("position = 0.5", "position = 1.0"), "sleeve 1 and sleeve 2 are both at 1 m; sleeves at one"),
        (RIG_TOML.split("[[sensors]]")[0], "no sensors; compare, diagnose and simulate need the places"),
    ],
)
def test_a_rig_of_which_no_record_tells_a_part_is_odd(folder, text, told):
    path = folder / "untold.toml"
    path.write_text(text)

    (found,) = check_files(path, []).findings

    assert (found.severity, found.text.startswith(told)) == ("finding", True)
