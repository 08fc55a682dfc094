"""The command over files: what is there is kept, what failed is tried again, and the exit status tells."""

import json
from multiprocessing import get_context
from signal import SIGKILL
from time import monotonic, sleep

import pytest
from made_up_cases import SEED, failed, made_up

from models.errors import InputError
from testbed.cli.app import main
from testbed.hidden_effects.plan import planned
from testbed.hidden_effects.run import run_hidden_effects
from testbed.hidden_effects.sets import REPORTED
from testbed.outputs import keep_json

TASKS = planned("reported", 6, ["nothing", "point_mass"])


def quick(task, threads):
    return made_up(task.kind, task.number, seed=task.seed, right=task.number != 1)


def one_after_the_other(tasks, run, threads):
    return ((task, run(task, threads)) for task in tasks)


def run(out, workers=one_after_the_other, run_case=quick, tasks=TASKS):
    told = []
    command = ["testbed", "benchmark", "hidden-effects"]
    summary = run_hidden_effects(tasks, out, workers, threads=1, command=command, progress=told.append, run=run_case)
    return summary, told


def test_every_case_has_its_file_and_the_page_its_figures(tmp_path):
    summary, told = run(tmp_path)
    assert {file.stem for file in (tmp_path / "cases").iterdir()} == {task.name for task in TASKS}
    assert summary["cases"] == len(TASKS)
    assert told[0] == "0 of 6 cases are there, 6 to do"
    assert told[1].startswith(f"1/6 {TASKS[0].name} (fine): right")
    page = (tmp_path / "README.md").read_text()
    for name in ("confusion", "held_out", "seconds"):
        assert f"figures/{name}.png" in page
        assert (tmp_path / "figures" / f"{name}.png").exists()
    assert f"`reported-{SEED}-nothing-1`" in page
    assert json.loads((tmp_path / "summary.json").read_text())["missed"]


def two_then_never(task, threads):
    """As quick as the others for two cases, and then at it for good."""
    if task in TASKS[2:]:
        sleep(600.0)
    return quick(task, threads)


def run_for_good(out):
    run(out, run_case=two_then_never)


def test_a_run_that_was_killed_goes_on_without_losing_a_finished_case(tmp_path):
    process = get_context("spawn").Process(target=run_for_good, args=(tmp_path,))
    process.start()
    until = monotonic() + 60.0
    while len(list((tmp_path / "cases").glob("*.json"))) < 2 and monotonic() < until:
        sleep(0.05)
    process.kill()
    process.join()
    assert process.exitcode == -SIGKILL
    kept = {file: file.read_bytes() for file in (tmp_path / "cases").iterdir()}
    assert {file.name for file in kept} == {f"{task.name}.json" for task in TASKS[:2]}
    again = []

    def counting(task, threads):
        again.append(task)
        return quick(task, threads)

    summary, told = run(tmp_path, run_case=counting)
    assert again == list(TASKS[2:])
    assert told[0] == "2 of 6 cases are there, 4 to do"
    assert summary["cases"] == 6
    assert all(file.read_bytes() == content for file, content in kept.items())


def test_other_batches_count_and_other_seeds_do_not(tmp_path):
    *_, last = REPORTED.batches
    for seed in (last, 1):
        case = made_up("nothing", 0, seed=seed)
        keep_json(tmp_path / "cases" / f"{case['case']}.json", case)
    summary, told = run(tmp_path)
    assert told[0] == "0 of 6 cases are there, 6 to do"
    assert summary["cases"] == 7
    assert summary["batches"][str(last)]["classes"]["nothing hidden"] == {"right": 1, "cases": 1}
    page = (tmp_path / "README.md").read_text()
    assert f"| {last} | {REPORTED.batches[last].diagnosis} | 1 | 0 of 0 | 1 of 1 |" in page
    assert REPORTED.batches[SEED].taught in page
    assert "## The newest batches" not in page  # they are all there are


def test_how_a_batch_was_run_is_told_where_it_must_be_known(tmp_path):
    *others, (told_of, batch) = [(seed, batch) for seed, batch in REPORTED.batches.items() if batch.run]
    case = made_up("nothing", 0, seed=told_of)
    keep_json(tmp_path / "cases" / f"{case['case']}.json", case)
    run(tmp_path)
    page = (tmp_path / "README.md").read_text()
    assert f"- Seed {told_of}: {batch.run}" in page
    assert not any(other.run in page for _, other in others)


def test_a_case_that_failed_is_kept_and_tried_again(tmp_path):
    summary, _ = run(tmp_path, run_case=lambda task, threads: failed(task.kind, task.number))
    assert len(summary["failed"]) == 6
    summary, told = run(tmp_path)
    assert told[0] == "0 of 6 cases are there, 6 to do"
    assert summary["failed"] == []


def test_an_explanation_stands_beside_its_case(tmp_path):
    run(tmp_path)
    assert "Not explained yet." in (tmp_path / "README.md").read_text()
    (tmp_path / "explanations.toml").write_text(f'reported-{SEED}-nothing-1 = "The seed was unlucky."\n')
    run(tmp_path)
    page = (tmp_path / "README.md").read_text()
    line = next(line for line in page.splitlines() if line.startswith(f"- `reported-{SEED}-nothing-1`"))
    assert line.endswith("*The seed was unlucky.*")
    assert (tmp_path / "explanations.toml").exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"reported-{SEED}-nothing-1 = ", "explanations.toml: .*; lines like"),
        ("a = 3", "a = 3; an explanation is a text; write"),
    ],
)
def test_explanations_that_are_none_are_refused(tmp_path, text, message):
    (tmp_path / "explanations.toml").write_text(text)
    with pytest.raises(InputError, match=message):
        run(tmp_path)


def test_the_command_prints_the_bars_and_its_status_tells_whether_all_were_met(tmp_path, monkeypatch, capsys):
    words = ["benchmark", "hidden-effects", "--out", str(tmp_path), "--cases", "200"]
    monkeypatch.setattr("testbed.hidden_effects.crew.on_this_machine", lambda jobs: one_after_the_other)
    for n, task in enumerate(planned("reported", 200)):
        case = made_up(task.kind, task.number, seed=task.seed, inside=n % 20 != 1)
        keep_json(tmp_path / "cases" / f"{task.name}.json", case)
    assert main(words) == 0
    assert "both of two effects found" in capsys.readouterr().out
    for number in range(6):
        keep_json(tmp_path / "cases" / f"reported-{SEED}-two-{number}.json", made_up("two", number, right=False))
    assert main([*words, "--json"]) == 1
    assert "both of two effects found" in json.loads(capsys.readouterr().out)["missed"]


def test_the_command_refuses_an_unknown_kind(capsys, tmp_path):
    assert main(["benchmark", "hidden-effects", "--only", "wer", "--out", str(tmp_path)]) == 2
    assert "did you mean" in capsys.readouterr().err
