import pytest
from made_up_cases import SEED, every_bar_met, failed, made_up

from testbed.hidden_effects.outside import HELD_BY_NONE
from testbed.hidden_effects.page import page_of
from testbed.hidden_effects.scores import (
    CLASSES,
    CORES,
    LOCATED_ANEW,
    beliefs_of,
    calibration,
    in_a_line,
    located,
    seconds,
    seconds_in_first_mix,
    shares_of_engines,
    summary_of,
)
from testbed.hidden_effects.sets import REPORTED

*_, LATER = REPORTED.batches


def bar(summary, name):
    return next(row for row in summary["bars"] if row["name"].startswith(name))


def test_where_every_bar_is_met_none_is_missed():
    summary = summary_of(every_bar_met(), "reported")
    assert summary["missed"] == []
    assert summary["cases"] == 200
    assert summary["one effect"]["right_share"] == 1.0
    assert summary["numbers"]["inside_share"] == pytest.approx(104 / 110)
    assert summary["false_alarms"] == summary["abstentions"] == 0


@pytest.mark.parametrize(
    ("name", "worse"),
    [
        ("right kind and place", lambda c: made_up("point_mass", c["number"], right=c["number"] >= 12)),
        ('"complete"', lambda c: made_up("nothing", c["number"], right=c["number"] >= 3)),
        ('"unexplained"', lambda c: made_up("outside", c["number"], right=c["number"] >= 4)),
        ("both of two", lambda c: made_up("two", c["number"], right=c["number"] >= 6)),
        ("error held out", lambda c: made_up(c["kind"], c["number"], after=1.11)),
        ("the same, 90th", lambda c: made_up(c["kind"], c["number"], after=1.0 if c["number"] % 5 else 1.6)),
        ("numbers inside", lambda c: made_up(c["kind"], c["number"], inside=True)),
        ("numbers inside", lambda c: made_up(c["kind"], c["number"], inside=c["number"] % 8 != 0)),
        (
            "seconds of a diagnosis, median, 2 threads each",
            lambda c: c | {"seconds": {"draw": 1.0, "diagnosis": 61.0, "threads": 2}},
        ),
        ("cases", lambda c: c if c["case"] != f"reported-{SEED}-two-0" else None),
        ("of them with nothing", lambda c: c if c["case"] != f"reported-{SEED}-nothing-0" else None),
    ],
)
def test_each_bar_can_be_missed(name, worse):
    kinds = {
        '"complete"': "nothing",
        '"unexplained"': "outside",
        "both of two": "two",
        "right kind and place": "point_mass",
    }
    cases = [worse(c) if kinds.get(name, c["kind"]) == c["kind"] else c for c in every_bar_met()]
    summary = summary_of([case for case in cases if case is not None], "reported")
    assert any(missed.startswith(name) for missed in summary["missed"]), summary["missed"]
    assert bar(summary, name)["met"] is False


def test_what_the_library_does_not_hold_does_not_count_among_the_errors_held_out():
    cases = [made_up("point_mass", 0, after=1.02), made_up("outside", 0, after=20.0)]
    assert bar(summary_of(cases, "reported"), "error held out")["value"] == pytest.approx(1.02)


def test_a_case_that_failed_is_not_right_and_stands_among_the_missed():
    summary = summary_of([made_up("point_mass", 0), failed("point_mass", 1)], "reported")
    assert summary["one effect"]["right_share"] == 0.5
    assert summary["one effect"]["failed"] == 1
    assert [miss["case"] for miss in summary["misses"]] == [f"reported-{SEED}-point_mass-1"]


def test_false_alarms_abstentions_and_silent_misses_are_told_apart():
    cases = [
        made_up("nothing", 0, right=False, named="wear"),
        made_up("point_mass", 0, right=False),
        made_up("outside", 0),
        made_up("nothing", 1, right=False),
    ]
    cases[-1]["judged"]["verdict"] = cases[-1]["judged"]["named"] = "unexplained"
    silent = made_up("point_mass", 1, right=False)
    silent["judged"]["verdict"] = silent["judged"]["named"] = "complete"
    summary = summary_of([*cases, silent], "reported")
    assert (summary["false_alarms"], summary["abstentions"], summary["missed_silently"]) == (1, 1, 1)
    assert summary["nothing_unexplained"] == 1
    assert summary["confusion"] == {
        "nothing": {"wear": 1, "unexplained": 1},
        "outside": {"unexplained": 1},
        "point_mass": {"unexplained": 1, "complete": 1},
    }


def named_wrongly(kind, number, probability):
    """A case in which an effect is named that is not there."""
    case = made_up(kind, number, right=False, named="wear")
    case["judged"] |= {"verdict": "missing_effect", "probability": probability}
    return case


def test_belief_is_held_against_how_often_it_is_right():
    cases = [made_up("point_mass", n) for n in range(4)] + [named_wrongly("point_mass", 9, 0.6)]
    rows = summary_of(cases, "reported")["calibration_before"]
    assert [(row["believed"], row["right"], row["cases"]) for row in rows] == [(0.6, 0, 1), (pytest.approx(0.97), 4, 4)]


def test_false_alarms_and_imitations_count_against_the_belief():
    cases = [made_up("point_mass", 0), named_wrongly("outside", 0, 0.96), named_wrongly("nothing", 0, 0.98)]
    (row,) = summary_of(cases, "reported")["calibration_before"]
    assert (row["believed"], row["right"], row["cases"]) == (pytest.approx(0.97), 1, 3)


def test_what_kept_nothing_for_the_unjudged_is_told_apart():
    summary = summary_of([made_up("point_mass", 0), made_up("point_mass", 0, seed=LATER)], "reported")

    assert [[row["cases"] for row in rows] for rows in beliefs_of(summary).values()] == [[1], [1]]
    assert summary["calibration"] == calibration([made_up("point_mass", 0, seed=LATER)])


def test_only_places_that_were_free_count_among_the_errors_of_the_place():
    hit = made_up("squeeze_film", 0, hidden=[{"kind": "squeeze_film", "sleeve": "sleeve 1"}])
    turned = made_up("sensor_position", 0, hidden=[{"kind": "sensor_position", "sensor": "P1", "position": 0.4}])
    free = made_up("point_mass", 0, hidden=[{"kind": "point_mass", "position": 0.4}])

    assert summary_of([hit, turned, free], "reported")["place_errors"] == [0.01]


def test_an_effect_too_many_is_counted_though_the_first_is_right():
    besides = made_up("point_mass", 0)
    besides["judged"]["n_found"] = 2

    assert summary_of([besides, made_up("point_mass", 1)], "reported")["named_besides"] == 1


def test_right_cases_far_from_the_noise_are_told_the_farthest_first():
    cases = [made_up("point_mass", n, after=after) for n, after in enumerate((1.2, 1.5, 5.0))]
    cases += [made_up("outside", 0, after=9.0), made_up("point_mass", 9, right=False, after=9.0)]
    summary = summary_of(cases, "reported")

    assert [row["after"] for row in summary["farthest"]] == [5.0, 1.5]
    page = page_of(summary, {}, "testbed")
    assert "## Right, but far from the noise" in page


@pytest.mark.parametrize(("place_error", "there"), [(None, 1), (0.01, 1), (0.3, 0)])
def test_of_two_effects_the_first_has_to_be_there(place_error, there):
    case = made_up("two", 0, right=False)
    case["judged"] |= {"verdict": "missing_effect", "probability": 1.0, "kind_right": True, "place_error": place_error}
    (row,) = summary_of([case], "reported")["calibration_before"]
    assert (row["right"], row["cases"]) == (there, 1)


def test_numbers_of_the_rig_count_where_the_diagnosis_is_right():
    told = [made_up("point_mass", n, right=n < 2, rig_numbers=[{"inside": n == 0}]) for n in range(3)]
    outside = made_up("outside", 0, rig_numbers=[{"inside": True}])
    summary = summary_of([*told, outside, made_up("point_mass", 9)], "reported")  # the last batch did not tell it

    assert summary["rig_numbers"] == {"cases": 2, "count": 2, "inside": 1}
    assert "inside their intervals of 95 %\n1 of 2, in 2 cases." in page_of(summary, {}, "testbed")


def test_without_a_case_no_bar_is_missed_but_those_that_count_cases():
    assert summary_of([], "tuning")["missed"] == ["cases", "of them with nothing hidden"]


def test_seconds_are_those_on_the_cores_that_the_bar_means():
    cases = [{"seconds": {"draw": 1.0, "diagnosis": s, "threads": n}} for s, n in ((90.0, 1), (80.0, 1), (40.0, 2))]

    assert seconds(cases)["median"] == 40.0
    assert seconds(cases)["others"] == {"cases": 2, "median": 85.0, "threads": [1]}
    assert seconds(cases[:2])["median"] == 85.0


def test_seconds_in_the_first_mix_count_each_class_at_its_share():
    def taking(kind, number, diagnosis, threads=CORES):
        return made_up(kind, number) | {"seconds": {"draw": 1.0, "diagnosis": diagnosis, "threads": threads}}

    outside = [taking("outside", n, 300.0 + n) for n in range(20)]
    others = [taking("nothing", 0, 10.0), taking("wear", 0, 50.0), taking("wear", 1, 60.0), taking("two", 0, 200.0)]
    cases = [*outside, *others, taking("wear", 2, 1.0, threads=1)]

    # A quarter takes 10 s, 27.5 % each 50 and 60: half of all is below 50 s, whatever those outside take.
    assert seconds_in_first_mix(cases, CORES) == 50.0
    assert seconds(cases)["median"] > 300.0
    assert seconds_in_first_mix([], CORES) is None
    told = page_of(summary_of(cases, "reported"), {}, "testbed")
    assert f"With each class at its share of the first batches, on {CORES} threads each: 50 s" in told


def test_progress_says_case_engine_result_and_seconds():
    assert in_a_line(made_up("point_mass", 3, engine="mujoco")) == f"reported-{SEED}-point_mass-3 (mujoco): right, 28 s"
    assert (
        in_a_line(made_up("nothing", 1, right=False, named="wear"))
        == f"reported-{SEED}-nothing-1 (fine): WRONG, wear, 26 s"
    )
    assert in_a_line(failed("two", 1)) == f"reported-{SEED}-two-1: ValueError: nobody knows"


def test_a_share_of_few_cases_lies_in_a_wide_interval():
    every_one = bar(summary_of([made_up("nothing", n) for n in range(3)], "reported"), '"complete"')
    assert every_one["interval"] == (pytest.approx(0.025 ** (1 / 3)), 1.0)  # all of three, were the share that low
    assert bar(summary_of(every_bar_met(), "reported"), '"complete"')["interval"][0] > 0.9


def test_only_shares_of_cases_that_are_there_have_an_interval():
    summary = summary_of([made_up("nothing", 0)], "reported")
    assert bar(summary, "seconds")["interval"] is None
    assert bar(summary, "both of two")["interval"] is None


def test_what_is_left_is_held_against_what_is_there_by_batch():
    cases = [made_up("point_mass", n) for n in range(3)] + [named_wrongly("point_mass", 9, 0.97)]
    cases += [made_up("point_mass", 0, seed=LATER, left=1.2), made_up("nothing", 0, seed=LATER)]

    rows = summary_of(cases, "reported")["by_what_is_left"]

    counts = {(row["taught"], row["met"]): (row["right"], row["cases"]) for row in rows}
    assert counts == {(True, True): (3, 4), (True, False): (0, 0), (False, True): (0, 0), (False, False): (1, 1)}
    assert [row["believed"] for row in rows] == [pytest.approx(0.97), None, None, pytest.approx(0.97)]


@pytest.mark.parametrize(
    ("threads", "key", "words"), [(1, "seconds_alone", "1 thread each"), (2, "seconds_on_cores", "2 threads each")]
)
def test_what_the_newest_take_is_told_by_class_and_threads(threads, key, words):
    taken, other = ({"draw": 30.0, "diagnosis": 50.0 * n, "threads": n} for n in (threads, 3 - threads))
    cases = [made_up("point_mass", 0, seconds=taken), made_up("nothing", 0, seconds=other), failed("two", 0)]
    summary = summary_of(cases, "reported")

    rows = summary["newest"][key]
    assert rows["one effect"] == {"cases": 1, "median": 50.0 * threads}
    assert {name for name, row in rows.items() if row["median"] is None} == {*CLASSES.values()}
    page = " ".join(page_of(summary, {}, "testbed").split())
    assert f"on {words}, in the median: {50 * threads} s (one effect, 1 cases)." in page


def test_the_shares_of_the_engines_are_of_what_all_can_carry():
    cases = [made_up("point_mass", n, engine=engine) for n, engine in enumerate(("fine", "mujoco", "exudyn", "fine"))]
    cases.append(made_up("local_damage", 0, hidden=[{"kind": "local_damage", "position": 0.5}]))

    assert shares_of_engines(cases) == {"fine": 2, "mujoco": 1, "exudyn": 1}


def test_right_of_all_is_told_by_kind_and_engine():
    cases = [
        made_up("point_mass", n, engine=engine, right=n != 1) for n, engine in enumerate(("fine", "fine", "exudyn"))
    ]
    cases += [made_up("outside", 0, engine="mujoco"), made_up("nothing", 0), failed("point_mass", 3)]

    summary = summary_of(cases, "reported")

    assert summary["by_engine"] == {
        "point_mass": {"fine": {"right": 1, "cases": 2}, "exudyn": {"right": 1, "cases": 1}},
        "one_sided_stop": {"mujoco": {"right": 1, "cases": 1}},
    }
    page = page_of(summary, {}, "testbed")
    assert "| `point_mass` | 1 of 2 | 1 of 1 |  |" in page
    assert "| `one_sided_stop` |  |  | 1 of 1 |" in page


def test_an_effect_that_was_added_beside_another_is_believed_and_there_or_not():
    hidden = [{"kind": "point_mass", "position": 0.5}, {"kind": "sensor_gain", "sensor": "P1"}]
    both, one = (made_up("two", n, seed=LATER, hidden=hidden, right=n == 0, named="point_mass") for n in range(2))
    first = {"kind": "point_mass", "position": 0.52, "probability": 0.97}
    for case, sensor in ((both, "P1"), (one, "P2")):
        case["judged"]["verdict"] = "missing_effect"
        case["diagnosis"]["effects"] = [first, {"kind": "sensor_gain", "sensor": sensor, "probability": 0.9}]

    *taught, met, beyond = summary_of([both, one, made_up("nothing", 0)], "reported")["added_later"]

    assert met == {"taught": False, "met": True, "believed": pytest.approx(0.9), "right": 1, "cases": 2}
    assert beyond == {"taught": False, "met": False, "believed": None, "right": 0, "cases": 0}
    assert [row["cases"] for row in taught] == [0, 0]


def test_of_a_law_outside_the_library_nothing_that_was_added_is_there():
    case = made_up("outside", 0, seed=LATER, right=False)
    name = {"kind": "one_sided_stop", "position": 0.5, "probability": 0.97}
    case["diagnosis"]["effects"] = [name, name]

    *_, met, _ = summary_of([case], "reported")["added_later"]

    assert (met["right"], met["cases"]) == (0, 1)


def test_laws_outside_the_library_count_alike_however_often_they_are_drawn():
    def law(kind, number, *, right):
        return made_up("outside", number, right=right, hidden=[{"kind": kind, "position": 0.5}])

    cases = [law("one_sided_stop", n, right=True) for n in range(3)] + [law("relaxing_spring", 9, right=False)]
    summary = summary_of(cases, "reported")

    assert (summary["laws_alike"]["laws"], summary["laws_alike"]["share"]) == (2, 0.5)
    assert "Each of the 2 laws outside the library counted alike, 50.0% are" in page_of(summary, {}, "testbed")


def test_laws_that_nothing_more_general_holds_are_told_apart():
    def law(kind, number, *, right):
        return made_up("outside", number, right=right, hidden=[{"kind": kind, "position": 0.5}])

    cases = [law(one.kind, n, right=n > 0) for n, one in enumerate(HELD_BY_NONE)]
    summary = summary_of([*cases, law("relaxing_spring", 9, right=False)], "reported")

    n = len(HELD_BY_NONE)
    assert summary["laws_alike"]["held_by_none"] == {"right": n - 1, "cases": n}
    told = f"Of those that no more general law holds either, {n - 1} of {n} are."
    assert told in page_of(summary, {}, "testbed")


def test_kinds_count_alike_however_often_they_are_drawn():
    cases = [made_up("clearance", n, right=False) for n in range(3)] + [made_up("point_mass", 0)]
    summary = summary_of(cases, "reported")

    assert summary["kinds_alike"] == {"kinds": 2, "right": 0.5, "in_group": 0.5}
    assert summary["newest"]["kinds_alike"] == summary["kinds_alike"]
    assert "Each of the 2 kinds counted alike, 50.0% of single effects are right" in page_of(summary, {}, "testbed")


def test_the_page_says_how_large_errors_have_come_out():
    cases = [made_up("point_mass", n, ratio=ratio) for n, ratio in enumerate((1.5, 8.0, 40.0))]
    summary = summary_of([*cases, made_up("nothing", 0, ratio=1.0)], "reported")

    assert summary["shown"] == {"cases": 3, "span": [1.5, 40.0], "few": 1, "most": 1}
    assert "are 1.5 to 40 times the noise: 1 of the" in page_of(summary, {}, "testbed")


def test_a_located_force_is_near_and_inside_or_elsewhere():
    cases = [made_up("point_mass", n, place=place) for n, place in enumerate((0.51, 0.54, 0.8))]
    cases.append(made_up("point_mass", 3))
    cases[2]["diagnosis"]["where"]["place"]["position"] = None  # in a channel

    assert located(cases) == {"cases": 3, "told": 2, "near": 2, "inside": 1}


def test_contradictions_of_the_calibrated_numbers_are_counted_where_they_were_told():
    quiet, loud, silent, failed = (made_up("nothing", n) for n in range(4))
    quiet["diagnosis"]["where"]["of_calibrated"], loud["diagnosis"]["where"]["of_calibrated"] = [], ["a drift"]
    del failed["diagnosis"], failed["judged"]
    failed["failure"] = "lost"

    summary = summary_of([quiet, loud, silent, failed], "reported")

    assert summary["contradicted"]["nothing hidden"] == {"cases": 2, "found": 1}
    assert "1 of 2 cases (nothing hidden)." in page_of(summary, {}, "testbed")
    assert "speaks against" not in page_of(summary_of([silent], "reported"), {}, "testbed")


def test_places_are_counted_apart_since_their_intervals_hold_what_explains_as_much():
    cases = [made_up("point_mass", 0, place=0.8), made_up("point_mass", 0, place=0.51, seed=LOCATED_ANEW)]

    summary = summary_of(cases, "reported")

    assert (summary["located"]["told"], summary["located_since"]["told"]) == (2, 1)
    assert "told in 1 of 1 cases, that near in 1 of them, and the\ninterval held it in 1." in page_of(
        summary, {}, "testbed"
    )


def test_an_effect_at_a_sleeve_is_where_the_sleeve_is():
    case = made_up("wear", 0, place=0.3)
    case["hidden"] = [{"kind": "wear", "sleeve": "sleeve 1"}]

    assert located([case]) == {"cases": 1, "told": 1, "near": 1, "inside": 1}
    case["hidden"] = [{"kind": "sensor_position", "sensor": "P1", "position": 0.3}]
    assert located([case])["cases"] == 0


def test_a_right_case_is_in_no_group_of_its_own():
    (far,) = summary_of([made_up("point_mass", 0, after=9.0)], "reported")["farthest"]

    assert not far["in_group"]
