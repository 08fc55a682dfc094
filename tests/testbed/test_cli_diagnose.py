"""What ``testbed diagnose`` writes, when it does not run again, and that nothing half-written stays."""

import json
import sys
from types import ModuleType

import numpy as np
import pytest
from cli_files import make_files, write_frfs
from made_up_diagnosis import made_up_diagnosis

from models.rig_file import read_rig
from testbed.cli.app import main
from testbed.cli.demo import against_truth
from testbed.cli.diagnose import MOST_TOLD
from testbed.cli.tables import print_diagnosis


class Loop:
    """Stands for the diagnosis and the report, and remembers what they were asked."""

    def __init__(self):
        self.calls, self.provenance, self.broken, self.within = [], None, False, None

    def diagnose(self, rig, records, holdout=(), *, seed=0, jobs=2, alike=False, within=None, progress=print):
        self.within = within
        self.calls.append(([r.name for r in records], [r.name for r in holdout], seed, jobs))
        progress("screening")
        return made_up_diagnosis(rig, records[0])

    def write_report(self, diagnosis, rig, out_dir, provenance):
        self.provenance = provenance
        if self.broken:
            raise OSError(28, "No space left on device", str(out_dir))
        (out_dir / "report.html").write_text("<html></html>")
        return out_dir / "report.html"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return make_files(tmp_path)


@pytest.fixture
def loop(monkeypatch):
    fake = Loop()
    pytest.importorskip("identification.diagnose")
    monkeypatch.setattr("identification.diagnose.diagnose", fake.diagnose)
    report = ModuleType("testbed.report")
    report.write_report = fake.write_report
    report.provenance = lambda rig_path, record_paths, seed, command: (rig_path, record_paths, seed, command)
    monkeypatch.setitem(sys.modules, "testbed.report", report)
    return fake


def diagnose(*arguments):
    return main(["diagnose", "rig.toml", "sweep.csv", *arguments])


def test_the_results_of_a_diagnosis_stand_in_its_folder(folder, loop, capsys):
    assert diagnose("--holdout", "burst.csv", "--seed", "3", "--jobs", "1") == 0
    assert loop.calls == [(["sweep.csv"], ["burst.csv"], 3, 1)]
    out = folder / "results" / "rig"
    files = {str(path.relative_to(out)) for path in out.rglob("*") if path.is_file()}
    history = {f"history/{name}" for name in ("0001.toml", "0002.toml", "0003.toml", "history.json")}
    written = {"diagnosis.json", "rig.updated.toml", "report.html", "run.json", "next_experiment.toml"}
    assert files == {*written, *history}
    assert json.loads((out / "diagnosis.json").read_text())["verdict"] == "missing_effect"
    assert read_rig(out / "rig.updated.toml").effects[0].kind == "squeeze_film"
    streams = capsys.readouterr()
    assert "+ squeeze_film at sleeve 2" in streams.out
    assert "results/rig/report.html" in streams.out
    assert "results/rig/next_experiment.toml" in streams.out
    assert "screening" in streams.err
    assert "screening" not in streams.out


def test_some_findings_are_told_before_the_work_and_the_others_counted(folder, loop, capsys):
    comment, head, *rows = (folder / "sweep.csv").read_text().splitlines()
    strangers = [f"extra {i}" for i in range(6)]
    wider = [comment, ",".join([head, *strangers]), *(",".join([row, *["0.5"] * 6]) for row in rows)]
    (folder / "sweep.csv").write_text("\n".join(wider) + "\n")
    assert diagnose() == 0
    told = capsys.readouterr().err
    assert [name for name in strangers if f"channel {name} is no sensor" in told] == strangers[:MOST_TOLD]
    assert told.index("and 2 more findings") < told.index("screening")


def test_json_alone_is_on_standard_output(folder, loop, capsys):
    assert diagnose("--json") == 0
    content = json.loads(capsys.readouterr().out)
    assert content == json.loads((folder / "results" / "rig" / "diagnosis.json").read_text())


def test_the_same_inputs_are_not_diagnosed_twice(folder, loop, capsys):
    diagnose()
    capsys.readouterr()
    assert diagnose() == 0
    assert len(loop.calls) == 1
    assert "kept (--again repeats it)" in capsys.readouterr().err
    diagnose("--again")
    assert len(loop.calls) == 2


@pytest.mark.parametrize(
    "change",
    [
        lambda folder: (folder / "rig.toml").write_text((folder / "rig.toml").read_text() + "\n# new\n"),
        lambda folder: (folder / "sweep.csv").write_text((folder / "sweep.csv").read_text() + "\n"),
        lambda folder: (folder / "results" / "rig" / "report.html").unlink(),
        lambda folder: (folder / "results" / "rig" / "rig.updated.toml").write_text("# by hand"),
    ],
)
def test_a_change_of_any_input_or_output_diagnoses_again(folder, loop, change):
    diagnose()
    change(folder)
    diagnose()
    assert len(loop.calls) == 2


@pytest.mark.parametrize(
    "option", [("--seed", "1"), ("--holdout", "burst.csv"), ("--without", "P1"), ("--alike",), ("--within", "2")]
)
def test_another_question_is_another_run(folder, loop, option):
    diagnose()
    diagnose(*option)
    assert len(loop.calls) == 2


def test_minutes_are_given_to_the_search_and_none_where_none_are_asked_for(folder, loop):
    diagnose()
    assert loop.within == np.inf
    diagnose("--within", "2.5")
    assert loop.within == 150.0


def test_more_threads_are_the_same_question(folder, loop):
    diagnose("--jobs", "1")
    diagnose("--jobs", "2")
    assert len(loop.calls) == 1


def test_a_report_that_cannot_be_written_leaves_the_old_results(folder, loop, capsys):
    diagnose()
    out = folder / "results" / "rig"
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    loop.broken = True
    assert diagnose("--again") == 2
    assert "No space left on device" in capsys.readouterr().err
    assert {path: path.read_bytes() for path in out.rglob("*") if path.is_file()} == before


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("report.html/", None, "results/rig/report.html is a folder"),
        ("history", "", "results/rig/history is a file"),
        ("history/history.json", "{", "results/rig/history/history.json: Expecting"),
        ("history/history.json", '{"entries": [], "current": 3}', "its numbers do not fit together"),
        ("next_experiment.toml/", None, "results/rig/next_experiment.toml is a folder"),
    ],
)
def test_what_would_stop_the_results_is_told_before_anything_is_computed(folder, loop, capsys, name, content, message):
    path = folder / "results" / "rig" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.mkdir() if content is None else path.write_text(content)
    assert diagnose() == 2
    assert message in capsys.readouterr().err
    assert loop.calls == []


def test_the_report_is_told_where_everything_comes_from(folder, loop):
    diagnose("--seed", "3", "--holdout", "burst.csv")
    rig_path, record_paths, seed, command = loop.provenance
    assert (rig_path.name, [path.name for path in record_paths], seed) == ("rig.toml", ["sweep.csv", "burst.csv"], 3)
    assert command.split()[0] == "testbed"


def test_frfs_alone_are_diagnosed_and_the_report_says_what_they_cannot_show(folder, capsys):
    rig = read_rig("rig.toml")
    write_frfs(rig, folder / "h.uff")
    assert main(["diagnose", "rig.toml", "h.uff", "--holdout", "burst.csv", "--jobs", "1"]) == 0
    content = json.loads((folder / "results" / "rig" / "diagnosis.json").read_text())
    assert (content["verdict"], content["effects"], content["where"]["records"]) == ("complete", [], [])
    assert content["where"]["linear"]["updated"][0]["nrmse"] == pytest.approx(0.01, rel=0.3)
    assert "no nonlinearity can be seen" in content["next_experiment"]["why"]
    assert content["holdout"]["updated"] > 0.0
    page = (folder / "results" / "rig" / "report.html").read_text()
    for part in ("FRF magnitude", "95 lines, 6 to 100 Hz", "roughness between neighbouring lines", "P3"):
        assert part in page
    assert "note: h.uff: from one level of FRFs or mode shapes no nonlinearity" in capsys.readouterr().out


def test_frfs_with_too_few_lines_are_refused(folder, capsys):
    write_frfs(read_rig("rig.toml"), folder / "h.uff", frequency=np.arange(6.0, 20.0))
    assert main(["diagnose", "rig.toml", "h.uff"]) == 2
    assert "h.uff: FRFs on 14 lines above 0 Hz" in capsys.readouterr().err
    assert not (folder / "results").exists()


def test_steps_back_go_through_the_models_of_the_diagnosis(folder, loop, capsys):
    diagnose()
    capsys.readouterr()
    assert main(["undo", "results/rig"]) == 0
    assert "model 2 again: calibrated, NRMSE 0.24" in capsys.readouterr().out
    assert read_rig(folder / "results" / "rig" / "rig.updated.toml").effects == ()
    assert main(["history", "results/rig", "--json"]) == 0
    history = json.loads(capsys.readouterr().out)
    assert (history["current"], history["entries"][0]["model"]) == (2, "as given")


def test_the_demo_diagnoses_the_shipped_records_and_keeps_the_loud_one_aside(folder, loop, monkeypatch):
    shipped = folder / "testbed" / "demo"
    (shipped / "records").mkdir(parents=True)
    for name, new in (
        ("rig.toml", "rig.toml"),
        ("sweep.csv", "records/sweep.csv"),
        ("burst.csv", "records/multisine_6.csv"),
    ):
        (shipped / new).write_bytes((folder / name).read_bytes())
    monkeypatch.setattr("testbed.cli.demo.DEMO", shipped)
    assert main(["demo", "--with", "shipped"]) == 0
    assert loop.calls[0][:2] == (["sweep.csv"], ["multisine_6.csv"])
    assert (folder / "results" / "demo" / "report.html").exists()


def test_the_demo_makes_its_records_with_a_simulator_first_and_shows_the_truth(folder, loop, monkeypatch, capsys):
    shipped = folder / "short_demo"
    shipped.mkdir()
    (shipped / "rig.toml").write_bytes((folder / "rig.toml").read_bytes())
    short = 'fs = 512.0\n[excitation]\nkind = "{}"\nhigh = 150.0\n{}\n'
    grease = '\n[[truth.effects]]\nkind = "squeeze_film"\nsleeve = "sleeve 2"\ndamping = 4.0\n'
    multisines = "rms = [3.0, 6.0]\nperiod = 0.25\nperiods = 2" + grease
    (shipped / "multisines.toml").write_text(short.format("multisine", multisines))
    (shipped / "sweep.toml").write_text(short.format("sweep", "duration = 0.5"))
    monkeypatch.setattr("testbed.cli.demo.DEMO", shipped)
    assert main(["demo", "--with", "modal", "--jobs", "1", "--out", "made"]) == 0
    assert loop.calls[0][:2] == (["multisine_3.uff", "sweep_10.uff"], ["multisine_6.uff"])
    assert (folder / "made" / "records" / "modal" / "sweep" / "truth.toml").exists()
    told = capsys.readouterr().out.splitlines()[-1]
    film = "squeeze_film at sleeve 2, damping"
    assert told.startswith(f"hidden: {film} 4 N s/m; found: {film} ")
    assert told.endswith("(truth: made/records/modal/multisines/truth.toml)")


def test_the_demo_refuses_a_simulator_that_there_is_not_before_it_makes_a_record(folder, loop, capsys):
    assert main(["demo", "--with", "ansys"]) == 2
    message = capsys.readouterr().err
    assert message.startswith("--with ansys; ")
    assert "shipped" in message
    assert len(message.splitlines()) == 1


def test_the_demo_with_nothing_hidden_and_nothing_found_says_so():
    assert against_truth({"effects": []}, {"effects": []}) == "hidden: nothing; found: nothing"


@pytest.mark.parametrize(
    ("others", "told"),
    [([], "beside the calibrated rig"), ([{"kind": "mains_hum"}], "beside mains_hum and the calibrated rig")],
)
def test_what_the_first_round_was_judged_beside_is_its_heading(others, told, capsys):
    judged = [{"kind": "squeeze_film", "sleeve": "sleeve 2", "probability": 0.9, "nrmse": 0.01}]
    content = {"error": [], "holdout": {}, "candidates": judged, "candidates_beside": others, "indistinguishable": []}
    proposed = {"do": "rest", "why": "enough"}
    print_diagnosis({**content, "verdict": "complete", "where": {}, "effects": [], "next_experiment": proposed})
    assert told in " ".join(capsys.readouterr().out.split())


def test_a_note_stands_once_and_those_of_the_calibrated_model_stand_apart(capsys):
    told = {
        "findings": ["P1 is odd", "calibrated model: damping drifts"],
        "of_calibrated": ["calibrated model: damping drifts"],
    }
    content = {
        "error": [], "holdout": {}, "candidates": [], "candidates_beside": [], "indistinguishable": [],
        "verdict": "missing_effect",
    }  # fmt: skip
    film = {"kind": "squeeze_film", "sleeve": "sleeve 2", "probability": 0.9, "parameters": {}}
    proposed = {"do": "rest", "why": "enough"}
    print_diagnosis({**content, "where": told, "effects": [film], "next_experiment": proposed})
    lines = capsys.readouterr().out.splitlines()
    assert lines.count("note: P1 is odd") == 1
    head = next(i for i, line in enumerate(lines) if line.startswith("the calibrated model, before the effects"))
    assert lines[head + 1] == "  - damping drifts"
    assert sum("drifts" in line for line in lines) == 1
