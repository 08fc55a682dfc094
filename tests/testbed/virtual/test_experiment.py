"""An experiment's file is read whole, and every mistake in it is told in three parts."""

from pathlib import Path

import pytest

from models.errors import InputError
from testbed.virtual.experiment import EXCITATIONS, Multisine, Truth, read_experiment

DOCS = Path(__file__).parents[3] / "docs"


def written(tmp_path, text):
    path = tmp_path / "test.toml"
    path.write_text(text)
    return path


def test_the_example_of_the_docs_is_read():
    found = read_experiment(DOCS / "experiment.toml")
    assert isinstance(found.excitation, Multisine)
    assert found.excitation.rms == (10.0, 3.0)
    assert found.sensors["all"].preset == "PCB 352C66"
    assert found.truth.effects[0].kind == "squeeze_film"


def test_the_first_day_of_the_docs_is_what_its_experiments_hold():
    page = (DOCS / "first_test.md").read_text()
    assert "six periods at a low and at a high level" in page
    multisines = read_experiment(DOCS / "experiment.toml").excitation
    assert (multisines.periods, len(multisines.rms)) == (6, 2)
    others = [read_experiment(DOCS / name) for name in ("decay.toml", "sweep.toml")]
    assert [other.excitation.kind for other in others] == ["hammer", "sweep"]
    assert all(other.truth == Truth() for other in others)


def test_every_kind_and_key_stands_in_the_docs():
    page = (DOCS / "experiments.md").read_text()
    for kind, part in EXCITATIONS.items():
        (row,) = [line for line in page.splitlines() if line.startswith(f"| `{kind}` |")]
        common = ("kind", "angle") if kind == "release" else ("kind", "angle", "position")
        named = [key for key in part.model_fields if key not in common]
        assert all(f"`{key}`" in row or f"{key} of each" in row for key in named), kind
        assert ("angle" in part.model_fields) == (kind != "release")
        assert ("position" in part.model_fields) == (kind != "roving_hammer")
    assert "`angle`" in page
    assert "`position`" in page


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("fs = 2048.0", r"test.toml: excitation is missing; it has no default; add excitation"),
        ('[excitation]\nkind = "multisin"', r"kind = multisin; a kind is one of multisine, sweep, .*; choose one"),
        (
            '[excitation]\nkind = "sweep"\nlo = 3.0',
            r"excitation.lo is unknown; the keys here are angle, position, kind, low, .*; did you mean low\?",
        ),
        ('[excitation]\nkind = "sweep"\nlow = -3.0', r"excitation.low = -3.0; it should be greater than 0; docs/"),
        (
            '[excitation]\nkind = "sweep"\n[sensors.P1]\npreste = "x"',
            r"sensors.P1.preste is unknown; .*; did you mean preset\?",
        ),
        ('[excitation]\nkind = "release"', r"excitation.position is missing; it has no default; add position"),
        (
            '[excitation]\nkind = "multisine"\nrms = [1.0, -4.0]',
            r"test.toml: excitation.rms.1 = -4.0; it should be greater than 0; docs/",
        ),
        (
            'fs = 2048.0\n[excitation]\nkind = "sweep"\nhigh = 3000.0',
            r"test.toml: excitation.high = 3000 Hz at fs = 2048 Hz; .* up to 1024 Hz; lower high, or raise fs",
        ),
        (
            '[excitation]\nkind = "sweep"\nlow = 40.0\nhigh = 30.0',
            r"test.toml: excitation.low = 40 Hz, high = 30 Hz; a band begins below its end; give low below high",
        ),
        (
            '[excitation]\nkind = "multisine"\nrms = []',
            r"test.toml: excitation.rms = \[\]; tuple should have at least 1 item",
        ),
        ('fs = 256.0\n[excitation]\nkind = "sweep"', r"excitation.high = 300 Hz at .*; set a lower high, or raise fs"),
        ("fs = = 3", r"test.toml: .*; an experiment is valid TOML; correct that line; decimals take a point, texts"),
        ("fs = [", r"test.toml: .*; an experiment is valid TOML; see what was opened last and not closed: a bracket"),
        (
            '[exitation]\nkind = "sweep"',
            r"test.toml: exitation is unknown; the keys here .*; did you mean excitation\?",
        ),
        (
            '[excitation]\nkind = "sweep"\n[[effects]]\nkind = "wear"',
            r"effects is unknown; the keys here are .*; head each one with \[\[truth.effects\]\], in double brackets",
        ),
        ('excitation = "sweep"', r"test.toml: excitation = 'sweep'; the excitation is one table; head it with \[excit"),
        ('[[excitation]]\nkind = "sweep"', r"excitation = \[{...}\]; .*; head it with \[excitation\], in single brack"),
        (
            '[excitation]\nkind = "sweep"\n[[sensors]]\nname = "P1"',
            r"sensors = \[{...}\]; each sensor is a table under its name; head it with \[sensors.NAME\]",
        ),
        ('[excitation]\nkind = "sweep"\n[sensors]\nP1 = 0.1', r"sensors.P1 = 0.1; .*; head it with \[sensors.NAME\]"),
        (
            '[excitation]\nkind = "sweep"\n[truth.effects]\nkind = "wear"',
            r"truth.effects = {...}; effects are a list of tables; head each one with \[\[truth.effects\]\]",
        ),
        (
            '[excitation]\nkind = "roving_hammer"\npositions = 0.7',
            r"excitation.positions = 0.7; positions are a list of numbers, m; write it as in positions = \[0.3, 0.7\]",
        ),
        (
            '[excitation]\nkind = "sweep"\n[truth]\nperturbed = "yes"',
            r"truth.perturbed = 'yes'; it should be true or false, without quotes; docs/",
        ),
        (
            '[excitation]\nkind = "sweep"\nduration = 8000.0',
            r"excitation.duration = 8000 s at fs = 2048 Hz; .* 4.88e\+03 s at .*; give duration in s and fs in",
        ),
    ],
)
def test_mistakes_are_told(tmp_path, text, message):
    with pytest.raises(InputError, match=message):
        read_experiment(written(tmp_path, text))


def test_a_file_that_is_not_there_is_told(tmp_path):
    with pytest.raises(InputError, match=r"none.toml: No such file.*; an experiment is a TOML file; correct the path"):
        read_experiment(tmp_path / "none.toml")


def test_a_record_in_the_place_of_the_experiment_is_told(tmp_path):
    path = tmp_path / "sweep.CSV"
    path.write_text("time [s],P1 [m/s^2]\n0,0\n")
    with pytest.raises(
        InputError, match=r"sweep.CSV: a record in the place of the experiment; .*; name the experiment"
    ):
        read_experiment(path)


def test_what_windows_writes_is_read_or_told(tmp_path):
    path, text = tmp_path / "test.toml", '[excitation]\r\nkind = "sweep"\r\n'
    path.write_bytes(text.encode("utf-8-sig"))
    assert read_experiment(path).excitation.kind == "sweep"
    path.write_bytes(text.encode("utf-16"))
    with pytest.raises(InputError, match=r"test.toml: byte 1 is not UTF-8; an experiment is a text in UTF-8; save it"):
        read_experiment(path)
