"""From the files of the cases to the figures: a pure function."""

from collections import Counter, defaultdict
from collections.abc import Sequence
from itertools import pairwise, product

import numpy as np

from identification.reached import NOISE_REACHED
from testbed.hidden_effects.bars import bars_of
from testbed.hidden_effects.detection import detection
from testbed.hidden_effects.judge import NEAR, are_there, position_of
from testbed.hidden_effects.newest import newest_of
from testbed.hidden_effects.outside import HELD_BY_NONE
from testbed.hidden_effects.plan import NOTHING, OUTSIDE, PATTERN, TWO
from testbed.hidden_effects.sets import FEW, MANY, MOST, SETS
from testbed.outputs import Json

STAGES = ("before", "calibrated", "after")
"""Of a diagnosis: the rig as given, its numbers within their tolerances, with what was found."""

CLASSES = {NOTHING: "nothing hidden", TWO: "two effects", OUTSIDE: "outside the library"}
ONE = "one effect"

PROBABILITY_EDGES = (0.0, 0.5, 0.8, 0.95, 0.99, 1.0)
"""Of the bins in which what the diagnosis believes is held against how often it is right."""


def summary_of(cases: Sequence[Json], case_set: str) -> Json:
    """The content of ``summary.json``.

    Args:
        cases: of one set, done or failed, as their files hold them.
        case_set: its name.
    """
    groups = _by_class(cases)
    done = [case for case in cases if "judged" in case]
    hidden_one = groups[ONE]
    newest = newest_of(cases, SETS[case_set].batches)
    reached, reached_newest = reached_over(cases), reached_over(newest)
    bars = bars_of(reached)
    named = [case for case in done if case["judged"]["verdict"] == "missing_effect"]
    return {
        "set": case_set,
        "bars": bars,
        "missed": [bar["name"] for bar in bars if bar["met"] is False],
        "newest": {
            "seeds": sorted({case["seed"] for case in newest}),
            "bars": bars_of(reached_newest),
            "laws_alike": reached_newest["laws_alike"],
            "kinds_alike": reached_newest["kinds_alike"],
            "seconds_alone": seconds_by_class(newest, 1),
            "seconds_on_cores": seconds_by_class(newest, CORES),
            "shares_of_engines": shares_of_engines(newest),
        },
        "shares_of_engines": shares_of_engines(cases),
        "failed": [{"case": case["case"], "failure": case["failure"]} for case in cases if "judged" not in case],
        **reached,
        f"one effect below {MANY:g} times the noise": row_of([c for c in hidden_one if _ratio(c) < MANY]),
        f"one effect from {MANY:g} times the noise on": row_of([c for c in hidden_one if _ratio(c) >= MANY]),
        "chaotic": row_of([case for case in cases if case.get("chaotic")]),
        "batches": {str(seed): batch_of([c for c in cases if c["seed"] == seed]) for seed in SETS[case_set].batches},
        "engines": {name: row_of(group) for name, group in _by(cases, "engine").items()},
        "kinds": {kind: row_of(group) for kind, group in _by(hidden_one, "kind").items()},
        "laws outside": {kind: row_of(group) for kind, group in _by_law(groups[CLASSES[OUTSIDE]]).items()},
        "by_engine": by_engine(hidden_one, "kind") | by_engine(_with_law(groups[CLASSES[OUTSIDE]]), "law"),
        "confusion": confusion(done),
        "false_alarms": sum(c["judged"]["verdict"] == "missing_effect" for c in groups[CLASSES[NOTHING]] if c in done),
        "nothing_unexplained": sum(c["judged"]["verdict"] == "unexplained" for c in done if not c["hidden"]),
        "abstentions": sum(
            c["judged"]["verdict"] == "unexplained" for c in done if c["hidden"] and class_of(c) != CLASSES[OUTSIDE]
        ),
        "missed_silently": sum(c["judged"]["verdict"] == "complete" for c in done if c["hidden"]),
        "named_besides": sum(c["judged"]["n_found"] > len(c["hidden"]) for c in done if c["judged"]["right"]),
        "place_errors": place_errors([case for case in done if class_of(case) == ONE]),
        "calibration": calibration([c for c in named if SETS[case_set].batches[c["seed"]].keeps]),
        "calibration_before": calibration([c for c in named if not SETS[case_set].batches[c["seed"]].keeps]),
        "by_what_is_left": by_what_is_left(named),
        "added_later": added_later([c for c in named if SETS[case_set].batches[c["seed"]].keeps]),
        "seconds_in_first_mix": seconds_in_first_mix(cases, CORES),
        "shown": shown([case for case in done if case["hidden"]]),
        "located": located([case for case in done if len(case["hidden"]) == 1]),
        "located_since": located([c for c in done if len(c["hidden"]) == 1 and c["seed"] >= LOCATED_ANEW]),
        "contradicted": {name: contradicted(group) for name, group in groups.items()},
        "rig_numbers": rig_numbers([case for case in done if case["judged"]["right"]]),
        "detection": detection([_sized(c) for c in done if class_of(c) == ONE], SETS[case_set].snr),
        "farthest": [_miss(case) for case in farthest(done)],
        "misses": [_miss(case) for case in cases if "judged" not in case or not case["judged"]["right"]],
    }


def reached_over(cases: Sequence[Json]) -> Json:
    """The figures that have a bar.

    Args:
        cases: of one set.
    """
    done = [case for case in cases if "judged" in case]
    return {
        "cases": len(cases),
        **{name: row_of(group) for name, group in _by_class(cases).items()},
        "laws_alike": laws_alike(cases),
        "kinds_alike": kinds_alike(cases),
        "numbers": numbers(done),
        "held_out": held_out([c for c in done if class_of(c) != CLASSES[OUTSIDE]]),
        "seconds": seconds(done),
    }


def laws_alike(cases: Sequence[Json]) -> Json:
    """Share of the laws outside the library that are called ``unexplained``, each law counted alike.

    Batches that all begin with the same law hold more of it than of the last, where they are short. Beside it, how many
    are right of the cases whose law no more general law of the diagnosis holds within it either.

    Args:
        cases: of any class.
    """
    by_law = _by_law([case for case in cases if class_of(case) == CLASSES[OUTSIDE]])
    return {
        "laws": len(by_law),
        "share": _mean_of([row_of(group) for group in by_law.values()], "right_share"),
        "held_by_none": _counts_of([case for law in HELD_BY_NONE for case in by_law.get(law.kind, [])]),
    }


def kinds_alike(cases: Sequence[Json]) -> Json:
    """Shares of single effects that come first, or stand in the stated group, each kind counted alike.

    Args:
        cases: of any class.
    """
    rows = [row_of(group) for group in _by([case for case in cases if class_of(case) == ONE], "kind").values()]
    return {"kinds": len(rows), **{key: _mean_of(rows, f"{key}_share") for key in ("right", "in_group")}}


def _mean_of(rows: Sequence[Json], key: str) -> float | None:
    return float(np.mean([row[key] for row in rows])) if rows else None


def shown(cases: Sequence[Json]) -> Json:
    """How large the calibrated errors have come out.

    Args:
        cases: done, with something hidden.
    """
    ratios = [_ratio(case) for case in cases]
    return {
        "cases": len(ratios),
        "span": [min(ratios), max(ratios)] if ratios else None,
        "few": sum(ratio < FEW for ratio in ratios),
        "most": sum(ratio > MOST for ratio in ratios),
    }


def batch_of(cases: Sequence[Json]) -> Json:
    """Cases of one seed: how many, how many right of each class, and the error held out.

    Args:
        cases: of that seed.
    """
    kept = held_out([case for case in cases if "judged" in case and class_of(case) != CLASSES[OUTSIDE]])
    counts = {name: _counts_of(group) for name, group in _by_class(cases).items()}
    return {"cases": len(cases), "classes": counts, "after_median": kept["median"]}


def _counts_of(cases: Sequence[Json]) -> Json:
    """How many of a group are right, and how many it has."""
    row = row_of(cases)
    return {key: row[key] for key in ("right", "cases")}


def class_of(case: Json) -> str:
    """Of which class a case is, in words."""
    return CLASSES.get(case["kind"], ONE)


def _by_class(cases: Sequence[Json]) -> dict[str, list[Json]]:
    return {name: [case for case in cases if class_of(case) == name] for name in (ONE, *CLASSES.values())}


def row_of(cases: Sequence[Json]) -> Json:
    """Counts of a group; a case that failed is not right.

    Args:
        cases: of the group.
    """
    done = [case for case in cases if "judged" in case]
    errors = {stage: [case["held_out"][stage] for case in done] for stage in STAGES}
    right, grouped, kind = (sum(c["judged"][key] for c in done) for key in ("right", "in_group", "kind_right"))
    return {
        "cases": len(cases),
        "failed": len(cases) - len(done),
        "right": right,
        "in_group": grouped,
        "kind_right": kind,
        "right_share": right / len(cases) if cases else None,
        "in_group_share": grouped / len(cases) if cases else None,
        **{f"{stage}_median": float(np.median(some)) if some else None for stage, some in errors.items()},
        "seconds_median": float(np.median([case["seconds"]["diagnosis"] for case in done])) if done else None,
    }


def confusion(cases: Sequence[Json]) -> Json:
    """How often each kind was taken for which: true kind -> named kind or verdict -> count, of one effect or none.

    Args:
        cases: done; those of two effects are left out.
    """
    table: dict[str, Counter[str]] = defaultdict(Counter)
    for case in cases:
        if case["kind"] != TWO:
            table[case["kind"]][case["judged"]["named"]] += 1
    return {kind: dict(counts) for kind, counts in sorted(table.items())}


def numbers(cases: Sequence[Json]) -> Json:
    """How well the numbers of the effects rightly found are known: over all, and by kind and by engine.

    Args:
        cases: done.
    """
    rows = [row | {"engine": case["engine"]} for case in cases for row in case["judged"]["numbers"]]

    def share(some: Sequence[Json]) -> Json:
        pulls = [abs(row["value"] - row["true"]) / row["std"] for row in some]
        relative = [abs(row["value"] / row["true"] - 1.0) for row in some if row["true"]]
        return {
            "count": len(some),
            "inside_share": sum(row["inside"] for row in some) / len(some) if some else None,
            "pull_median": float(np.median(pulls)) if pulls else None,
            "error_median": float(np.median(relative)) if relative else None,
        }

    by_kind = {kind: share(group) for kind, group in _by(rows, "kind").items()}
    by_engine = {engine: share(group) for engine, group in _by(rows, "engine").items()}
    return share(rows) | {"kinds": by_kind, "engines": by_engine}


def calibration(cases: Sequence[Json]) -> list[Json]:
    """How often the first effect is there where the diagnosis believes in it so much.

    Args:
        cases: in which an effect was named.
    """
    named = [(c["judged"]["probability"], first_is_there(c)) for c in cases if c["judged"]["probability"] is not None]
    rows = []
    for low, high in pairwise(PROBABILITY_EDGES):
        inside = [(p, there) for p, there in named if low <= p < high or (high == 1.0 == p)]
        if inside:
            believed = float(np.mean([p for p, _ in inside]))
            rows.append({"believed": believed, "right": sum(there for _, there in inside), "cases": len(inside)})
    return rows


def added_later(cases: Sequence[Json]) -> list[Json]:
    """How often an effect that was added beside another is there, and how much was believed, by what is left.

    Args:
        cases: in which an effect was named.
    """
    rows = []
    for taught, met in product((True, False), (True, False)):
        some = [case for case in cases if (case["seed"] <= LATER_TAUGHT_UNTIL) == taught and _reaches(case) == met]
        later = [row for case in some for row in list(zip(_chances(case), _there(case), strict=True))[1:]]
        there = {"right": sum(is_there for _, is_there in later), "cases": len(later)}
        believed = float(np.mean([chance for chance, _ in later])) if later else None
        rows.append({"taught": taught, "met": met, "believed": believed, **there})
    return rows


LATER_TAUGHT_UNTIL = 33301
"""Seed of the last of the batches from which the shares were taken that are kept of an effect beside another."""


def _chances(case: Json) -> list[float]:
    return [effect["probability"] for effect in case["diagnosis"]["effects"]]


def _there(case: Json) -> tuple[bool, ...]:
    truth, length = case["hidden"] if class_of(case) != CLASSES[OUTSIDE] else (), case["rig"]["structure"]["length"]
    return are_there(case["diagnosis"]["effects"], truth, _sleeves(case), length)


def _reaches(case: Json) -> bool | None:
    """Whether the model that stands reaches the noise; None where its noise was not told."""
    final = _final(case)
    return final["nrmse"] <= NOISE_REACHED * final["noise_nrmse"] if "noise_nrmse" in final else None


TAUGHT_UNTIL = 38803
"""Seed of the last of the batches from which the shares were taken that are kept by what a model leaves."""


def by_what_is_left(cases: Sequence[Json]) -> list[Json]:
    """How often the first effect is there by what the model that stands leaves, as far as that was told with its noise.

    Args:
        cases: in which an effect was named.
    """
    rows = []
    for taught in (True, False):
        some = [c for c in cases if (c["seed"] <= TAUGHT_UNTIL) == taught]
        for met in (True, False):
            alike = [c for c in some if _reaches(c) == met]
            right = sum(first_is_there(c) for c in alike)
            chances = [chance for c in alike if (chance := c["judged"]["probability"]) is not None]
            believed = float(np.mean(chances)) if chances else None
            rows.append({"taught": taught, "met": met, "believed": believed, "right": right, "cases": len(alike)})
    return rows


def _final(case: Json) -> Json:
    """Errors of the model that stands."""
    final: Json = case["diagnosis"]["error"][-1]
    return final


LOCATED_ANEW = 25643
"""Seed of the first batch whose diagnosis holds all places that explain as much in the interval of a place."""


def located(cases: Sequence[Json]) -> Json:
    """How near to the one effect the force was located that the calibrated model lacks, without a law.

    Args:
        cases: of one effect, done.

    Returns:
        counts of the ``cases`` whose effect acts at one place on the beam and of which the diagnosis looked for one;
        of those with a place ``told``, ``near`` to the true one, and with the true one ``inside`` the interval.
    """
    pairs = [(case, place) for case in cases if (place := _true_place(case)) is not None]
    looked = [(c, place) for c, place in pairs if "place" in c["diagnosis"]["where"]]
    told = [(c, c["diagnosis"]["where"]["place"], place) for c, place in looked]
    told = [row for row in told if row[1]["position"] is not None]
    near = [abs(found["position"] - place) <= NEAR * c["rig"]["structure"]["length"] for c, found, place in told]
    inside = [found["interval"][0] <= place <= found["interval"][1] for _, found, place in told]
    return {"cases": len(looked), "told": len(told), "near": sum(near), "inside": sum(inside)}


def contradicted(cases: Sequence[Json]) -> Json:
    """In how many cases something speaks against one set of numbers within the tolerances, where nothing is added.

    Args:
        cases: of a class; those that failed, or whose batch did not tell it yet, are left out.
    """
    told = [case for case in cases if "of_calibrated" in case.get("diagnosis", {}).get("where", {})]
    return {"cases": len(told), "found": sum(bool(case["diagnosis"]["where"]["of_calibrated"]) for case in told)}


def rig_numbers(cases: Sequence[Json]) -> Json:
    """How many calibrated numbers of the rig itself lie inside their intervals.

    Args:
        cases: right; those whose batch did not tell it yet, or whose law the library does not hold, are left out.
    """
    told = [case for case in cases if "rig_numbers" in case and class_of(case) != CLASSES[OUTSIDE]]
    rows = [row for case in told for row in case["rig_numbers"]]
    return {"cases": len(told), "count": len(rows), "inside": sum(row["inside"] for row in rows)}


def _true_place(case: Json) -> float | None:
    """Where the one effect acts, m from the clamp, if at one place."""
    (effect,) = case["hidden"]
    return position_of(effect, _sleeves(case))


def _sleeves(case: Json) -> dict[str, float]:
    """Position of each, m from the clamp."""
    return {sleeve["name"]: sleeve["position"] for sleeve in case["rig"]["sleeves"]}


def beliefs_of(summary: Json) -> dict[str, list[Json]]:
    """What was believed and what was right, by how the probabilities were told.

    Args:
        summary: content of ``summary.json``.
    """
    return {
        "a share kept for what was not judged": summary["calibration"],
        "batches before that, nothing kept": summary["calibration_before"],
    }


def first_is_there(case: Json) -> bool:
    """Whether the effect that was named first is hidden in the rig, of two whichever.

    Args:
        case: done, in which an effect was named.
    """
    result = case["judged"]
    near = result["place_error"] is None or result["place_error"] <= NEAR
    return bool(result["kind_right"] and near) if class_of(case) == CLASSES[TWO] else bool(result["right"])


def place_errors(cases: Sequence[Json]) -> list[float]:
    """Distances of the first effect from the true place, in shares of the length, where the place was free.

    A sleeve or a sensor is hit or not, which ``right`` counts.

    Args:
        cases: of one effect, done.
    """
    free = [
        case for case in cases if "position" in case["hidden"][0] and not {"sleeve", "sensor"} & set(case["hidden"][0])
    ]
    return [case["judged"]["place_error"] for case in free if case["judged"]["place_error"] is not None]


def farthest(cases: Sequence[Json]) -> list[Json]:
    """Cases that are right, but leave much more than the noise of the record held out, the farthest first.

    Args:
        cases: done.
    """
    far = [
        c for c in cases if c["judged"]["right"] and class_of(c) != CLASSES[OUTSIDE] and c["held_out"]["after"] > FAR
    ]
    return sorted(far, key=lambda case: -case["held_out"]["after"])


FAR = 1.3
"""Error held out over the true noise from which a right case is told one by one."""


def held_out(cases: Sequence[Json]) -> Json:
    """Errors on the records held out over the true noise: of all cases, and what was reached in the end.

    Args:
        cases: done, whose truth the library holds.
    """
    after = [case["held_out"]["after"] for case in cases]
    return {
        "cases": len(cases),
        "median": float(np.median(after)) if after else None,
        "percentile_90": float(np.percentile(after, 90)) if after else None,
        "rows": [
            {"case": case["case"], "class": class_of(case), "right": case["judged"]["right"], **case["held_out"]}
            for case in cases
        ],
    }


def seconds(cases: Sequence[Json]) -> Json:
    """What a case takes on as many threads as the bar has cores, where any ran so, and what the others took.

    Args:
        cases: done.
    """
    rows = [case["seconds"] for case in cases]
    asked = [row for row in rows if row["threads"] == CORES] or rows
    others = [row for row in rows if row not in asked]

    def about(some: Sequence[Json]) -> Json:
        middle = float(np.median([row["diagnosis"] for row in some])) if some else None
        return {"cases": len(some), "median": middle, "threads": sorted({row["threads"] for row in some})}

    return about(asked) | {
        "draw_median": float(np.median([row["draw"] for row in asked])) if asked else None,
        "rows": [row["diagnosis"] for row in asked],
        "others": about(others),
    }


CORES = 2
"""Of the machine that the bar means."""


def seconds_by_class(cases: Sequence[Json], threads: int) -> Json:
    """What a diagnosis takes, by class: class -> cases and median.

    Args:
        cases: of one set; those that failed are left out.
        threads: of the diagnoses that are asked for.
    """
    return {
        name: {"cases": len(some), "median": float(np.median(some)) if some else None}
        for name, some in _taken(cases, threads).items()
    }


def seconds_in_first_mix(cases: Sequence[Json], threads: int) -> float | None:
    """Median of what a diagnosis takes, each class counted at the share that it has of the first batches' cases.

    A quarter of later batches' cases is outside the library, where others have a tenth, and these take longest.

    Args:
        cases: of one set; those that failed are left out.
        threads: of the diagnoses that are asked for.
    """
    share = Counter(CLASSES.get(name, ONE) for name in PATTERN)
    weighed = sorted((each, share[name] / len(some)) for name, some in _taken(cases, threads).items() for each in some)
    if not weighed:
        return None
    below = np.cumsum([weight for _, weight in weighed])
    return float(weighed[int(np.searchsorted(below, 0.5 * below[-1]))][0])


def _taken(cases: Sequence[Json], threads: int) -> dict[str, list[float]]:
    """Seconds of each diagnosis on so many threads, by class; those that failed are left out."""
    asked = [case for case in cases if "judged" in case and case["seconds"]["threads"] == threads]
    return {name: [case["seconds"]["diagnosis"] for case in group] for name, group in _by_class(asked).items()}


def shares_of_engines(cases: Sequence[Json]) -> Json:
    """How many of the cases that every engine can carry each of them moved: engine -> cases.

    Args:
        cases: of one set; those that failed are left out.
    """
    done = [case for case in cases if "judged" in case]
    return dict(Counter(case["engine"] for case in done if not FINE_ALONE & {one["kind"] for one in case["hidden"]}))


def by_engine(cases: Sequence[Json], key: str) -> Json:
    """Right of all by kind or law and by the engine that moved the truth: kind -> engine -> counts.

    Args:
        cases: of one effect, or outside the library; those that failed before an engine was there are left out.
        key: of a case, by which they are told apart.
    """
    return {
        kind: {engine: _counts_of(some) for engine, some in _by(group, "engine").items()}
        for kind, group in _by(cases, key).items()
    }


FINE_ALONE = frozenset({"axial_load", "breathing_crack", "local_damage", "stiffness_drift", "structural_damping"})
"""Kinds that our finite elements alone carry."""


def in_a_line(case: Json) -> str:
    """A case as the progress tells it.

    Args:
        case: as its file holds it.
    """
    if "judged" not in case:
        return f"{case['case']}: {case['failure']}"
    result = case["judged"]
    mark = "right" if result["right"] else f"WRONG, {result['named']}"
    return f"{case['case']} ({case['engine']}): {mark}, {case['seconds']['diagnosis']:.0f} s"


def _ratio(case: Json) -> float:
    """Calibrated error over noise, as diagnosed, or as drawn where the diagnosis failed."""
    return float(case.get("calibrated_ratio") or case.get("calibrated_on_model") or FEW)


def _by(rows: Sequence[Json], key: str) -> dict[str, list[Json]]:
    groups: dict[str, list[Json]] = defaultdict(list)
    for row in rows:
        if key in row:
            groups[row[key]].append(row)
    return dict(sorted(groups.items()))


def _by_law(cases: Sequence[Json]) -> dict[str, list[Json]]:
    return _by(_with_law(cases), "law")


def _with_law(cases: Sequence[Json]) -> list[Json]:
    return [case | {"law": case["hidden"][0]["kind"]} for case in cases if case.get("hidden")]


def _sized(case: Json) -> Json:
    return {"snr_db": case["snr_db"], "ratio": _ratio(case), "right": case["judged"]["right"], "case": case["case"]}


def _miss(case: Json) -> Json:
    about = {key: case.get(key) for key in ("case", "kind", "engine", "hidden", "chaotic", "snr_db")}
    if "judged" not in case:
        return about | {"failure": case["failure"]}
    result = case["judged"]
    effects = [{key: e[key] for key in e if key != "parameters"} for e in case["diagnosis"]["effects"]]
    return about | {
        "ratio": _ratio(case),
        "verdict": result["verdict"],
        "in_group": result["in_group"] and not result["right"],
        "found": effects,
        "after": case["held_out"]["after"],
    }
