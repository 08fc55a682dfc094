import pytest

from identification.result import Estimate
from testbed.hidden_effects.judge import judged, rig_numbers

SLEEVES, LENGTH = {"sleeve 1": 0.45, "sleeve 2": 1.0}, 1.469
FILM = {"kind": "squeeze_film", "sleeve": "sleeve 2", "parameters": {}}


def dashpot(position, **parameters):
    return {"kind": "point_damping", "position": position, "parameters": parameters}


def diagnosis(*effects, verdict="missing_effect", groups=()):
    return {"verdict": verdict, "effects": list(effects), "indistinguishable": [list(group) for group in groups]}


def scored(found, *truth, kind="one kind"):
    return judged(found, kind, truth, SLEEVES, LENGTH)


SLEEVE_AND_POSITION = (
    {"kind": "coulomb_friction", "position": 1.02, "parameters": {}},
    {"kind": "coulomb_friction", "sleeve": "sleeve 2"},
)


@pytest.mark.parametrize(
    ("found", "truth", "right", "in_group", "kind_right"),
    [
        (diagnosis(FILM), FILM, True, True, True),
        (diagnosis(dashpot(0.80)), dashpot(0.87), True, True, True),  # 4.8 % of the length
        (diagnosis(dashpot(0.80)), dashpot(0.88), False, False, True),  # 5.4 %
        (diagnosis(FILM | {"sleeve": "sleeve 1"}), FILM, False, False, True),
        (diagnosis(dashpot(1.0), FILM), FILM, False, False, False),  # the first one counts
        (diagnosis(dashpot(0.8), groups=[[dashpot(0.8), dashpot(1.2)]]), dashpot(1.2), False, True, True),
        (diagnosis(dashpot(0.8), groups=[[dashpot(0.6), dashpot(1.2)]]), dashpot(1.2), False, False, True),
        (diagnosis(dashpot(1.0), groups=[[dashpot(1.0), FILM]]), FILM, False, True, False),
        (diagnosis(dashpot(1.0), groups=[[dashpot(1.0), FILM, dashpot(0.1), dashpot(0.3)]]), FILM, False, False, False),
        (diagnosis(verdict="complete"), FILM, False, False, False),
        (diagnosis(verdict="unexplained"), FILM, False, False, False),
        (diagnosis(SLEEVE_AND_POSITION[0]), SLEEVE_AND_POSITION[1], True, True, True),
        (
            diagnosis({"kind": "sensor_gain", "sensor": "P3", "parameters": {}}),
            {"kind": "sensor_gain", "sensor": "P4"},
            False,
            False,
            True,
        ),
        (diagnosis({"kind": "force_gain", "parameters": {}}), {"kind": "force_gain"}, True, True, True),
    ],
)
def test_what_counts_as_right_with_one_effect(found, truth, right, in_group, kind_right):
    score = scored(found, truth)
    assert (score["right"], score["in_group"], score["kind_right"]) == (right, in_group, kind_right)


@pytest.mark.parametrize(
    ("verdict", "kind", "right"),
    [
        ("complete", "nothing", True),
        ("missing_effect", "nothing", False),
        ("unexplained", "nothing", False),
        ("unexplained", "outside", True),
        ("missing_effect", "outside", False),
        ("complete", "outside", False),
    ],
)
def test_nothing_and_what_is_outside_the_library_are_judged_by_the_verdict(verdict, kind, right):
    truth = [{"kind": "one_sided_stop", "position": 0.5}] if kind == "outside" else []
    found = diagnosis(*([FILM] if verdict == "missing_effect" else []), verdict=verdict)
    assert scored(found, *truth, kind=kind)["right"] == right


def test_two_effects_are_found_in_any_order_and_each_once():
    far = dashpot(0.3)
    assert scored(diagnosis(far, FILM), FILM, dashpot(0.31), kind="two")["right"]
    assert not scored(diagnosis(far), FILM, dashpot(0.31), kind="two")["right"]
    assert not scored(diagnosis(far, FILM), dashpot(0.29), dashpot(0.31), kind="two")["right"]
    assert not scored(diagnosis(far, FILM, verdict="unexplained"), FILM, far, kind="two")["right"]


def test_the_place_error_is_a_share_of_the_length_and_known_where_the_kind_is_right():
    assert scored(diagnosis(dashpot(0.8)), dashpot(1.1469))["place_error"] == pytest.approx(0.3469 / LENGTH)
    assert scored(diagnosis(FILM), FILM)["place_error"] == 0.0
    assert scored(diagnosis(dashpot(0.8)), FILM)["place_error"] is None


def test_a_number_is_inside_its_interval_up_to_1_96_deviations():
    found = dashpot(0.8, damping={"value": 10.0, "std": 1.0, "unit": "N s/m"})
    for true, inside in ((11.9, True), (12.0, False), (8.1, True)):
        (row,) = scored(diagnosis(found), {"kind": "point_damping", "position": 0.8, "damping": true})["numbers"]
        assert (row["true"], row["inside"]) == (true, inside)


def test_what_was_not_fitted_and_what_was_found_wrongly_have_no_numbers():
    width = dashpot(0.8, width={"value": 0.06, "std": None, "unit": "m"})
    assert scored(diagnosis(width), {"kind": "point_damping", "position": 0.8, "width": 0.05})["numbers"] == []
    wrong = dashpot(0.2, damping={"value": 10.0, "std": 1.0, "unit": "N s/m"})
    assert scored(diagnosis(wrong), {"kind": "point_damping", "position": 0.8, "damping": 10.0})["numbers"] == []


def test_numbers_of_the_rig_are_held_against_the_rig_that_was_built():
    found = [Estimate("youngs_modulus", 2.02e11, 0.01e11, "Pa"), Estimate("sleeves[0].clearance", 1e-4, 1e-6, "m")]
    inside, outside = rig_numbers(found, {"youngs_modulus": 2.005e11, "sleeves[0].clearance": 1.03e-4})

    assert inside == {"name": "youngs_modulus", "value": 2.02e11, "std": 0.01e11, "true": 2.005e11, "inside": True}
    assert not outside["inside"]
