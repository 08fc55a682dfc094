"""The README's commands do what they say, in the order in which it gives them."""

import glob
import json
import re
import shlex
import shutil
from pathlib import Path

import pytest

from testbed.cli.app import main
from testbed.hidden_effects.sets import BEFORE

HOUSE = Path(__file__).parents[1]
LINES = [
    shlex.split(line, comments=True)
    for block in re.findall(r"```sh\n(.*?)```", (HOUSE / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    for line in block.splitlines()
]
COMMANDS = [words[1:] for words in LINES if words and words[0] == "testbed"]
AFTER_A_DIAGNOSIS = ("history",)
"""Seen at work in test_history.py; here no diagnosis has left anything."""


README = (HOUSE / "README.md").read_text(encoding="utf-8")
RESULTS = json.loads((HOUSE / "results" / "hidden_effects" / "summary.json").read_text(encoding="utf-8"))
IN_TABLE = {
    "right kind and place first, one effect": "one effect: kind and place right first",
    "right, or in a group of at most three": "one effect: right first, or in a stated group of at most three",
    '"complete" with nothing hidden': "nothing hidden: `complete`",
    '"unexplained" outside the library': "a law outside the library: `unexplained`",
    "both of two effects found": "two effects: both found",
    "numbers inside their 95 % interval": "numbers inside their 95 % intervals",
}
"""Rows of the hidden-effect table that hold a share, by the name of their bar in the results."""


def _hidden_effects() -> dict[str, list[str]]:
    """The cells of each row of the table, by its first."""
    table = README.partition("### Hidden effects")[2].partition("###")[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines() if line[:1] == "|"]
    return {first: cells for first, *cells in rows}


@pytest.mark.parametrize(("bar", "row"), IN_TABLE.items())
def test_the_hidden_effects_stand_as_in_the_results_misses_too(bar, row):
    asked, reached, newest = _hidden_effects()[row]
    over_all, latest = (
        next(one for one in bars if one["name"] == bar) for bars in (RESULTS["bars"], RESULTS["newest"]["bars"])
    )
    right, of = re.match(r"(\d+) of (\d+) ", reached).groups()
    assert (int(of), round(int(right) / int(of), 9)) == (over_all["cases"], round(over_all["value"], 9))
    assert f"({over_all['value']:.1%})".replace("%", " %") in reached
    assert newest.startswith(f"{latest['value']:.1%}".replace("%", " %"))
    assert asked.startswith(f"{over_all['bar']:.0%}".rstrip("%"))
    for told, judged in ((reached, over_all), (newest, latest)):
        assert ("missed" in told) is not judged["met"]


def test_the_other_figures_of_the_hidden_effects_are_those_of_the_results():
    for place, bars in ((1, RESULTS["bars"]), (2, RESULTS["newest"]["bars"])):
        value = {bar["name"]: bar for bar in bars}
        median = value["error held out after, over the true noise, median"]["value"]
        high = value["the same, 90th percentile"]["value"]
        held = _hidden_effects()["error on the record held out over the true noise: median, 90th percentile"]
        assert held[place] == f"{median:.2f}, {high:.2f}"
        seconds = next(bar for name, bar in value.items() if name.startswith("seconds"))
        told = _hidden_effects()["seconds of a diagnosis on two threads, median"][place]
        assert told.startswith(f"{seconds['value']:.1f}, of {seconds['cases']} cases")
    assert f"Each of the {RESULTS['cases']} cases" in README
    assert f"| {RESULTS['cases']} reported cases in " in README
    assert f"hidden-effects --cases {RESULTS['cases']}`" in README
    missed = [bar["name"] for bar in RESULTS["bars"] if not bar["met"]]
    told = {1: "one of nine bars is missed", 2: "two of nine bars are missed", 3: "three of nine bars are missed"}
    assert told[len(missed)] in README
    assert "**Missed bars**" in README.partition("## Known limits")[2]


def test_its_limits_count_as_the_results_do():
    limits = " ".join(README.partition("## Known limits")[2].split())
    hertz, located, since = RESULTS["numbers"]["kinds"]["hertz_contact"], RESULTS["located"], RESULTS["located_since"]
    inside = round(hertz["count"] * hertz["inside_share"])
    assert f"of `hertz_contact` {inside} of {hertz['count']} numbers" in limits
    assert f"told in {located['told']} of {located['cases']} cases" in limits
    assert f"in {since['inside']} of the newest {since['told']}" in limits
    alone = {name: row["median"] for name, row in RESULTS["newest"]["seconds_alone"].items()}
    assert f"on one thread {alone['nothing hidden']:.0f} s in the median where nothing is missing" in limits
    assert f"{alone['one effect']:.0f} s with one effect" in limits
    two, none = (round(alone[name] / 60.0) for name in ("two effects", "outside the library"))
    assert f"{two} minutes with two and {none} where none explains" in limits
    cores = {name: row["median"] for name, row in RESULTS["newest"]["seconds_on_cores"].items()}
    told = "{:.0f} s with nothing hidden, {:.0f} s with one effect, {:.0f} s with two and {:.0f} s with a law outside"
    assert (
        told.format(*(cores[name] for name in ("nothing hidden", "one effect", "two effects", "outside the library")))
        in limits
    )
    taken = f"all {RESULTS['seconds']['cases']} took {RESULTS['seconds_in_first_mix']:.1f} s"
    assert f"at the tenth that the first batches have, {taken}" in limits
    chaotic = RESULTS["chaotic"]
    groups = ("nothing hidden", "one effect", "two effects", "outside the library")
    right, cases = (sum(RESULTS[group][key] for group in groups) - chaotic[key] for key in ("right", "cases"))
    told = f"right in {chaotic['right']} of {chaotic['cases']} cases, others in {right} of {cases}"
    assert f"**Chaotic rigs** are {told}" in limits
    seldom = {kind for kind, row in RESULTS["numbers"]["kinds"].items() if row["inside_share"] < 0.9}
    words = limits.partition("**Intervals**")[2].partition("**Hard impacts**")[0]
    assert seldom == set(re.findall(r"`(\w+)`", words))
    aside = sum(cases for cases, _ in BEFORE.values())
    assert f"{aside} cases of other diagnoses are not counted" in README


def test_the_limits_in_detail_count_as_the_results_do():
    theory = (HOUSE / "docs" / "theory.md").read_text(encoding="utf-8")
    limits = " ".join(theory.partition("## 25 Limits in detail")[2].split())
    named, beside = (
        next(row for row in RESULTS[table] if row["met"] and not row["taught"])
        for table in ("by_what_is_left", "added_later")
    )
    assert f"{named['right']} of {named['cases']} effects named there were there" in limits
    assert f"{beside['right']} of {beside['cases']} were there" in limits
    hertz = RESULTS["numbers"]["kinds"]["hertz_contact"]
    assert f"{round(hertz['count'] * hertz['inside_share'])} of {hertz['count']} of those of `hertz_contact`" in limits


@pytest.mark.parametrize("folder", ["hidden_effects_varied", "next_experiments"])
def test_the_commands_of_the_results_are_those_on_their_pages(folder):
    page = (HOUSE / "results" / folder / "README.md").read_text(encoding="utf-8")
    (command,) = re.findall(r"^Made by `(.*)`", page, re.MULTILINE)
    assert f"`{command}`" in (HOUSE / "results" / "README.md").read_text(encoding="utf-8")


def test_what_its_commands_leave_in_the_folder_is_ignored_by_git():
    ignored = (HOUSE / ".gitignore").read_text(encoding="utf-8").splitlines()
    folders = {words[words.index("--out") + 1] for words in LINES if "--out" in words}
    assert {"/rig.toml", "/*.uff", *(f"/{folder}/" for folder in folders)} <= set(ignored)


def test_its_links_lead_to_headings_that_are_there():
    for path, anchor in re.findall(r"\]\((docs/[\w/]+\.md)#([\w-]+)\)", README):
        heads = re.findall(r"^#+ (.*)$", (HOUSE / path).read_text(encoding="utf-8"), re.MULTILINE)
        slugs = {re.sub(r"[^\w -]", "", head.lower()).replace(" ", "-") for head in heads}
        assert anchor in slugs, (path, anchor)


def test_the_targets_it_names_are_those_of_the_makefile():
    targets = {words[1] for words in LINES if words and words[0] == "make"}
    assert targets == {"demo", "test"}
    makefile = (HOUSE / "Makefile").read_text(encoding="utf-8")
    assert all(re.search(rf"^{target}:", makefile, re.MULTILINE) for target in targets)


@pytest.mark.slow
def test_its_commands_run_in_their_order(tmp_path, monkeypatch, capsys):
    shutil.copytree(HOUSE / "testbed" / "demo", tmp_path / "testbed" / "demo")
    shutil.copytree(HOUSE / "docs", tmp_path / "docs")
    monkeypatch.chdir(tmp_path)
    for words in LINES:
        if words and words[0] == "cp":
            for source in [name for pattern in words[1:-1] for name in glob.glob(pattern)]:  # noqa: PTH207
                shutil.copy(source, words[-1])
    asked = []
    monkeypatch.setattr("testbed.cli.diagnose.diagnose_files", lambda *args, **more: asked.append((args, more)))
    for words in COMMANDS:
        if words[0] in AFTER_A_DIAGNOSIS:
            continue
        named = [name for word in words for name in (sorted(glob.glob(word)) if "*" in word else [word])]  # noqa: PTH207
        assert main(named) == 0, (named, capsys.readouterr().err)
    assert len(asked) == sum(words[0] == "diagnose" for words in COMMANDS)
    assert all(path.is_file() for (_, records, held_out, *_), _ in asked for path in (*records, *held_out))
    assert list((tmp_path / "film").glob("*.gif"))
