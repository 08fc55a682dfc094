"""The article's tables 2 to 5 and A1 to A12, ours with the article's beside them, in Markdown."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from models.arrays import FloatArray
from testbed.article.bars import all_of, bars_of
from testbed.article.compared import PERFECT, TRUE_DAMPING
from testbed.article.published import PrintedTest
from testbed.article.three_models import INITIAL, MODELS, UPDATED

Json = dict[str, Any]

MILLI = 1e3

INDICES = ("mre", "rmse", "frac", "csac", "csf")

JUDGE = "mujoco"
"""Whose table test fills the tables; Exudyn's stands in the bars."""


def frequency_tables(rows: Sequence[Json], printed: Sequence[PrintedTest]) -> Iterator[str]:
    """Tables 2 and A1 to A6: frequencies, their errors and MAC, one table a clearance.

    Args:
        rows: one a clearance.
        printed: the article's, in the same order.
    """
    for row, theirs in zip(rows, printed, strict=True):
        yield f"**{MILLI * row['clearance']:g} mm**"
        yield ""
        yield (
            "| order | test [Hz] | initial | error | MAC | updated | error | MAC | diagnosed | error | MAC "
            "| article: test | initial | MAC | updated | MAC |"
        )
        yield "|" + "---|" * 16
        test = row["tests"][JUDGE]["natural_freqs"]
        for order in range(4):
            cells = [str(order + 1), f"{test[order]:.3f}"]
            for model in MODELS:
                found = row["models"][model][JUDGE]
                cells += [f"{found['natural_freqs'][order]:.3f}", f"{found['freq_errors'][order]:+.2%}"]
                cells.append(f"{found['mac'][order]:.4f}")
            cells.append(f"{theirs.measured_freqs[order]:g}")
            for freqs, mac in ((theirs.initial_freqs, theirs.initial_mac), (theirs.updated_freqs, theirs.updated_mac)):
                error = freqs[order] / theirs.measured_freqs[order] - 1.0
                cells += [f"{freqs[order]:g} ({error:+.2%})", f"{mac[order]:.4f}"]
            yield f"| {' | '.join(cells)} |"
        yield ""


def frequency_summary(rows: Sequence[Json], printed: Sequence[PrintedTest]) -> Iterator[str]:
    """Table 3: largest and mean error and the mean MAC at each clearance.

    Args:
        rows: one a clearance.
        printed: the article's, in the same order.
    """
    yield "| clearance [mm] | largest error | mean error | mean MAC | article: largest error | mean error | mean MAC |"
    yield "|" + "---|" * 7
    for row, theirs in zip(rows, printed, strict=True):
        ours = [row["models"][model][JUDGE] for model in MODELS]
        errors = [np.abs(found["freq_errors"]) for found in ours]
        printed_errors = [
            np.abs(np.array(freqs) / np.array(theirs.measured_freqs) - 1.0)
            for freqs in (theirs.initial_freqs, theirs.updated_freqs)
        ]
        printed_mac = [np.mean(mac) for mac in (theirs.initial_mac, theirs.updated_mac)]
        cells = [
            f"{MILLI * row['clearance']:g}",
            _steps(f"{e.max():.2%}" for e in errors),
            _steps(f"{e.mean():.2%}" for e in errors),
            _steps(f"{np.mean(found['mac']):.4f}" for found in ours),
            _steps(f"{e.max():.2%}" for e in printed_errors),
            _steps(f"{e.mean():.2%}" for e in printed_errors),
            _steps(f"{mac:.4f}" for mac in printed_mac),
        ]
        yield f"| {' | '.join(cells)} |"


def response_tables(rows: Sequence[Json], printed: Sequence[PrintedTest], points: Sequence[str]) -> Iterator[str]:
    """Tables 4 and A7 to A12: errors of the FRF at every point, one table a clearance.

    Args:
        rows: one a clearance.
        printed: the article's, in the same order.
        points: names of ours.
    """
    for row, theirs in zip(rows, printed, strict=True):
        yield f"**{MILLI * row['clearance']:g} mm**: initial, updated, diagnosed; then the article's initial, updated"
        yield ""
        yield "| point | MRE | RMSE | FRAC | CSAC | CSF | article: MRE | RMSE | FRAC | CSAC | CSF |"
        yield "|" + "---|" * 11
        for number, point in enumerate(points):
            ours = {model: row["models"][model][JUDGE] for model in MODELS}
            cells = [point]
            cells += [_steps(f"{found[index][number]:.4f}" for found in ours.values()) for index in INDICES]
            for index in INDICES:
                values = (getattr(theirs, f"{model}_{index}")[number] for model in (INITIAL, UPDATED))
                cells.append(_steps(f"{value:.4f}" for value in values))
            yield f"| {' | '.join(cells)} |"
        yield ""


def response_summary(rows: Sequence[Json], printed: Sequence[PrintedTest]) -> Iterator[str]:
    """Table 5: by how much each index changes from the initial to the updated and to the diagnosed model.

    Args:
        rows: one a clearance.
        printed: the article's, in the same order.
    """
    heads = " | ".join(index.upper() for index in INDICES)
    yield f"| clearance [mm] | {heads} | article: {heads} |"
    yield "|" + "---|" * 11
    for row, theirs in zip(rows, printed, strict=True):
        cells = [f"{MILLI * row['clearance']:g}"]
        for index in INDICES:
            first, *others = (np.mean(row["models"][model][JUDGE][index]) for model in MODELS)
            cells.append(_steps(f"{other / first - 1.0:+.1%}" for other in others))
        for index in INDICES:
            first, last = (np.mean(getattr(theirs, f"{model}_{index}")) for model in (INITIAL, UPDATED))
            cells.append(f"{last / first - 1.0:+.1%}")
        yield f"| {' | '.join(cells)} |"


def bars_table(rows: Sequence[Json]) -> Iterator[str]:
    """What was asked for and what was reached, on the tests of both engines.

    Args:
        rows: one a clearance.
    """
    engines = list(rows[0]["tests"])
    yield f"| | asked | {' | '.join(f'{engine} | ' for engine in engines)} |"
    yield "|" + "---|" * (2 + 2 * len(engines))
    for bars in zip(*(bars_of(rows, engine) for engine in engines), strict=True):
        cells = " | ".join(f"{bar.reached} | {'met' if bar.is_met else 'missed'}" for bar in bars)
        yield f"| {bars[0].what} | {bars[0].asked} | {cells} |"


def fourth_order(rows: Sequence[Json]) -> Iterator[str]:
    """What is left at the fourth order of the updated model, and of one whose identifier makes no error.

    Args:
        rows: one a clearance.
    """
    yield (
        "| clearance [mm] | error of f4: identified | without error of identification | damping ratio: identified "
        "| without | test | MRE: identified | without | perfect model |"
    )
    yield "|" + "---|" * 9
    for row in rows:
        identified, exact, perfect = (row["models"][model][JUDGE] for model in (UPDATED, TRUE_DAMPING, PERFECT))
        cells = [f"{MILLI * row['clearance']:g}"]
        cells += [f"{found['freq_errors'][3]:+.3%}" for found in (identified, exact)]
        cells += [f"{found['damping_ratios'][3]:.4f}" for found in (identified, exact)]
        cells.append(f"{row['tests'][JUDGE]['damping_ratios'][3]:.4f}")
        cells += [f"{np.mean(found['mre']):.4f}" for found in (identified, exact, perfect)]
        yield f"| {' | '.join(cells)} |"


def mean_of(rows: Sequence[Json], model: str, what: str) -> float:
    """Of all points and clearances.

    Args:
        rows: one a clearance.
        model: name.
        what: key of the index.
    """
    found: FloatArray = all_of(rows, model, JUDGE, what)
    return float(found.mean())


def _steps(values: Iterator[str]) -> str:
    return " -> ".join(values)
