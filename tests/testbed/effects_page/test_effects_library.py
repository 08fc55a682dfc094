"""The page of effects is what the command makes of the library, with a picture for each kind."""

import json
from dataclasses import dataclass
from pathlib import Path

import pytest

from models.effects import EFFECTS
from models.effects.point_mass import PointMass
from models.effects.protocol import Signature
from testbed.cli.app import main
from testbed.effects_page.page import FIGURES, page_of

DOCS = Path(__file__).parents[3] / "docs"
PICTURES = DOCS / FIGURES
LARGEST_PICTURE = 60_000  # bytes, so that the repository stays light


def test_the_page_is_what_the_command_makes():
    """If this fails: testbed effects --out docs."""
    assert (DOCS / "effects.md").read_text(encoding="utf-8") == page_of()


def test_every_kind_has_a_picture_and_no_other_has():
    assert {path.stem for path in PICTURES.iterdir()} == set(EFFECTS)
    for path in PICTURES.iterdir():
        assert path.read_bytes().startswith(b"\x89PNG")
        assert path.stat().st_size < LARGEST_PICTURE


@pytest.mark.parametrize("cls", EFFECTS.values(), ids=EFFECTS)
def test_a_signature_says_where_it_shows_in_four_lines(cls):
    texts = vars(cls.signature)
    assert list(texts) == ["frequency", "level", "time", "place"]
    for text in texts.values():
        assert 5 < len(text) <= 105
        assert "\n" not in text
        assert not text.endswith(".")


def test_a_kind_that_is_added_gets_its_row_and_its_section():
    @dataclass(frozen=True)
    class Ballast(PointMass):
        """A ballast |here|, of ``mass``.

        More of it.

        Raises:
            InputError: never.
        """

        kind = "ballast"
        signature = Signature("low lines", "every level", "always", "its own place")

    page = page_of({**EFFECTS, "ballast": Ballast})
    assert r"| [`ballast`](#ballast) | position | B O | A ballast \|here\|, of `mass` | `mass` kg |" in page
    section = page.split("### ballast\n")[1]
    assert section.startswith("\nA ballast |here|, of `mass`.\n\nMore of it.\n\n- **frequency**: low lines\n")
    assert "](figures/effects/ballast.png)" in section
    assert "`mass` kg, 0 or more" in section


def test_the_command_lists_the_library(capsys):
    assert main(["effects"]) == 0
    out = capsys.readouterr().out
    assert all(kind in out for kind in EFFECTS)
    assert main(["effects", "point_mass", "--json"]) == 0
    content = json.loads(capsys.readouterr().out)
    assert list(content) == ["point_mass"]
    assert content["point_mass"]["places"] == ["position"]
    assert content["point_mass"]["parameters"]["mass"] == {"symbol": "m", "unit": "kg", "lower": 0.0, "upper": None}
    assert set(content["point_mass"]["signature"]) == {"frequency", "level", "time", "place"}


def test_an_unknown_kind_is_a_message(capsys):
    assert main(["effects", "point_masse"]) == 2
    message = capsys.readouterr().err
    assert message.startswith("point_masse: no such effect; the library has ")
    assert message.endswith("did you mean point_mass?\n")


def test_a_folder_that_is_a_file_is_a_message_before_anything_is_computed(capsys, tmp_path):
    (tmp_path / "out").write_text("")
    assert main(["effects", "--out", str(tmp_path / "out")]) == 2
    assert "is a file; results go into a folder" in capsys.readouterr().err


def test_one_kind_is_drawn_and_the_page_is_whole(capsys, tmp_path):
    assert main(["effects", "sensor_gain", "--out", str(tmp_path)]) == 0
    assert (tmp_path / "effects.md").read_text(encoding="utf-8") == page_of()
    assert [path.name for path in (tmp_path / FIGURES).iterdir()] == ["sensor_gain.png"]
    assert "written: " in capsys.readouterr().out
