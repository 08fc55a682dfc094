"""Reported cases are diagnosed again: which, and what is told of them."""

import json

import pytest
from made_up_cases import failed, made_up

from models.errors import InputError
from testbed.cli.app import main
from testbed.hidden_effects.again import bit_reversed, evenly, run_again
from testbed.hidden_effects.again_page import again_page, again_summary
from testbed.hidden_effects.sets import REPORTED
from testbed.outputs import keep_json

MIX = {"nothing": 10, "two": 4, "outside": 6, "point_mass": 12, "wear": 8}


def kept(folder, cases):
    for case in cases:
        keep_json(folder / "cases" / f"{case['case']}.json", case)


@pytest.mark.parametrize("n", [1, 2, 5, 8, 205])
def test_the_order_holds_each_number_once(n):
    assert sorted(bit_reversed(n)) == list(range(n))


def test_each_beginning_of_the_order_is_spread_over_all():
    for taken in (8, 16, 50):
        begun = sorted(bit_reversed(205)[:taken])
        gaps = [after - before for before, after in zip([0, *begun], [*begun, 204], strict=True)]
        assert max(gaps) <= 2 * 256 / taken


def test_each_beginning_has_the_mix(tmp_path):
    kept(tmp_path, [made_up(kind, number) for kind, count in MIX.items() for number in range(count)])
    order = evenly(tmp_path)
    assert len(order) == sum(MIX.values())
    half = [case["kind"] for case in order[: len(order) // 2]]
    assert {kind: half.count(kind) for kind in MIX} == {
        kind: pytest.approx(count / 2, abs=1.0) for kind, count in MIX.items()
    }


def test_failed_cases_and_those_of_no_seed_are_left_out(tmp_path):
    kept(tmp_path, [made_up("wear", 0), made_up("wear", 1, seed=1), failed("wear", 2)])
    assert [case["number"] for case in evenly(tmp_path)] == [0]


def test_old_batches_are_left_out_where_the_newest_are_enough(tmp_path):
    first, *_, last = REPORTED.batches
    old = [made_up("wear", number, seed=first) for number in range(3)]
    new = [made_up(kind, number, seed=last) for kind in ("nothing", "wear", "two", "outside") for number in range(50)]
    kept(tmp_path, old + new)
    assert {case["seed"] for case in evenly(tmp_path)} == {last}


def test_a_folder_without_cases_is_refused(tmp_path, capsys):
    with pytest.raises(InputError, match=r"no finished case of a set; a folder of .*; name the folder"):
        evenly(tmp_path)
    assert main(["benchmark", "again", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    assert "no finished case" in capsys.readouterr().err


def test_what_was_right_and_is_not_any_more_is_told():
    old = [made_up("wear", 0), made_up("wear", 1, right=False), made_up("nothing", 0)]
    new = [made_up("wear", 0, right=False, named="unexplained"), made_up("wear", 1), failed("nothing", 0)]
    new[0]["seconds"] = {"draw": 1.0, "diagnosis": 40.0, "threads": 2}

    summary = again_summary(old, new)

    assert summary["right"] == {"reported": 2, "again": 1}
    assert summary["seconds"]["median"] == pytest.approx(33.0)
    assert summary["seconds_by_class"]["one effect"] == {"cases": 2, "median": pytest.approx(33.0)}
    page = again_page(summary, "testbed benchmark again")
    assert "Of 3 cases 2 were right when they were reported, 1 are now." in page
    assert "| all | 2 | **33** |" in page
    assert "| `" + old[0]["case"] + "` | right | 25, 2 | **wrong**: unexplained | 40, 2 |" in page
    assert "`" + old[2]["case"] + "` failed: ValueError: nobody knows." in page


def test_cases_are_run_once_and_their_page_is_written(tmp_path):
    reported = [made_up("wear", number) for number in range(3)]
    told = []

    def work(todo, run, threads):
        return ((task, run(task, threads)) for task in todo)

    def again():
        return run_again(
            reported, tmp_path / "out", work, threads=2, command=["testbed"], progress=told.append,
            run=lambda task, _: made_up(task.kind, task.number),
        )  # fmt: skip

    assert again()["right"] == again()["right"] == {"reported": 3, "again": 3}
    assert told[-1] == "3 of 3 cases are there, 0 to do"
    assert json.loads((tmp_path / "out" / "summary.json").read_text())["cases"] == 3
    assert (tmp_path / "out" / "README.md").read_text().startswith("# Reported cases, diagnosed again")


def test_the_command_tells_seconds_by_class_and_what_is_right(tmp_path, capsys):
    reported = [made_up("wear", 0), made_up("nothing", 0)]
    kept(tmp_path / "all", reported)
    kept(tmp_path / "out", reported)
    assert main(["benchmark", "again", str(tmp_path / "all"), "--cases", "2", "--out", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr()
    assert "2 are right; 2 of 2 were when they were reported" in printed.out + printed.err
