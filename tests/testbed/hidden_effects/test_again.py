"""Reported cases are diagnosed again: which, and what is told of them."""

import json

import pytest
from made_up_cases import failed, made_up

from models.errors import InputError
from testbed.cli.app import main
from testbed.hidden_effects.again import bit_reversed, evenly, run_again, stamp
from testbed.hidden_effects.again_page import again_page, again_summary, is_same
from testbed.hidden_effects.sets import REPORTED
from testbed.outputs import keep_json

MIX = {"nothing": 20, "two": 8, "outside": 12, "point_mass": 24, "wear": 16}
CLOSED = [seed for seed, batch in REPORTED.batches.items() if batch.cases is not None]


def kept(folder, cases):
    for case in cases:
        keep_json(folder / "cases" / f"{case['case']}.json", case)


def stamped(kind, number, **more):
    return made_up(kind, number, stamp=stamp(), **more)


@pytest.mark.parametrize("n", [0, 1, 2, 5, 8, 205])
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
    for taken in (10, 20, 40, 60):
        begun = [case["kind"] for case in order[:taken]]
        for kind, count in MIX.items():
            assert begun.count(kind) == pytest.approx(count * taken / len(order), abs=1.5)


def test_failed_cases_and_those_of_no_seed_are_left_out(tmp_path):
    kept(tmp_path, [made_up("wear", 0), made_up("wear", 1, seed=1), failed("wear", 2)])
    assert [case["number"] for case in evenly(tmp_path)] == [0]


def test_old_batches_are_left_out_where_the_newest_are_enough(tmp_path):
    old = [made_up("wear", number, seed=CLOSED[0]) for number in range(3)]
    new = [
        made_up(kind, number, seed=CLOSED[-1]) for kind in ("nothing", "wear", "two", "outside") for number in range(50)
    ]
    kept(tmp_path, old + new)
    assert {case["seed"] for case in evenly(tmp_path)} == {CLOSED[-1]}


def test_an_open_batch_which_grows_does_not_move_the_order(tmp_path, monkeypatch):
    first, last = list(REPORTED.batches)[-2:]
    for seed, cases in ((first, 5), (last, None)):
        monkeypatch.setitem(REPORTED.batches, seed, type(REPORTED.batches[seed])("any", cases=cases))
    kept(tmp_path, [made_up("wear", number, seed=first) for number in range(5)])
    before = evenly(tmp_path)
    kept(tmp_path, [made_up("nothing", number, seed=last) for number in range(3)])
    assert evenly(tmp_path) == before


def test_a_folder_without_cases_or_of_two_sets_is_refused(tmp_path, capsys):
    with pytest.raises(InputError, match=r"0 finished cases, none of a batch that counts; a folder of .*; name the"):
        evenly(tmp_path)
    assert main(["benchmark", "again", str(tmp_path), "--out", str(tmp_path / "out")]) == 2
    assert "none of a batch that counts" in capsys.readouterr().err
    kept(tmp_path, [made_up("wear", 0), made_up("wear", 1) | {"set": "tuning", "seed": tuning_seed(), "case": "t"}])
    with pytest.raises(InputError, match=r"cases of the sets reported and tuning; cases of one set; keep each set"):
        evenly(tmp_path)


def tuning_seed():
    from testbed.hidden_effects.sets import SETS

    return next(iter(SETS["tuning"].batches))


def test_what_was_right_and_is_not_any_more_is_told_by_name():
    old = [made_up("wear", 0), made_up("wear", 1, right=False), made_up("nothing", 0), made_up("wear", 2)]
    new = [stamped("wear", 0, right=False, named="unexplained"), stamped("wear", 1), failed("nothing", 0)]
    new.append(stamped("wear", 2))
    new[0]["seconds"] = {"draw": 1.0, "diagnosis": 40.0, "threads": 2}

    summary = again_summary(old, new)

    lost, mended, broken, same = (case["case"] for case in old)
    assert (summary["lost"], summary["mended"], summary["kept"], summary["missed"]) == ([lost], [mended], [same], [])
    assert summary["seconds"]["median"] == pytest.approx(27.0)
    assert summary["seconds_by_class"]["one effect"] == {"cases": 3, "median": pytest.approx(27.0)}
    page = again_page(summary, "testbed benchmark again")
    assert f"Of 2 that were right when they were reported 1 still are: `{lost}` not any more." in page
    assert f"Of 1 that were not 1 are right now: `{mended}`." in page
    assert "| all | 3 | **27** |" in page
    assert f"| `{lost}` | right | 25, 2 | **wrong**: unexplained | 40, 2 |" in page
    assert f"`{broken}` failed: ValueError: nobody knows." in page
    assert f"stamp of the code: {stamp()}" in page


@pytest.mark.parametrize(
    ("changed", "counts"),
    [
        ({"hidden": [{"kind": "wear", "position": 0.6}]}, False),
        ({"engine": "mujoco"}, False),
        ({"hidden": [{"kind": "wear", "position": 0.5001}]}, True),
    ],
    ids=["elsewhere", "another engine", "the last digits"],
)
def test_a_case_that_is_drawn_otherwise_is_told_and_not_counted(changed, counts):
    old, new = made_up("wear", 0), stamped("wear", 0)
    old["hidden"] = [{"kind": "wear", "position": 0.5}]
    new |= {"hidden": old["hidden"]} | changed
    summary = again_summary([old], [new])
    assert summary["kept"] == ([new["case"]] if counts else [])
    assert summary["drawn_otherwise"] == ([] if counts else [new["case"]])
    told = f"Drawn otherwise than they were reported, and not counted: `{new['case']}`."
    assert (told in again_page(summary, "testbed")) is not counts


def test_plain_values_are_the_same_but_for_last_digits():
    assert is_same({"a": [1.0, "x", None]}, {"a": [1.0005, "x", None]})
    assert not is_same({"a": [1.0]}, {"a": [1.1]})
    assert not is_same({"a": [1.0]}, {"b": [1.0]})
    assert not is_same([1.0], [1.0, 2.0])
    assert not is_same("fine", None)


def test_each_case_is_run_once_but_for_one_that_failed(tmp_path):
    reported = [made_up("wear", number) for number in range(3)]
    told, asked = [], []

    def work(todo, run, threads):
        return ((task, run(task, threads)) for task in todo)

    def run(task, threads):
        asked.append((task.number, threads))
        if task.number == 2 and len(asked) == 3:
            return failed("wear", 2)
        return stamped("wear", task.number, right=task.number != 1)

    def again():
        return run_again(
            reported, tmp_path / "all", tmp_path / "out", work,
            threads=2, command=["testbed"], progress=told.append, run=run,
        )  # fmt: skip

    first, second = again(), again()
    assert asked == [(0, 2), (1, 2), (2, 2), (2, 2)]
    assert len(first["failed"]) == 1
    assert (len(second["kept"]), len(second["lost"]), second["failed"]) == (2, 1, [])
    assert "2 of 3 cases are there, 1 to do" in told
    assert json.loads((tmp_path / "out" / "summary.json").read_text()) == second
    assert (tmp_path / "out" / "README.md").read_text().startswith("# Reported cases, diagnosed again")


@pytest.mark.parametrize(
    "there",
    [made_up("wear", 0), made_up("wear", 0, stamp="another"), {"case": "of another benchmark", "seconds": 3.0}],
    ids=["no stamp", "another diagnosis", "another benchmark"],
)
def test_one_folder_holds_one_diagnosis(tmp_path, there):
    kept(tmp_path / "out", [there])
    with pytest.raises(InputError, match=r"another diagnosis, or one .*; in one folder cases of one .*; name another"):
        run_again([made_up("wear", 0)], tmp_path, tmp_path / "out", None, threads=2, command=[], progress=print)


def test_one_folder_holds_diagnoses_on_one_number_of_threads(tmp_path):
    kept(tmp_path / "out", [stamped("wear", 0)])
    with pytest.raises(InputError, match=r"today's, on 1 thread each"):
        run_again([made_up("wear", 0)], tmp_path, tmp_path / "out", None, threads=1, command=[], progress=print)


def test_the_folder_of_the_reported_cases_is_refused(tmp_path, capsys):
    kept(tmp_path, [made_up("wear", 0)])
    assert main(["benchmark", "again", str(tmp_path), "--out", str(tmp_path)]) == 2
    assert "the folder of the reported cases" in capsys.readouterr().err
    assert not (tmp_path / "README.md").exists()


@pytest.mark.parametrize(("right", "status"), [(True, 0), (False, 1)])
def test_the_command_tells_seconds_by_class_and_what_is_lost(tmp_path, capsys, right, status):
    kept(tmp_path / "all", [made_up("wear", 0), made_up("nothing", 0)])
    kept(tmp_path / "out", [stamped("wear", 0, right=right), stamped("nothing", 0)])
    asked = ["benchmark", "again", str(tmp_path / "all"), "--threads", "2", "--out", str(tmp_path / "out")]
    assert main(asked) == status
    printed = capsys.readouterr()
    still = "2 still are." if right else "1 still are:"
    assert f"Of 2 that were right when they were reported {still}" in " ".join((printed.out + printed.err).split())
    assert main([*asked, "--json"]) == status
    assert json.loads(capsys.readouterr().out)["cases"] == 2
