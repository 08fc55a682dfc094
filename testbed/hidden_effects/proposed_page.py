"""What came of the proposed tests: counts, and a page in Markdown."""

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import get_args

import numpy as np

from identification.next_experiment.choose import DECISIVE, EXCLUDED, is_decisive
from identification.next_experiment.words import sigmas
from testbed.hidden_effects.page import effect_in_words
from testbed.hidden_effects.proposed import Outcome
from testbed.outputs import Json

ABOUT = f"""\
Where a diagnosis of the hidden-effect benchmark states a group of effects that its records do not tell apart, it
proposes a test. Here the test is carried out on the rig as it really is, with the noise that its channels have had so
far, by the code that made its records (finite elements, MuJoCo or Exudyn; a rig that is let go by one of the last two),
and the rig is diagnosed again from the old records and the new one together.

*Told apart*: the right effect is named and no group is stated any more. *Still open*: a group is stated, and the right
effect is in it. *Wrong*: it is not. *No group*: the diagnosis of today states none, of the same records.
A test *promises to settle it* where the right one is expected to have a probability of {DECISIVE:g} at least, and the
members' predictions to part by {EXCLUDED:.1f} standard deviations of the noise, whatever numbers they take; where no
affordable test does, the proposal says so. A law that holds the right one within it (friction that slips faster than
anything moves is a dashpot, an absorber far above the band is a mass) is told from it by no test; were it the other way
round, a test would. *Promised* is the mean probability that the right one was expected to have afterwards; *reached*
the one that it has, 0 where it is not named.
"""


def proposed_summary(cases: Sequence[Json]) -> Json:
    """The content of ``summary.json``.

    Args:
        cases: done or failed, as their files hold them.
    """
    done = [case for case in cases if "outcome" in case]
    tested = [case for case in done if "after" in case]
    promised = [case for case in tested if promises_to_settle(case["proposal"])]
    return {
        "cases": len(cases),
        "failed": [{"case": case["case"], "failure": case["failure"]} for case in cases if case not in done],
        "outcomes": {name: sum(case["outcome"] == name for case in done) for name in get_args(Outcome)},
        "promised to settle it": _about(promised),
        "promised less": _about([case for case in tested if case not in promised]),
        "rows": done,
    }


def promises_to_settle(proposal: Json) -> bool:
    """Whether a test was proposed, and promised to settle the matter.

    Args:
        proposal: as a diagnosis tells it; empty where there was none.
    """
    return is_decisive(proposal.get("expected_probability", 0.0), proposal.get("separation", 0.0))


def _about(cases: Sequence[Json]) -> Json:
    outcomes = Counter(case["outcome"] for case in cases)
    promised = [case["proposal"]["expected_probability"] for case in cases]
    present = [case["proposal"]["present_probability"] for case in cases]
    reached = [(case["after"]["probability"] or 0.0) if case["after"]["right"] else 0.0 for case in cases]
    means = {"present": present, "promised": promised, "reached": reached}
    return {
        "cases": len(cases),
        "outcomes": dict(outcomes),
        **{name: float(np.mean(some)) if some else None for name, some in means.items()},
    }


def proposed_page(summary: Json, command: str) -> str:
    """The page.

    Args:
        summary: content of ``summary.json``.
        command: that makes it again.
    """
    lines = ["# The next experiment, carried out", "", f"Made by `{command}`.", "", ABOUT, *_counts(summary), ""]
    return "\n".join([*lines, "## One by one", "", *_rows(summary["rows"]), *failures(summary["failed"])]) + "\n"


def _counts(summary: Json) -> Iterator[str]:
    told = ", ".join(f"{name}: {count}" for name, count in summary["outcomes"].items())
    yield f"{summary['cases']} cases with a stated group. {told[0].upper()}{told[1:]}."
    yield ""
    yield "| tests | carried out | told apart | still open | wrong | probability now | promised | reached |"
    yield "|---|---|---|---|---|---|---|---|"
    for name in ("promised to settle it", "promised less"):
        row = summary[name]
        counts = " | ".join(str(row["outcomes"].get(key, 0)) for key in ("told apart", "still open", "wrong"))
        means = " | ".join("" if row[key] is None else f"{row[key]:.3f}" for key in ("present", "promised", "reached"))
        yield f"| {name} | {row['cases']} | {counts} | {means} |"


def _rows(cases: Sequence[Json]) -> Iterator[str]:
    yield "| case | hidden | group | test | minutes | parts by [std] | promised | by | named afterwards | outcome |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for case in cases:
        hidden = _joined(case["hidden"], " and ")
        groups = "; ".join(_joined(group, ", ") for group in case["before"]["indistinguishable"])
        test = case.get("proposal")
        promise = " | | | "
        if test is not None:
            parts = sigmas(test["separation"])
            promise = f"{test['do']} | {test['minutes']:.2g} | {parts} | {test['expected_probability']:.3f} "
        after = _joined(case["after"]["effects"], " and ") if "after" in case else ""
        by = case.get("simulator", "")
        yield f"| `{case['case']}` | {hidden} | {groups} | {promise}| {by} | {after} | {case['outcome']} |"


def _joined(effects: Sequence[Json], by: str) -> str:
    return by.join(effect_in_words(effect, " m") for effect in effects)


def failures(failed: Sequence[Json]) -> Iterator[str]:
    """Cases that failed, a paragraph each.

    Args:
        failed: of ``summary.json``.
    """
    for row in failed:
        yield ""
        yield f"`{row['case']}` failed: {row['failure']}."
