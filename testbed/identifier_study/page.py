"""``identifier.json`` and the page beside it."""

from collections.abc import Iterable, Iterator
from dataclasses import asdict

from testbed.identifier_study.bound_table import ESTIMATORS, LONGEST, TIME_CONSTANTS, Cell
from testbed.identifier_study.searches import ARTICLE_RUNS
from testbed.identifier_study.study import QUIET, Study
from testbed.identifier_study.verification import RIDGE_BARS
from testbed.outputs import Json

TRACKED = {
    "multiscale": "plain ridge at 2^6.8",
    "ridge": "plain ridge, optimised scale",
    "past_jumps": "ridge past jumps",
    "smoother": "smoother",
}

VERIFICATION = """\
An oscillator of 5 kg on 800 N/m decays for 100 s at 256 Hz; its damping steps from 0.06 to 0.01 N s/m at 50 s, or falls
as 0.06 - 0.0002 t. Rms error of c over the whole record, ends included, N s/m, mean over records. The floor is the
Cramer-Rao bound of one who knows the form (docs/theory.md, section 11): the mean of the rms errors that it implies,
like the figures beside it, and the root of the mean square.
"""

SCALES = """\
Normalised rms error plus normalised cost in operations of one pass (the article's equation 27), searched on a training
record, not on those that are scored above. `grid` is the article's multiscale baseline, steps of 2^0.2.
"""

RUNS = """\
Quantum search on the step at 60 dB, each run with noise and seed of its own; levels are medians before and after the
jump, on the record that was searched on.
"""

ENDS = """\
`gaussian` is the Morlet wave; all windows have the same standard deviation. Silence (`zero`) or a mirror beyond the
ends ruins a figure over the whole record; what is fitted inside, or predicted beyond, does not. The closed form for
two Morlet waves of finite length (Slavic and Boltezar 2011) needs nothing beyond the ends either, but reads the damping
from its square: at 0.05 % of damping it drowns.
from testbed.outputs import Json
"""

BOUND = f"""\
Rms error of a mode's frequency and damping ratio over the least standard deviation that an unbiased estimator can have.
A record lasts {TIME_CONSTANTS:g} time constants of the decay, {LONGEST:g} s at most; dB are over the whole record.
`poles` is told that nothing changes, `smoother` and `ridge` are not. The ridge has the article's kind of centre
frequency and is cut off the second mode half way between both: at high damping and little noise its error is what its
window blurs, and the ratio grows as the bound falls. A ratio of 20 records is known to 16 %; figures far below 1 belong
to pairs that the bound does not tell apart either, where the fit stays near its start. `poles` begins 0.2 % off.
"""


def study_json(study: Study) -> Json:
    """The content of ``identifier.json``.

    Args:
        study: finished.
    """
    return {
        "seeds": study.seeds,
        "missed": study.missed,
        "verification": [asdict(row) for row in study.rows],
        "searches": [asdict(row) for row in study.searches],
        "runs": [asdict(row) for row in study.runs],
        "tracking": study.tracking,
        "ablation": [asdict(row) for row in study.ablation],
        "bound": [asdict(cell) for cell in study.cells],
    }


def page_of(study: Study, command: str) -> str:
    """The page, in Markdown.

    Args:
        study: finished.
        command: that makes it again.
    """
    verdict = "All bars were met." if not study.missed else "Not met: " + "; ".join(study.missed) + "."
    sections: tuple[tuple[str, str, Iterable[str], str | None], ...] = (
        ("The article's verification", VERIFICATION, _verification(study), "verification"),
        ("The scale and its search", SCALES, _scales(study), "objective"),
        ("The article's ten runs", RUNS, _runs(study), None),
        ("Window and ends", ENDS, _ablation(study), None),
        ("Distance to the Cramer-Rao bound, one mode", BOUND, _bound(study, two_modes=False), "bound_one_mode"),
        ("Two modes", "", _bound(study, two_modes=True), "bound_two_modes"),
    )
    lines = [
        "# The identifier against the article and against the bound",
        "",
        f"Made by `{command}`, {study.seeds} records behind each mean. {verdict}",
    ]
    for title, text, rows, figure in sections:
        picture = [f"![{title}](figures/{figure}.png)", ""] if figure else []
        lines += ["", f"## {title}", "", text, *picture, *rows]
    return "\n".join(lines) + "\n"


def _verification(study: Study) -> Iterator[str]:
    heads = "ridge at 2^6.8 | ridge, optimised | ridge past jumps | smoother | bar | form told | floor | floor, rms"
    yield f"| case | dB | {heads} |"
    yield "|---|---|---|---|---|---|---|---|---|---|"
    for row in study.rows:
        ridges = " | ".join(f"{error:.6f}" for error in (row.multiscale, row.ridge, row.past_jumps))
        told = f"{row.told:.6f} ({row.told / row.mean_floor:.2f} floors)"
        score = f"**{row.smoother:.6f}** | {row.bar:g} | {told} | {row.mean_floor:.6f} | {row.floor:.6f}"
        yield f"| {row.case} | {row.snr_db:g} | {ridges} | {score} |"
    covered = ", ".join(f"{row.covered:.1%} ({row.case}, {row.snr_db:g} dB)" for row in study.rows)
    tracking = ", ".join(f"{TRACKED[name]} {seconds:.2f} s" for name, seconds in study.tracking.items())
    yield ""
    bars = f"{RIDGE_BARS['step']} (step) and {RIDGE_BARS['line']} (line)"
    step = next(row for row in study.rows if (row.case, row.snr_db) == ("step", QUIET))
    gains = " and ".join(
        f"{100.0 * (getattr(step, name) / step.multiscale - 1.0):+.0f} % ({TRACKED[name]})"
        for name in ("ridge", "past_jumps", "smoother")
    )
    yield f"The article gives {bars} for its ridge, at a noise that it does not state."
    yield f"At {QUIET:g} dB our plain ridge has {step.ridge:.4f} on the step: the smear of the jump and the noise"
    yield "together allow no window of one width less. Windows that end at the jumps found have"
    yield f"{step.past_jumps:.4f}. Against the ridge at 2^6.8 these are {gains}; the article's error"
    yield "fell by 16.49 %."
    yield f"From the old level to the new, less a tenth at either end: {tracking};"
    yield "the article's tracking time fell by 26.24 %."
    yield ""
    yield f"The smoother's 95 % interval holds the truth at {covered}"
    yield "of the time: more often than it says, since errors of a constant or a line are the same all along a record,"
    yield "which is held whole or missed whole."


def _scales(study: Study) -> Iterator[str]:
    yield "| case | dB | windows | method | scale | omega_0 | objective | rms error | evaluations |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for row in study.searches:
        windows = "end at jumps" if row.past_jumps else "plain"
        name = f"**{row.method}**" if row.lowest else row.method
        found = f"2^{row.log2_scale:.3f} | {row.centre_frequency:.2f} | {row.value:.4f} | {row.error:.6f}"
        yield f"| {row.case} | {row.snr_db:g} | {windows} | {name} | {found} | {row.evaluations} |"
    methods = list(study.step_search.searches)
    wins = {method: sum(row.lowest for row in study.searches if row.method == method) for method in methods}
    spent = {method: [row.evaluations for row in study.searches if row.method == method] for method in methods}
    yield ""
    yield "Lowest value found: " + ", ".join(f"{method} {number} times" for method, number in wins.items()) + "."
    yield "Evaluations, mean: " + ", ".join(f"{method} {sum(n) / len(n):.0f}" for method, n in spent.items()) + "."
    yield "In the field none is needed: `testbed identify` takes the scale from the course and the noise that the"
    yield "smoother has found (`own_scale`), without a training signal."


def _runs(study: Study) -> Iterator[str]:
    yield "| run | ours: scale | before | after | the article: scale | before | after |"
    yield "|---|---|---|---|---|---|---|"
    for row, (scale, before, after) in zip(study.runs, ARTICLE_RUNS, strict=True):
        yield (
            f"| {row.run} | 2^{row.log2_scale:.3f} | {row.before:.4f} | {row.after:.4f} | 2^{scale:.3f} | {before:.3f} "
            f"| {after:.3f} |"
        )
    scales = [row.log2_scale for row in study.runs]
    yield ""
    yield f"Ours lie between 2^{min(scales):.3f} and 2^{max(scales):.3f}, since each run has other noise. At 256 Hz"
    yield "and 2.01 Hz the article's 2^6.68 samples are a centre frequency omega_0 of 5.07, its earlier 2^6.8 of 5.51."


def _ablation(study: Study) -> Iterator[str]:
    cases = sorted({(row.case, row.snr_db) for row in study.ablation})
    yield "| window | ends | " + " | ".join(f"{case}, {snr:g} dB" for case, snr in cases) + " |"
    yield "|---|---|" + "---|" * len(cases)
    pairs = dict.fromkeys((row.window, row.edges) for row in study.ablation)
    for window, edges in pairs:
        errors = {(r.case, r.snr_db): r.error for r in study.ablation if (r.window, r.edges) == (window, edges)}
        yield f"| {window} | {edges} | " + " | ".join(f"{errors[case]:.6f}" for case in cases) + " |"


def _bound(study: Study, *, two_modes: bool) -> Iterator[str]:
    heads = " | ".join(f"{name}: frequency, ratio" for name in ESTIMATORS)
    yield f"| dB | damping ratio | second mode | record | {heads} |"
    yield "|---|---|---|---|" + "---|" * len(ESTIMATORS)
    for cell in (cell for cell in study.cells if (cell.spacing is not None) == two_modes):
        second = "-" if cell.spacing is None else f"{cell.spacing:.0%} above"
        ratios = " | ".join(_ratios(cell, name) for name in ESTIMATORS)
        yield f"| {cell.snr_db:g} | {100 * cell.damping_ratio:g} % | {second} | {cell.duration:.3g} s | {ratios} |"


def _ratios(cell: Cell, name: str) -> str:
    freq, ratio = cell.ratios[name]
    lost = f" ({cell.lost[name]} lost)" if cell.lost[name] else ""
    return "lost" if freq is None or ratio is None else f"{freq:.3g}, {ratio:.3g}{lost}"
