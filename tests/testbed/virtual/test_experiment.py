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
            r"excitation.lo; the keys here are angle, position, kind, low, .*; did you mean low\?",
        ),
        ('[excitation]\nkind = "sweep"\nlow = -3.0', r"excitation.low = -3.0; it should be greater than 0; docs/"),
        ('[excitation]\nkind = "sweep"\n[sensors.P1]\npreste = "x"', r"sensors.P1.preste; .*; did you mean preset\?"),
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
        ("fs = = 3", r"test.toml: .*; an experiment is a TOML file; correct it there"),
    ],
)
def test_mistakes_are_told(tmp_path, text, message):
    with pytest.raises(InputError, match=message):
        read_experiment(written(tmp_path, text))


def test_a_file_that_is_not_there_is_told(tmp_path):
    with pytest.raises(InputError, match=r"none.toml: No such file.*; an experiment is a TOML file; correct the path"):
        read_experiment(tmp_path / "none.toml")
