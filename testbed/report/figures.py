"""The figures of a report, from the finished values of a diagnosis."""

from collections.abc import Sequence
from textwrap import wrap

import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from identification.result import Diagnosis, ErrorMap, FrfScore, MissingForce, RecordScore, Score, Stage
from models.errors import InputError
from models.rig import Rig
from testbed.compare import FrfPair, frf_pair, score_frfs
from testbed.figures.frf import tells
from testbed.figures.report_calibration import plot_pulls
from testbed.figures.report_errors import plot_error_steps, plot_holdout
from testbed.figures.report_force import plot_force_in_time, plot_force_over
from testbed.figures.report_frf import Curve, plot_coherence_strip, plot_frfs
from testbed.figures.report_maps import plot_frequency_map, plot_time_map
from testbed.figures.report_style import COLOURS, literal
from testbed.quantities import frf_unit, unit_of
from testbed.report.picture import Picture, picture
from testbed.report.rows import Pulls
from testbed.report.words import at, number, percent, stage_kind

DETAILED = 4
"""Records shown in figures: the strongest, the weakest and others between, so that the page stays small."""

SENSORS = 8
"""Sensors whose FRFs are shown of one record: those that the given model misses most."""

DOTS = 6000
"""Samples of a force shown against the motion."""

WIDTH = 9.6
"""Inches; heights follow the content."""

FRF_HEIGHT, FRF_MARGIN = 1.85, 0.6


def shown_records(diagnosis: Diagnosis) -> tuple[str, ...]:
    """Names of the records shown in figures, the strongest first."""
    rows = sorted(diagnosis.final.score.records, key=_level, reverse=True)
    chosen = np.unique(np.linspace(0, len(rows) - 1, min(DETAILED, len(rows))).round().astype(int))
    return tuple(rows[i].record.name for i in chosen)


def _level(row: RecordScore) -> float:
    force = row.record.excitation
    return 0.0 if force is None else float(np.sqrt(np.mean(force**2)))


def error_steps(diagnosis: Diagnosis) -> Picture:
    """The error of each model against the noise floor."""
    stages = diagnosis.stages
    figure = Figure(figsize=(WIDTH, 3.6), layout="constrained")
    ax = figure.subplots()
    labels = [_wrapped(stage.label, len(stages)) for stage in stages]
    errors = np.array([stage.score.nrmse for stage in stages])
    noise = diagnosis.final.score.noise_nrmse
    plot_error_steps(ax, labels, errors, noise, [COLOURS[stage_kind(diagnosis, stage)] for stage in stages])
    aside = [(0, diagnosis.holdout.get("as given")), (len(stages) - 1, diagnosis.holdout.get("updated"))]
    held = [(place, score) for place, score in aside if score is not None]
    if held:
        plot_holdout(
            ax, [place for place, _ in held], np.array([score.nrmse for _, score in held]), held[-1][1].noise_nrmse
        )
    figure.legend(loc="outside upper right", ncols=2)
    alt = "; ".join(f"{stage.label}: {percent(stage.score.nrmse)}" for stage in stages)
    return picture(figure, f"Error by model: {alt}", "The error from model to model, against the noise floor.", "svg")


def _wrapped(label: str, n: int) -> str:
    """A label as wide as one of ``n`` may be, lines broken before a place if that is enough."""
    width = max(SHORTEST_LABEL, LABELS_WIDE // n)
    broken = label.replace(" at ", "\nat ").replace(" on ", "\non ").splitlines()
    return "\n".join(line for part in broken for line in wrap(part, width))


LABELS_WIDE, SHORTEST_LABEL = 100, 11
"""Letters of all labels side by side; of one, where there are many."""


def frf_pictures(diagnosis: Diagnosis, rig: Rig) -> list[Picture]:
    """Measured, given and final FRFs of each record shown; a record without excitation or too short has none."""
    models = [diagnosis.stages[0]] + ([diagnosis.final] if len(diagnosis.stages) > 1 else [])
    at_rest = (row.record.name for row in diagnosis.final.score.at_rest if isinstance(row, FrfScore))
    return [
        _frf_picture(pairs, models, diagnosis, rig)
        for name in (*shown_records(diagnosis), *at_rest)
        if (pairs := [pair for stage in models if (pair := _pair(stage, name)) is not None])
    ]


def _pair(stage: Stage, name: str) -> FrfPair | None:
    for frfs in stage.score.at_rest:
        if isinstance(frfs, FrfScore) and frfs.record.name == name:
            return frf_pair(frfs.record, frfs.predicted)
    rows = tuple(row for row in stage.score.records if row.record.name == name)
    try:
        return next(iter(score_frfs(Score(rows))), None)
    except InputError:
        return None


def _frf_picture(pairs: Sequence[FrfPair], models: Sequence[Stage], diagnosis: Diagnosis, rig: Rig) -> Picture:
    measured = pairs[0]
    coherence = measured.coherence if tells(measured.coherence) else None
    misses = np.linalg.norm(np.abs(pairs[0].predicted) - np.abs(measured.measured), axis=1)
    misses /= np.linalg.norm(measured.measured, axis=1)
    chosen = sorted(np.argsort(misses)[::-1][:SENSORS])
    columns = min(2, len(chosen))
    rows = -(-len(chosen) // columns)
    height = FRF_HEIGHT * rows + FRF_MARGIN
    figure = Figure(figsize=(WIDTH, height))
    edges = {"left": 0.055, "right": 0.98, "bottom": 0.45 / height, "top": 1.0 - 0.5 / height}
    grid = figure.add_gridspec(rows, columns, hspace=0.42, wspace=0.11, **edges)
    for k, i in enumerate(chosen):
        cell = grid[k // columns, k % columns]
        pair_grid = cell.subgridspec(2, 1, height_ratios=(4, 1), hspace=0.12)
        top = lowest = figure.add_subplot(cell if coherence is None else pair_grid[0])
        curves = [
            Curve(stage.label, COLOURS[stage_kind(diagnosis, stage)], pair.predicted[i])
            for stage, pair in zip(models, pairs, strict=False)
        ]
        title = f"{measured.sensors[i]}  [{frf_unit(rig, measured.sensors[i])}]"
        plot_frfs(top, measured.frequency, measured.measured[i], curves, title)
        if coherence is not None:
            lowest = figure.add_subplot(pair_grid[1], sharex=top)
            plot_coherence_strip(lowest, measured.frequency, coherence[i])
        lowest.tick_params(labelbottom=True)
        if k >= len(chosen) - columns:
            lowest.set_xlabel("frequency [Hz]")
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="upper center", ncols=len(labels))
    left_out = len(measured.sensors) - len(chosen)
    omitted = f" {left_out} sensors that the given model misses less are left out." if left_out else ""
    strips = "" if coherence is None else ", and below each the coherence of the measurement (shaded)"
    return picture(figure, f"FRFs of {measured.record}", f"{measured.record}: FRF magnitude{strips}.{omitted}")


def map_pictures(diagnosis: Diagnosis, rig: Rig) -> list[Picture]:
    """Error maps of each record shown, before and after, the strongest level first."""
    after = {found.record: found for found in diagnosis.updated_maps if diagnosis.final.hypothesis.effects}
    sensors = {row.record.name: row.record.sensors for row in diagnosis.final.score.records}
    before = {found.record: found for found in diagnosis.where if found.record in sensors}
    names = sorted(set(shown_records(diagnosis)) & set(before), key=lambda name: -before[name].level)
    return [_map_picture(before[name], after.get(name), sensors[name], diagnosis, rig) for name in names]


def _map_picture(
    before: ErrorMap, after: ErrorMap | None, sensors: Sequence[str], diagnosis: Diagnosis, rig: Rig
) -> Picture:
    models = [("calibrated", before)] + ([(diagnosis.final.label, after)] if after is not None else [])
    values = np.concatenate([m.by_frequency.ravel() for _, m in models] + [m.by_time.ravel() for _, m in models])
    high = max(float(values.max()), SMALLEST_ERROR)
    norm = LogNorm(vmin=max(high / COLOUR_RANGE, SMALLEST_ERROR / COLOUR_RANGE), vmax=high)
    figure = Figure(figsize=(WIDTH, len(models) * (0.9 + 0.17 * len(sensors)) + 0.3), layout="constrained")
    axes = figure.subplots(len(models), 2, squeeze=False)
    for row, (label, found) in enumerate(models):
        plot_frequency_map(
            axes[row, 0], found.frequency, sensors, error=found.by_frequency, noise=found.noise_by_frequency, norm=norm
        )
        mesh = plot_time_map(axes[row, 1], found.time, sensors, found.by_time, norm)
        axes[row, 0].set_title(literal(label), loc="left")
    figure.colorbar(mesh, ax=axes, label="error / rms of the channel", shrink=0.9, pad=0.01)
    unit = "" if rig.excitation is None else f" {unit_of(rig.excitation.quantity)} rms"
    level = f"level {number(before.level)}{unit}" if before.level > 0 else "free decay"
    return picture(
        figure,
        f"Error maps of {before.record}",
        f"{before.record}, {level}: error of each sensor by frequency band and over time. Grey cells on the left: "
        "the noise explains them. Over time, on the right, the error holds the noise too.",
    )


SMALLEST_ERROR, COLOUR_RANGE = 1e-6, 300.0


def force_pictures(diagnosis: Diagnosis, rig: Rig) -> list[Picture]:
    """The missing force at each place, one row a record, the place with the largest force first."""
    forces = [force for force in diagnosis.missing_forces if force.record in shown_records(diagnosis)]
    places = list(dict.fromkeys(force.place for force in forces))
    size = {place: max(float(f.force.std()) for f in forces if f.place == place) for place in places}
    return [
        _force_picture(place, [force for force in forces if force.place == place], rig)
        for place in sorted(places, key=lambda place: -size[place])
    ]


def _force_picture(place: str, forces: Sequence[MissingForce], rig: Rig) -> Picture:
    figure = Figure(figsize=(WIDTH, 2.4 * len(forces) + 0.2), layout="constrained")
    axes = figure.subplots(len(forces), 3, squeeze=False, sharey="row")
    walls = tuple(1e3 * side * s.clearance for s in rig.sleeves if s.name == place for side in (-1.0, 1.0))
    for row, found in enumerate(forces):
        n = len(found.force)
        time = np.arange(n) / found.fs
        kept = slice(None, None, -(-n // DOTS))
        shown = found.force[kept], time[kept]
        plot_force_over(axes[row, 0], 1e3 * found.q[kept], *shown, label="displacement [mm]", walls=walls)
        dots = plot_force_over(axes[row, 1], 1e3 * found.v[kept], *shown, label="velocity [mm/s]")
        plot_force_in_time(axes[row, 2], time, found.force)
        axes[row, 0].set_ylabel("missing force [N]")
        axes[row, 0].set_title(literal(f"{found.record}: {number(float(found.force.std()))} N rms"), loc="left")
        figure.colorbar(dots, ax=axes[row, 2], label="time [s]", pad=0.02)
    dotted = " Dotted: the sleeve's walls as given." if walls else ""
    return picture(
        figure,
        f"Missing force {at(place)}",
        f"{at(place).capitalize()}: the force on the structure that the calibrated model lacks.{dotted}",
    )


def pulls_picture(found: Pulls) -> Picture:
    """Calibrated numbers in standard deviations of their tolerances."""
    figure = Figure(figsize=(WIDTH, 0.24 * len(found.labels) + 0.7), layout="constrained")
    plot_pulls(figure.subplots(), found.labels, found.pulls, found.stds)
    caption = "Calibrated numbers against the tolerances of the rig file; shaded: one and two standard deviations."
    return picture(figure, "Calibrated numbers", caption, "svg")
