"""``docs/commands.md`` names every command, and its cheap examples do what they say."""

import re
import shlex
from pathlib import Path

import pytest
from cli_files import make_files
from typer.main import get_command

from testbed.cli.app import app, main

PAGE = (Path(__file__).parents[2] / "docs" / "commands.md").read_text(encoding="utf-8")
EXAMPLES = [
    shlex.split(line)[1:]
    for block in re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL)
    for line in block.splitlines()
    if line.startswith("testbed ")
]
LONG = ("diagnose", "demo")
SLOW = ("benchmark", "crosscheck", "study")
"""Run elsewhere: with made-up results in test_cli_diagnose.py, in earnest by the tests of demo and studies."""


def test_every_command_has_an_example():
    commands = [command.callback.__name__ for command in app.registered_commands]
    commands += [group.name for group in app.registered_groups]
    assert {example[0] for example in EXAMPLES} == set(commands)


def _commands(command, path=()):
    if not hasattr(command, "commands"):
        return [(path, command)]
    return [found for name, each in command.commands.items() for found in _commands(each, (*path, name))]


@pytest.mark.parametrize(
    ("path", "command"), _commands(get_command(app)), ids=lambda each: "-".join(each) if isinstance(each, tuple) else ""
)
def test_every_option_is_told_where_its_command_is(path, command):
    head, *sections = re.split(r"^## ", PAGE, flags=re.MULTILINE)
    (section,) = [text for text in sections if path[0] in text.split("\n", 1)[0].split()]
    words = set(re.findall(r"(?<![\w-])--[\w-]+", section))
    words |= {
        option
        for option, where in re.findall(r"^\| `(--\w+).*?` \| (.*?) \|", head, re.MULTILINE)
        if _is_of(where, path)
    }
    options = {o for parameter in command.params for o in (*parameter.opts, *parameter.secondary_opts)}
    assert {option for option in options if option.startswith("--")} <= words


def _is_of(where, path):
    """Whether the table's column says that an option is of a command; "all" and words like it are not asked further."""
    return path[0] in where or where.startswith("all")


def test_the_examples_run_one_after_the_other(tmp_path, monkeypatch, capsys):
    make_files(tmp_path)
    monkeypatch.chdir(tmp_path)
    ordered = sorted((e for e in EXAMPLES if e[0] not in (*LONG, *SLOW)), key=lambda e: e[0] in ("history", "undo"))
    for example in ordered:
        assert main(example) == 0, (example, capsys.readouterr().err)


@pytest.mark.parametrize("example", [e for e in EXAMPLES if e[0] in LONG], ids=lambda e: e[0])
def test_a_long_example_is_understood(example, monkeypatch, tmp_path):
    seen = []
    monkeypatch.setattr(f"testbed.cli.{example[0]}.diagnose_files", lambda *args, **kwargs: seen.append((args, kwargs)))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("testbed.cli.demo._simulated", lambda *args: [tmp_path / "sweep.uff"])
    assert main(example) == 0
    assert seen
