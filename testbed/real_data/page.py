"""The JSON of the studies and the page beside it."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from testbed.loop import diagnosis_json
from testbed.outputs import Json
from testbed.real_data.bars import Bar, bars_table
from testbed.real_data.bolted_beam import HELD_OUT, BoltedBeam, Suspect
from testbed.real_data.friction_frame import FrictionFrame, sigmas_of
from testbed.real_data.silverbox import Silverbox


def verdict_of(bars: Sequence[Bar]) -> Json:
    """What was to be reached and whether it was.

    Args:
        bars: of a study.
    """
    return {"reached": all(bar.met for bar in bars), "bars": [bar.json() for bar in bars]}


def silverbox_json(study: Silverbox) -> Json:
    """The content of ``silverbox.json``.

    Args:
        study: finished.
    """
    errors = [{"model": label, "multisine_mv": one, "arrow_mv": other} for label, (one, other) in study.errors.items()]
    return {**verdict_of(study.bars), "errors": errors, "diagnosis": diagnosis_json(study.diagnosis)}


def frame_json(study: FrictionFrame) -> Json:
    """The content of ``friction_frame.json``.

    Args:
        study: finished.
    """
    rows = [
        {
            "weight_g": row.weight,
            "friction_force": {"value": row.force, "std": row.std, "unit": "N"},
            "friction_force_beside": {"value": row.beside, "std": row.beside_std, "unit": "N"},
            "errors_mm": {
                "as given": row.given,
                "calibrated": row.linear,
                "updated": row.updated,
                "linear, loose": row.loose[1],
            },
            "loose_stiffness": {"value": row.loose[0], "sigmas": sigmas_of(row.loose[0]), "unit": "N/m"},
            "loose_elsewhere_mm": {str(weight): error for weight, error in study.elsewhere[row.weight].items()},
            "diagnosis": diagnosis_json(row.diagnosis),
            "diagnosis_without_tolerances": diagnosis_json(row.unheld),
        }
        for row in study.rows
    ]
    predicted = {"value": study.predicted, "std": study.predicted_std, "unit": "N"}
    beside = {"value": study.predicted_beside, "unit": "N"}
    return {
        **verdict_of(study.bars),
        "predicted_at_450_g": predicted,
        "predicted_at_450_g_beside": beside,
        "weights": rows,
    }


def beam_json(study: BoltedBeam) -> Json:
    """The content of ``bolted_beam.json``.

    Args:
        study: finished.
    """
    numbers = [
        {name: getattr(effect, name) for name in ("kind", *effect.parameters())}
        for effect in study.models[study.final].hypothesis.effects
    ]
    return {
        **verdict_of(study.bars),
        "noise": study.noise,
        "held_out_level": HELD_OUT + 1,
        "errors": [{"model": label, "levels": list(row)} for label, row in study.errors.items()],
        "effects": numbers,
        **{
            place: [{"kind": row.label, "log_odds": row.log_odds, "held_out": row.held_out} for row in rows]
            for place, rows in (("alone", study.alone), ("trial", study.trial))
        },
        "decisions": list(study.decisions),
    }


def _page(title: str, command: str, bars: Sequence[Bar], picture: str, rest: Iterator[str]) -> str:
    met = "Every bound is kept." if all(bar.met for bar in bars) else "Not every bound is kept."
    head = [f"# {title}", "", f"Made by `{command}`. {met}", "", *bars_table(bars), "", picture, ""]
    return "\n".join([*head, *rest, ""])


def silverbox_page(study: Silverbox, command: str) -> str:
    """The page, in Markdown.

    Args:
        study: finished.
        command: that makes it again.
    """

    def rest() -> Iterator[str]:
        yield "Rms error of free simulation, from rest, with no number taken from the tests (volts stand for N and m):"
        yield ""
        yield "| model | multisine test [mV] | arrow [mV] |"
        yield "|---|---|---|"
        for label, (one, other) in study.errors.items():
            yield f"| {label} | {one:.2f} | {other:.2f} |"
        yield ""
        yield from _decided(study.diagnosis.decisions)

    picture = "![What each model leaves](figures/silverbox.png)"
    return _page("The Silverbox", command, study.bars, picture, rest())


def frame_page(study: FrictionFrame, command: str) -> str:
    """The page, in Markdown.

    Args:
        study: finished.
        command: that makes it again.
    """

    def rest() -> Iterator[str]:
        yield "Rms error on the second half of each test, mm, and what friction was found on the first:"
        yield ""
        yield "| weight | friction force, alone [N] | beside all else found [N] | as given | linear | with all found |"
        yield "|---|---|---|---|---|---|"
        for r in study.rows:
            errors = " | ".join(f"{value:.3f}" for value in (r.given, r.linear, r.updated))
            forces = f"{r.force:.3f} +- {r.std:.3f} | {r.beside:.3f} +- {r.beside_std:.3f}"
            yield f"| {r.weight} g | {forces} | {errors} |"
        yield ""
        last = study.rows[-1]
        alone, beside = abs(study.predicted - last.force), abs(study.predicted_beside - last.beside)
        yield f"The line through the others gives {study.predicted:.3f} +- {study.predicted_std:.3f} N at"
        yield f"{last.weight} g for the friction alone, {alone:.3f} N from what is found there; beside all else"
        yield f"that was found {study.predicted_beside:.3f} N, {beside:.3f} N from it. That the first of these"
        yield "has the bound was chosen when both were known."
        yield ""
        yield "The linear model without tolerances, and its stiffness on every weight's second half, mm:"
        yield ""
        heads = " | ".join(f"on {row.weight} g" for row in study.rows)
        yield f"| fitted at | stiffness [N/m] | standard deviations off | {heads} |"
        yield "|---|---|---|" + "---|" * len(study.rows)
        for r in study.rows:
            there = " | ".join(f"{error:.3f}" for error in study.elsewhere[r.weight].values())
            yield f"| {r.weight} g | {r.loose[0]:.0f} | {sigmas_of(r.loose[0]):.0f} | {there} |"
        yield ""
        yield "It fits better than the linear model within its tolerances, and is refused:"
        yield ""
        yield from (f"- {reason}" for reason in study.reasons)
        for r in study.rows:
            yield ""
            yield f"## {r.weight} g"
            yield ""
            yield from _decided(r.diagnosis.decisions)
            yield ""
            yield from _decided(r.unheld.decisions, "Given the model without tolerances, asked whether it is complete:")

    picture = "![Friction against weight](figures/friction_frame.png)"
    return _page("The friction frame", command, study.bars, picture, rest())


def beam_page(study: BoltedBeam, command: str) -> str:
    """The page, in Markdown.

    Args:
        study: finished.
        command: that makes it again.
    """

    def rest() -> Iterator[str]:
        yield f"Rms error of the complex amplitude, m/s^2; level {HELD_OUT + 1} is kept aside; noise {study.noise:.3f}."
        yield ""
        yield f"| model | {' | '.join(level.name for level in study.levels)} |"
        yield "|---|" + "---|" * len(study.levels)
        for label, errors in study.errors.items():
            yield f"| {label} | {' | '.join(_number(error) for error in errors)} |"
        yield ""
        yield "Every kind by itself beside the linear mode, all numbers fitted again:"
        yield ""
        yield from _suspects(study.alone)
        yield "Every kind in the place of the hysteresis, all numbers fitted again:"
        yield ""
        yield from _suspects(study.trial)
        yield from _decided(study.decisions)

    picture = "![Responses at four force levels](figures/bolted_beam.png)"
    return _page("The bolted beam", command, study.bars, picture, rest())


def _suspects(rows: Sequence[Suspect]) -> Iterator[str]:
    yield "| kind | log odds of the first against it | level kept aside [m/s^2] |"
    yield "|---|---|---|"
    for suspect in rows:
        yield f"| {suspect.label} | {suspect.log_odds:.0f} | {_number(suspect.held_out)} |"
    yield ""


def _number(error: float | None) -> str:
    return "no steady state" if error is None else f"{error:.2f}"


def _decided(decisions: Sequence[str], heading: str = "What was decided, in order:") -> Iterator[str]:
    yield heading
    yield ""
    for text in decisions:
        yield f"- {text}"


def rows_of(content: Mapping[str, Any]) -> list[tuple[Any, ...]]:
    """Rows of a table of what was to be reached.

    Args:
        content: of a study.
    """
    return [(bar["what"], bar["reached"], bar["bound"], bar["unit"], bar["met"]) for bar in content["bars"]]
