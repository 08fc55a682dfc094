"""Finished cases as their files hold them, without a diagnosis."""

from testbed.hidden_effects.plan import Task
from testbed.hidden_effects.sets import REPORTED

SEED, *_ = REPORTED.batches
"""Seed of the first batch."""


def made_up(
    kind,
    number,
    *,
    seed=SEED,
    right=True,
    named=None,
    after=1.0,
    ratio=8.0,
    inside=True,
    engine="fine",
    left=1.0,
    place=None,
    **more,
):
    """One case of the set ``reported``."""
    hidden = (
        []
        if kind == "nothing"
        else [{"kind": kind if kind not in ("two", "outside") else "one_sided_stop", "position": 0.5}]
    )
    verdict = {"nothing": "complete", "outside": "unexplained"}.get(kind, "missing_effect")
    if not right:
        verdict = "missing_effect" if kind in ("nothing", "outside") else "unexplained"
    name = named or (kind if verdict == "missing_effect" else verdict)
    one = kind not in ("nothing", "two", "outside")
    number_row = {"kind": kind, "name": "mass", "value": 1.02, "std": 0.01, "true": 1.0, "inside": inside}
    return {
        "case": Task("reported", seed, kind, number).name,
        "set": "reported",
        "seed": seed,
        "kind": kind,
        "number": number,
        "engine": engine,
        "hidden": hidden,
        "snr_db": 40.0 + number % 6,
        "chaotic": False,
        "noise_nrmse": {"holdout": 0.007},
        "judged": {
            "verdict": verdict,
            "named": name,
            "right": right,
            "in_group": right,
            "kind_right": right,
            "probability": 0.97 if one and right else 0.6 if one else None,
            "n_found": int(verdict == "missing_effect"),
            "n_rightly": int(right),
            "numbers": [number_row] if one and right else [],
            "place_error": 0.01 if one and right else None,
        },
        "calibrated_ratio": ratio,
        "held_out": {"before": 20.0, "calibrated": ratio, "after": after, "noise_nrmse": 0.007},
        "seconds": {"draw": 30.0, "diagnosis": 25.0 + number, "threads": 2},
        "rig": {"structure": {"length": 1.0}, "sleeves": [{"name": "sleeve 1", "position": 0.31}]},
        "diagnosis": {
            "effects": [{"kind": name, "position": 0.5, "probability": 0.97}] if verdict == "missing_effect" else [],
            "error": [{"model": "last", "nrmse": 0.007 * left, "noise_nrmse": 0.007}],
            "where": {} if place is None else {"place": {"position": place, "interval": [place - 0.02, place + 0.02]}},
        },
        **more,
    }


def failed(kind, number):
    """One that crashed."""
    about = Task("reported", SEED, kind, number).about
    return about | {"failure": "ValueError: nobody knows"}


def every_bar_met():
    """Two hundred cases in the mix of the benchmark, none of them missed."""
    cases = [made_up("nothing", n) for n in range(50)]
    cases += [made_up("point_mass", n, inside=n % 20 != 0) for n in range(110)]
    cases += [made_up("two", n) for n in range(20)] + [made_up("outside", n, after=9.0) for n in range(20)]
    return cases
