"""Exit statuses, messages in three parts, help with examples, and what goes to which stream."""

import subprocess
import sys
from pathlib import Path

import pytest

from models.errors import DivergenceError
from testbed.cli.app import main

COMMANDS = (
    *("demo", "check", "compare", "diagnose", "add", "history", "undo", "modes", "frf", "identify"),
    *("simulate", "film", "cosim", "crosscheck", "effects", "study"),
)
RIG = Path(__file__).parents[1] / "data" / "reference_rig.toml"
EXPERIMENT = Path(__file__).parents[2] / "docs" / "experiment.toml"


@pytest.mark.parametrize(
    ("arguments", "beginning"),
    [
        (["compare", "none.toml", "a.csv"], "none.toml does not exist; a rig is a TOML file; correct the path"),
        (["compare", str(RIG), "a.csv"], "a.csv: there is no such file; a record is a file, one of .uff, .unv"),
        (["compare", str(RIG)], "testbed compare: Missing argument 'RECORD'; usage: testbed compare RIG RECORD... ["),
        (
            ["sweep", str(RIG), "--from", "5", "--to", "9"],
            "testbed sweep: Missing option '--amplitude'; usage: testbed sweep RIG --amplitude A --from HZ",
        ),
        (
            ["demo", "--with", "ansys"],
            "--with ansys; the records of the demo are made by modal, mujoco, exudyn, or are s",
        ),
        (["simulate", str(RIG), str(RIG)], "reference_rig.toml: a rig file in the place of the experiment; an experi"),
        (["modes", str(EXPERIMENT)], "experiment.toml: an experiment in the place of the rig; a rig file has [structu"),
        (["modes", str(RIG), "--up-to", "5"], "no mode oscillates up to 5 Hz; modes are shown up to the frequency of "),
        (
            ["add", str(RIG), "squeeze_film", "--fit", "a.csv"],
            "squeeze_film without a place; it sits at one sleeve; gi",
        ),
        (["compair"], "testbed: No such command 'compair'"),
        (["modes", str(RIG), "--up-to", "many"], "testbed modes: Invalid value for '--up-to': many; it is a number; "),
        (["modes", str(RIG), "--up-to", "nan"], "testbed modes: Invalid value for '--up-to': nan; it is 0 or more; "),
        (["identify", "a.csv", "--band", "3", "x"], "testbed identify: Invalid value for '--band': x; it is a number"),
        (
            ["identify", "a.csv", "--denoise", "x"],
            "testbed identify: Invalid value for '--denoise': x; it is one of none, wavelet, ensemble; correct it",
        ),
        (["modes", str(RIG), "--upto", "5"], "testbed modes: No such option: --upto"),
        (["modes", str(RIG), "--up-to", "1"], "no mode oscillates up to 1 Hz"),
        (
            ["compare", str(RIG), "a.csv", "--jobs", "0"],
            "testbed compare: Invalid value for '--jobs': 0; it is 1 or more; correct it, or see testbed compare",
        ),
        (
            ["compare", str(RIG), "a.csv", "--jobs", "1.5"],
            "testbed compare: Invalid value for '--jobs': 1.5; it is a wh",
        ),
        (
            ["simulate", str(RIG), str(EXPERIMENT), "--parts", "1001"],
            "testbed simulate: Invalid value for '--parts': 1001; it is ",
        ),
        (["diagnose", str(RIG), "a.csv", "--holdout", "b/a.csv"], "a.csv is named 2 times"),
        (["compare", "a.csv", "a.csv"], "a.csv: a record in the place of the rig; the rig file (.toml) comes first"),
        (["diagnose", str(RIG), "a.csv", "--out", str(RIG)], f"--out {RIG}: {RIG} is a file; results go into a folder"),
        (["frf", "a.doc"], 'a.doc: the suffix ".doc"'),
        (
            ["compare", str(RIG), str(RIG)],
            "reference_rig.toml: a rig file or an experiment in the place of a record",
        ),
        (["history", "nowhere"], "nowhere: no history"),
    ],
)
def test_bad_input_is_one_message_of_three_parts_and_status_2(arguments, beginning, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    streams = capsys.readouterr()
    assert streams.out == ""
    message = streams.err.splitlines()[-1]
    assert message.startswith(beginning)
    assert message.count(";") >= 2
    assert "Traceback" not in streams.err


def test_a_message_names_what_would_do(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["modes", str(RIG), "--up-to", "5"]) == 2
    assert capsys.readouterr().err.endswith("raise it: the first mode is at 25.64 Hz\n")
    assert main(["add", str(RIG), "squeeze_film", "--fit", "a.csv"]) == 2
    assert capsys.readouterr().err.endswith("give --sleeve NAME: sleeve 1, sleeve 2\n")
    assert main(["effects", "turbulence_of_the_sea"]) == 2
    assert "did you mean" not in capsys.readouterr().err
    assert main(["effects", "squeeze_flim"]) == 2
    assert "did you mean squeeze_film?" in capsys.readouterr().err


@pytest.mark.parametrize("group", ["study", "benchmark"])
def test_a_group_without_a_command_lists_its_commands(group, capsys):
    assert main([group]) == 2
    message = capsys.readouterr().err.splitlines()[-1]
    assert message.startswith(f"testbed {group}: nothing was named; it takes one of ")
    assert {"study": "contact-laws, identifier", "benchmark": "hidden-effects"}[group] in message


@pytest.mark.skipif(not Path("/proc/self").is_dir(), reason="a folder in which nothing can be made")
def test_a_folder_in_which_nothing_can_be_made_is_told_at_once(capsys):
    assert main(["diagnose", "no_rig.toml", "a.csv", "--out", "/proc/foo"]) == 2
    assert "--out /proc/foo: " in capsys.readouterr().err


def test_a_motion_that_grows_without_bound_is_a_message(monkeypatch, capsys, tmp_path):
    def diverge(*args, **kwargs):
        raise DivergenceError("sweep.csv: the motion grew without bound 0.1 s after the start")

    monkeypatch.setattr("testbed.inputs.read_inputs", diverge)
    assert main(["compare", str(RIG), "sweep.csv", "--out", str(tmp_path)]) == 2
    assert "sweep.csv: the motion grew without bound" in capsys.readouterr().err


def test_a_results_folder_that_is_a_file_is_a_message(capsys, tmp_path):
    (tmp_path / "out").write_text("")
    assert main(["modes", str(RIG), "--out", str(tmp_path / "out")]) == 2
    assert "out is a file; results go into a folder" in capsys.readouterr().err


WRITING = {
    "diagnose": [str(RIG), "a.csv"],
    "compare": [str(RIG), "a.csv"],
    "add": [str(RIG), "squeeze_film", "--sleeve", "sleeve 2", "--fit", "a.csv"],
    "modes": [str(RIG)],
    "frf": ["a.csv"],
    "budget": ["a.csv"],
    "identify": ["a.csv"],
    "sweep": [str(RIG), "--amplitude", "1", "--from", "5", "--to", "6"],
    "simulate": [str(RIG), "a.toml"],
    "film": [str(RIG), "a.csv"],
    "cosim": [str(RIG)],
    "crosscheck": [str(RIG)],
    "effects": ["squeeze_film"],
    "demo": [],
    "study": ["contact-laws", str(RIG)],
    "benchmark": ["hidden-effects"],
}


@pytest.mark.parametrize("command", WRITING)
@pytest.mark.parametrize(
    ("out", "message"), [("", "--out ''; results go into a folder that has a name; "), ("file/out", "file is a file; ")]
)
def test_a_folder_that_cannot_be_written_is_told_before_a_file_is_read(
    command, out, message, capsys, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "file").write_text("")
    assert main([command, *WRITING[command], "--out", out]) == 2
    assert message in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


@pytest.mark.parametrize("command", COMMANDS)
def test_help_shows_an_example(command, capsys):
    assert main([command, "--help"]) == 0
    assert f"Example: testbed {command}" in capsys.readouterr().out


def test_without_a_command_the_help_lists_them_all(capsys):
    assert main([]) == 0
    out = capsys.readouterr().out
    assert all(command in out for command in COMMANDS)


ANEW = "stopped; nothing was written, a new start begins anew"
GOES_ON = "stopped; whatever was finished is kept, and the same command goes on from there"


@pytest.mark.parametrize(
    ("arguments", "place", "line"),
    [
        (["compare", str(RIG), "a.csv"], "testbed.inputs.read_inputs", ANEW),
        (["diagnose", str(RIG), "a.csv"], "testbed.inputs.read_inputs", ANEW),
        (["study", "contact-laws", str(RIG)], "testbed.contact_laws.run.run_contact_laws", ANEW),
        (["study", "article"], "testbed.article.run.run_article", GOES_ON),
        (["simulate", str(RIG), "a.toml"], "testbed.simulate_run.run_experiment", GOES_ON),
        (["benchmark", "hidden-effects"], "testbed.hidden_effects.run.run_hidden_effects", GOES_ON),
        (["demo"], "testbed.simulate_run.run_experiment", GOES_ON),
    ],
)
def test_an_interrupt_is_a_line_that_says_what_is_kept(arguments, place, line, monkeypatch, capsys, tmp_path):
    def interrupt(*args, **kwargs):
        raise KeyboardInterrupt

    monkeypatch.setattr(place, interrupt)
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 130
    streams = capsys.readouterr()
    assert streams.err.splitlines()[-1] == line
    assert (streams.out, "Traceback" in streams.err) == ("", False)


def test_the_commands_start_without_the_heavy_libraries():
    heavy = ["numpy", "scipy", "numba", "matplotlib", "pint", "h5py"]
    code = "import sys, testbed.cli.app; print([name for name in sys.argv[1:] if name in sys.modules])"
    result = subprocess.run([sys.executable, "-c", code, *heavy], capture_output=True, text=True, check=True)
    assert result.stdout == "[]\n"


def test_as_a_process_the_status_is_2_and_there_is_no_traceback(tmp_path):
    house = Path(__file__).parents[2]
    command = [sys.executable, "-m", "testbed", "compare", str(tmp_path / "no.toml"), "a.csv"]
    result = subprocess.run(command, cwd=house, capture_output=True, text=True, check=False)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.endswith("no.toml does not exist; a rig is a TOML file; correct the path\n")
    assert "Traceback" not in result.stderr
