"""The next experiment in the files: as JSON, as a table, and as an experiment that runs."""

import shlex
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from cli_files import make_files
from made_up_diagnosis import FS, made_up_proposal

from identification.next_experiment.planned import PlannedTest
from identification.next_experiment.proposal import Proposal
from models.rig_file import read_rig
from models.rig_parts import Sensor
from models.simulators.protocol import Resolution
from testbed.cli.app import main
from testbed.proposal import (
    EXPERIMENT,
    HEADS,
    RIG,
    excitation_rows,
    option_rows,
    proposal_json,
    stale,
    write_experiment,
)
from testbed.simulate_run import Order, run_experiment
from testbed.virtual.experiment import read_experiment


@pytest.fixture
def rig_path(tmp_path):
    return make_files(tmp_path) / "rig.toml"


def carried_out(rig_path, folder, suffix=".h5"):
    order = Order(rig_path, folder / EXPERIMENT, "modal", Resolution(), suffix)
    return run_experiment(order, folder / "records", jobs=1, progress=lambda _: None)


def test_the_json_holds_the_test_what_it_promises_and_the_others():
    content = proposal_json(made_up_proposal())
    assert content["do"] == "a sweep of 2 N"
    assert content["excitation"] == {"kind": "sweep", "low": 5.0, "high": 100.0, "amplitude": 2.0, "duration": 4.0}
    assert (content["expected_probability"], content["separation"], content["present_probability"]) == (0.98, 4.2, 0.5)
    assert content["minutes"] == pytest.approx(1.0 + 4.0 / 60.0)
    options = [(option["do"], option["confirmed"]) for option in content["options"]]
    assert options == [("a sweep of 2 N", True), ("a sweep of 1 N", False)]


def test_words_alone_are_words_alone_in_the_json_and_leave_no_file(tmp_path, rig_path):
    words = Proposal("a time record", "to see more")
    assert proposal_json(words) == {"do": "a time record", "why": "to see more"}
    write_experiment(words, rig_path, tmp_path)
    assert not (tmp_path / EXPERIMENT).exists()
    assert stale(words) == (EXPERIMENT, RIG)
    assert (option_rows(words), excitation_rows(words)) == ([], [])


def test_the_table_is_of_finished_texts():
    rows = option_rows(made_up_proposal())
    assert [len(row) for row in rows] == [len(HEADS)] * 2
    assert rows[0] == ("a sweep of 2 N", "1.07", "0.980", "4.2", "2.1 x")
    assert rows[1][2] == "up to 0.700"


def test_the_experiment_that_is_written_runs(tmp_path, rig_path):
    proposal = made_up_proposal()
    write_experiment(proposal, rig_path, tmp_path)

    read = read_experiment(tmp_path / EXPERIMENT)
    done = carried_out(rig_path, tmp_path)

    assert (read.fs, read.excitation.amplitude) == (FS, 2.0)
    # White noise of 0.01 up to fs / 2.
    assert read.sensors["P1"].noise_density * np.sqrt(FS / 2.0) == pytest.approx(0.01, rel=1e-2)
    assert [row["record"] for row in done["records"]] == ["sweep_2.h5"]
    assert stale(proposal) == (RIG,)


def test_the_command_in_the_file_runs_in_its_folder(tmp_path, rig_path, monkeypatch):
    home = tmp_path / "results" / "my rig"
    home.mkdir(parents=True)
    (tmp_path / "stage").mkdir()
    write_experiment(made_up_proposal(), rig_path, tmp_path / "stage", home=home)
    (tmp_path / "stage" / EXPERIMENT).rename(home / EXPERIMENT)

    (line,) = [line for line in (home / EXPERIMENT).read_text().splitlines() if "testbed simulate" in line]
    words = shlex.split(line[line.index("simulate") :])

    assert words[1] == "../../rig.toml"
    monkeypatch.chdir(home)
    assert main(words) == 0
    assert (home / "next_records" / "sweep_2.uff").is_file()


def test_the_rivals_stand_in_the_file_for_whoever_tries_it_on_one(tmp_path, rig_path):
    write_experiment(made_up_proposal(), rig_path, tmp_path)
    lines = (tmp_path / EXPERIMENT).read_text().splitlines()
    first = lines.index("# [[truth.effects]]")
    (table,) = tomllib.loads("\n".join(line.removeprefix("# ") for line in lines[first : first + 4]))["truth"][
        "effects"
    ]
    assert table == {"kind": "squeeze_film", "sleeve": "sleeve 2", "damping": 18.5}


def test_one_more_sensor_comes_with_a_rig_that_has_it(tmp_path, rig_path):
    rig = read_rig(rig_path)
    more = rig.model_copy(update={"sensors": (*rig.sensors, Sensor(name="at 900 mm", node=101, position=0.9))})
    proposal = replace(made_up_proposal(), rig=more, noise={"P1": 0.01, "at 900 mm": 0.01})

    write_experiment(proposal, rig_path, tmp_path)

    assert read_rig(tmp_path / RIG).sensors[-1].position == 0.9
    assert "The owner's comment." in (tmp_path / RIG).read_text()
    assert RIG in (tmp_path / EXPERIMENT).read_text()
    assert carried_out(tmp_path / RIG, tmp_path)["records"]
    assert stale(proposal) == ()


@pytest.mark.parametrize(
    "table",
    [
        {"kind": "multisine", "low": 5.0, "high": 50.0, "rms": 3.0, "period": 1.0, "periods": 2, "position": 0.3},
        {"kind": "hammer", "peak": 10.0, "width": 5e-3, "blows": 1, "interval": 1.0, "start": 0.05, "position": 0.7},
        {"kind": "release", "position": 1.2, "force": -10.0, "duration": 1.0},
    ],
    ids=lambda table: table["kind"],
)
def test_every_kind_of_test_is_written_so_that_it_runs(tmp_path, rig_path, table):
    test = PlannedTest("another test", "any", table, 512.0, 1.0)
    write_experiment(Proposal("another test", "to see", test, noise={"excitation": 0.1}), rig_path, tmp_path)
    assert len(carried_out(rig_path, tmp_path, ".uff" if table["kind"] != "release" else ".h5")["records"]) == 1
