"""The README's commands do what they say, in the order in which it gives them."""

import glob
import re
import shlex
import shutil
from pathlib import Path

import pytest

from testbed.cli.app import main

HOUSE = Path(__file__).parents[1]
LINES = [
    shlex.split(line, comments=True)
    for block in re.findall(r"```sh\n(.*?)```", (HOUSE / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    for line in block.splitlines()
]
COMMANDS = [words[1:] for words in LINES if words and words[0] == "testbed"]
AFTER_A_DIAGNOSIS = ("history",)
"""Seen at work in test_history.py; here no diagnosis has left anything."""


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
