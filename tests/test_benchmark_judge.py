import numpy as np
import pytest

from tests.benchmarks.hidden_effects import tasks
from tests.benchmarks.hidden_judge import judged
from tests.benchmarks.hidden_rigs import draw_rig

SLEEVES, LENGTH = {"sleeve 1": 0.45, "sleeve 2": 1.0}, 1.469
FILM = {"kind": "squeeze_film", "sleeve": "sleeve 2"}


def dashpot(position):
    return {"kind": "point_damping", "position": position}


def diagnosis(*effects, verdict="missing_effect", groups=()):
    return {
        "verdict": verdict,
        "effects": list(effects),
        "indistinguishable": [list(group) for group in groups],
        "error": [{"model": "as given", "nrmse": 0.4}, {"model": "calibrated", "nrmse": 0.1}],
        "holdout": {"as given": 0.3, "updated": 0.012, "noise_nrmse": 0.010},
        "seconds": 12.0,
    }


@pytest.mark.parametrize(
    ("found", "truth", "right", "kind_right", "grouped"),
    [
        (diagnosis(FILM), FILM, True, True, True),
        (diagnosis(dashpot(0.80)), dashpot(0.87), True, True, True),  # 4.8 % of the length
        (diagnosis(dashpot(0.80)), dashpot(0.88), False, True, False),  # 5.4 %
        (diagnosis(FILM | {"sleeve": "sleeve 1"}), FILM, False, True, False),
        (diagnosis(dashpot(1.0), FILM), FILM, False, False, False),  # the first one counts
        (diagnosis(dashpot(0.8), groups=[[dashpot(0.8), dashpot(1.2)]]), dashpot(1.2), True, True, True),
        (diagnosis(dashpot(0.8), groups=[[dashpot(0.6), dashpot(1.2)]]), dashpot(1.2), False, True, False),
        (diagnosis(dashpot(1.0), groups=[[dashpot(1.0), FILM]]), FILM, False, False, True),
        (diagnosis(verdict="complete"), FILM, False, False, False),
        (diagnosis(verdict="unexplained"), FILM, False, False, False),
        (diagnosis(verdict="complete"), None, True, True, True),
        (diagnosis(FILM), None, False, False, False),
        (diagnosis(verdict="unexplained"), None, False, False, False),
        (
            diagnosis({"kind": "coulomb_friction", "position": 1.02}),
            {"kind": "coulomb_friction", "sleeve": "sleeve 2"},
            True,
            True,
            True,
        ),
        (
            diagnosis({"kind": "sensor_gain", "sensor": "P3"}),
            {"kind": "sensor_gain", "sensor": "P4"},
            False,
            True,
            False,
        ),
        (diagnosis({"kind": "force_gain"}), {"kind": "force_gain"}, True, True, True),
    ],
)
def test_what_counts_as_right(found, truth, right, kind_right, grouped):
    scored = judged(found, truth, SLEEVES, LENGTH)
    assert (scored["right"], scored["kind_right"], scored["grouped"]) == (right, kind_right, grouped)


def test_the_ratios_are_read_from_the_diagnosis():
    scored = judged(diagnosis(FILM), FILM, SLEEVES, LENGTH)
    assert scored["holdout_ratio"] == pytest.approx(1.2)
    assert scored["calibrated_nrmse"] == 0.1


def test_the_same_seed_draws_the_same_rig_and_another_seed_another():
    first, again, other = (draw_rig(np.random.default_rng(seed)) for seed in (1, 1, 2))
    assert first == again
    assert first != other


def test_every_kind_has_its_cases_and_as_many_in_all_have_nothing_hidden():
    every = list(tasks(2, []))
    assert len(every) == len(set(every))
    assert sum(kind == "nothing" for kind, _ in every) == 20
    assert sum(kind == "squeeze_film" for kind, _ in every) == 2
    assert set(tasks(1, ["squeeze_film"])) == {("squeeze_film", 0)}
