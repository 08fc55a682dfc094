"""The page of effects against the library: names, places, parameters and units are the same."""

import re
from pathlib import Path

import pytest

from models.effects import EFFECTS

PAGE = (Path(__file__).parents[3] / "docs" / "effects.md").read_text()
ROWS = {
    kind: {"place": place, "on": on, "parameters": parameters}
    for kind, place, on, parameters in re.findall(
        r"^\| \[`(\w+)`\]\(#\1\) \| (.+?) \| ([BO ]+) \| .+ \| (.+?) \|$", PAGE, re.MULTILINE
    )
}


def test_the_page_has_a_row_and_a_section_for_each_kind():
    assert set(ROWS) == set(EFFECTS)
    assert PAGE.count("\n| [`") == len(ROWS)
    assert re.findall(r"^### (\w+)$", PAGE, re.MULTILINE) == list(EFFECTS)


@pytest.mark.parametrize("kind", EFFECTS)
def test_a_row_says_what_the_class_says(kind):
    cls, row = EFFECTS[kind], ROWS[kind]
    assert row["place"] == (" or ".join(cls.places) or "-")
    assert row["on"].split() == [{"beam": "B", "oscillator": "O"}[name] for name in cls.structures]
    units = ", ".join(f"`{name}` {about.unit}" for name, about in cls.parameters().items())
    assert row["parameters"] == (units or "-")


@pytest.mark.parametrize("kind", [kind for kind, cls in EFFECTS.items() if cls.options])
def test_a_row_names_the_options(kind):
    (row,) = [line for line in PAGE.splitlines() if line.startswith(f"| [`{kind}`]")]
    for key, choices in EFFECTS[kind].options.items():
        assert f'`{key}` "{choices[0]}" or "{choices[1]}"' in row
