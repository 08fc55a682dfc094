"""Whether a diagnosis is right, from its JSON and the truth's alone."""

from collections.abc import Mapping, Sequence

from identification.result import Estimate
from testbed.hidden_effects.plan import NOTHING, OUTSIDE, TWO
from testbed.outputs import Json

NEAR = 0.05
"""Positions closer than this share of the beam's length are the same."""

LARGEST_GROUP = 3
"""Effects of a group that the program may call indistinguishable and be right."""

NORMAL_95 = 1.96


def judged(diagnosis: Json, kind: str, truth: Sequence[Json], sleeves: Mapping[str, float], length: float) -> Json:
    """What the scores need to know of one diagnosis.

    Args:
        diagnosis: as ``diagnosis.json``.
        kind: of the case: a class or a kind of the library.
        truth: kind, place and numbers of each hidden effect.
        sleeves: position of each sleeve, m from the clamp.
        length: of the beam, m.

    Returns:
        ``right``: with nothing hidden the verdict ``complete``, outside the library ``unexplained``; with one effect
        the verdict, and the first effect's kind and place; with two, both found in any order. ``in_group``: right, or
        a stated group of at most three holds both the first effect and the true one. ``kind_right``: the first
        effect's kind alone. ``place_error``: of the first effect, where its kind is right, as a share of the length.
        ``numbers``: value, std and truth of what was found rightly.
    """
    found, verdict = diagnosis["effects"], diagnosis["verdict"]
    beam = _Beam(sleeves, length)
    pairs = beam.pairs(found, truth) if verdict == "missing_effect" and kind != OUTSIDE else []
    first = found[0] if found else None
    scored: Json = {
        "verdict": verdict,
        "named": first["kind"] if first is not None and verdict == "missing_effect" else verdict,
        "probability": first.get("probability") if first is not None else None,
        "n_found": len(found),
        "n_rightly": len(pairs),
        "numbers": [row for effect, true in pairs for row in numbers(effect, true)],
        "place_error": None,
    }
    if kind in (NOTHING, OUTSIDE):
        right = verdict == ("complete" if kind == NOTHING else "unexplained")
        return scored | {"right": right, "in_group": right, "kind_right": right}
    if first is None or verdict != "missing_effect":
        return scored | {"right": False, "in_group": False, "kind_right": False}
    alike = [true for true in truth if true["kind"] == first["kind"]]
    errors = [error for true in alike if (error := beam.distance(first, true)) is not None]
    right = len(pairs) == len(truth) if kind == TWO else beam.same(first, truth[0])
    grouped = right or (kind != TWO and beam.stated(first, truth[0], diagnosis["indistinguishable"]))
    return scored | {
        "right": right,
        "in_group": grouped,
        "kind_right": bool(alike),
        "place_error": min(errors, default=None),
    }


def are_there(
    found: Sequence[Json], truth: Sequence[Json], sleeves: Mapping[str, float], length: float
) -> tuple[bool, ...]:
    """Whether each effect that was added is hidden in the rig; a true one counts once.

    Args:
        found: effects of ``diagnosis.json``.
        truth: kind and place of each hidden effect.
        sleeves: position of each sleeve, m from the clamp.
        length: of the beam, m.
    """
    there = [effect for effect, _ in _Beam(sleeves, length).pairs(found, truth)]
    return tuple(any(effect is each for each in there) for effect in found)


def numbers(found: Json, truth: Json) -> list[Json]:
    """Value, standard deviation and truth of every single number of an effect that was fitted.

    Args:
        found: an effect of ``diagnosis.json``.
        truth: the true one of the same kind.
    """
    rows: list[Json] = []
    for name, about in found["parameters"].items():
        value, std, true = about["value"], about["std"], truth.get(name)
        if isinstance(true, int | float) and isinstance(value, int | float) and std:
            rows.append({"kind": truth["kind"], **_number(name, value, std, true)})
    return rows


def rig_numbers(estimates: Sequence[Estimate], built: Mapping[str, float]) -> list[Json]:
    """Value, standard deviation and truth of every calibrated number of the rig.

    Args:
        estimates: of the diagnosis.
        built: the true numbers, by path; of what it lacks nothing is told.
    """
    rows: list[Json] = []
    for estimate in estimates:
        value, std, true = estimate.value, estimate.std, built.get(estimate.name)
        if isinstance(value, float) and isinstance(std, float) and true is not None:
            rows.append(_number(estimate.name, value, std, true))
    return rows


def _number(name: str, value: float, std: float, true: float) -> Json:
    """A number beside the true one, and whether its interval of 95 % holds that."""
    inside = abs(value - true) <= NORMAL_95 * std
    return {"name": name, "value": value, "std": std, "true": true, "inside": inside}


class _Beam:
    """Where places are.

    Args:
        sleeves: position of each, m.
        length: of the beam, m.
    """

    def __init__(self, sleeves: Mapping[str, float], length: float) -> None:
        self.sleeves, self.length = sleeves, length

    def pairs(self, found: Sequence[Json], truth: Sequence[Json]) -> list[tuple[Json, Json]]:
        """Every true effect that was found, beside the found one; each found one counts once."""
        left, pairs = list(found), []
        for true in truth:
            match = next((effect for effect in left if self.same(effect, true)), None)
            if match is not None:
                left.remove(match)
                pairs.append((match, true))
        return pairs

    def stated(self, first: Json, true: Json, groups: Sequence[Sequence[Json]]) -> bool:
        """Whether a group small enough holds both."""
        return any(
            len(group) <= LARGEST_GROUP
            and any(self.same(first, other) for other in group)
            and any(self.same(true, other) for other in group)
            for group in groups
        )

    def same(self, one: Json, other: Json) -> bool:
        """The same kind at the same place; a sleeve is where it is."""
        if any(one.get(key) != other.get(key) for key in ("kind", "sensor", "other")):
            return False
        here, there = one.get("sleeve"), other.get("sleeve")
        if here is not None and there is not None:
            return bool(here == there)
        distance = self.distance(one, other)
        nowhere = position_of(one, self.sleeves) is position_of(other, self.sleeves) is None
        return nowhere or (distance is not None and distance <= NEAR)

    def distance(self, one: Json, other: Json) -> float | None:
        """Between two effects along the beam, as a share of its length; None where one is not on it."""
        here, there = position_of(one, self.sleeves), position_of(other, self.sleeves)
        return None if here is None or there is None else abs(here - there) / self.length


def position_of(effect: Json, sleeves: Mapping[str, float]) -> float | None:
    """Where an effect acts along the beam, m from the clamp; None of what acts everywhere, or on a channel.

    Args:
        effect: as ``diagnosis.json`` and the files of the cases hold it.
        sleeves: position of each, m.
    """
    if effect.get("sensor") is not None:
        return None
    sleeve = effect.get("sleeve")
    return sleeves[sleeve] if sleeve is not None else effect.get("position")
