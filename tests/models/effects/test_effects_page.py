"""The page of effects against the library: names, places, parameters and units are the same."""

import re
import tomllib
from pathlib import Path

import pytest

from models.effects import EFFECTS, build_effect
from models.rig import EffectEntry
from models.rig_file import read_rig
from testbed.effects_page.bench import OSCILLATOR, SHIPPED_RIG

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


@pytest.mark.parametrize("kind", EFFECTS)
def test_a_section_has_a_table_that_a_rig_file_takes_as_it_stands(kind):
    section = PAGE.split(f"### {kind}\n")[1].split("\n### ")[0]
    (text,) = re.findall(r"```toml\n(.*?)```", section, re.DOTALL)
    (table,) = tomllib.loads(text)["effects"]
    rig = read_rig(SHIPPED_RIG) if EFFECTS[kind].structures[0] == "beam" else OSCILLATOR
    effect = build_effect(EffectEntry(**table), rig, EFFECTS)
    assert effect.kind == kind
    assert set(EFFECTS[kind].parameters()) <= set(table)


@pytest.mark.parametrize("kind", [kind for kind, cls in EFFECTS.items() if cls.options])
def test_a_row_names_the_options(kind):
    (row,) = [line for line in PAGE.splitlines() if line.startswith(f"| [`{kind}`]")]
    for key, choices in EFFECTS[kind].options.items():
        assert f'`{key}` "{choices[0]}" or "{choices[1]}"' in row
