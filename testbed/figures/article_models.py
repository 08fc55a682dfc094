"""Figures 8 to 10 and A1 to A19 of the article's case study: FRFs, their correlation, the identified damping."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from models.arrays import FloatArray
from models.effects.time_varying_damping import TimeVaryingDamping
from testbed.article.compared import Compared
from testbed.article.rig import Geometry
from testbed.article.tables import JUDGE
from testbed.article.three_models import DIAGNOSED, INITIAL, MODELS, UPDATED, ThreeModels
from testbed.article.truth import truth_of
from testbed.article.updating import closed_at_rest, identified_without_error

COLOURS = {INITIAL: "tab:blue", UPDATED: "0.1", DIAGNOSED: "tab:green", "test": "tab:red"}
"""As in the article: the initial model blue, the updated one black, the test red."""

MILLI = 1e3


def frf_figure(found: Compared, points: Mapping[str, str]) -> Figure:
    """|H1| of the test and of the three models at some points.

    Args:
        found: one clearance.
        points: what each is called, by sensor.
    """
    seen = found.seen[JUDGE]
    names = [sensor.name for sensor in seen.rig.sensors]
    figure, panels = _panels(points)
    for ax, (name, title) in zip(panels, points.items(), strict=True):
        row = names.index(name)
        ax.semilogy(seen.frfs.frequency, np.abs(seen.frfs.h1[row]), color=COLOURS["test"], linewidth=2.0, label="test")
        for model in MODELS:
            frfs = found.models[model][JUDGE].frfs
            ax.semilogy(frfs.frequency, np.abs(frfs.h1[row]), color=COLOURS[model], linewidth=0.9, label=model)
        ax.set_title(title, fontsize=9)
        ax.grid(visible=True, color="0.93")
    _labelled(panels)
    return figure


def correlation_figure(found: Compared, what: str) -> Figure:
    """CSAC or CSF of the three models over the frequency, all eight points together.

    Args:
        found: one clearance.
        what: ``csac`` or ``csf``.
    """
    figure = Figure(figsize=(7.2, 3.0), layout="constrained")
    ax = figure.subplots()
    for model in MODELS:
        one = found.models[model][JUDGE]
        ax.plot(one.frfs.frequency, getattr(one, f"{what}_over"), color=COLOURS[model], linewidth=1.0, label=model)
    for freq in found.seen[JUDGE].modes.mean_freqs:
        ax.axvline(freq, color="0.8", linewidth=0.8, zorder=0)
    ax.set(xlabel="frequency [Hz]", ylabel=what.upper(), ylim=(0.0, 1.03))
    ax.set_title(f"{MILLI * found.clearance:g} mm, eight points together; lines: the test's modes", fontsize=9)
    ax.legend(fontsize=8, loc="lower right")
    return figure


def clearances_figure(all_found: Sequence[Compared], points: Mapping[str, str]) -> Figure:
    """|H1| of the tests at all clearances, at some points.

    Args:
        all_found: one a clearance.
        points: what each is called, by sensor.
    """
    figure, panels = _panels(points)
    for ax, (name, title) in zip(panels, points.items(), strict=True):
        for number, found in enumerate(all_found):
            seen = found.seen[JUDGE]
            row = [sensor.name for sensor in seen.rig.sensors].index(name)
            label = f"C{number + 1}: {MILLI * found.clearance:g} mm"
            colour = (0.1, 0.2 + 0.12 * number, 0.9 - 0.14 * number)
            ax.semilogy(seen.frfs.frequency, np.abs(seen.frfs.h1[row]), color=colour, linewidth=0.9, label=label)
        ax.set_title(title, fontsize=9)
        ax.grid(visible=True, color="0.93")
    _labelled(panels)
    return figure


def damping_figure(geometry: Geometry, models: Mapping[float, ThreeModels]) -> Figure:
    """Damping of both sleeves over the test: as identified from soft taps, and as small motion really has it.

    Args:
        geometry: of the rig.
        models: by clearance, m.
    """
    figure = Figure(figsize=(9.0, 2.6 * len(models) ** 0.5 + 2.0), layout="constrained")
    columns = min(3, len(models))
    lines = -(-len(models) // columns)
    panels = figure.subplots(lines, columns, squeeze=False, sharex=True, sharey=True).ravel()
    for ax, (clearance, three) in zip(panels, models.items(), strict=False):
        for sleeve, told in three.identified.items():
            colour = f"C{int(sleeve[-1]) - 1}"
            time, value = np.array(told["time"]), np.array(told["damping"])
            low, high = np.array(told["interval"], float).T
            ax.fill_between(time, low, high, color=colour, alpha=0.25)
            ax.plot(time, value, "o-", color=colour, markersize=3, label=f"{sleeve}, identified")
        for sleeve, (times, values) in _own(geometry, clearance).items():
            ax.plot(times, values, "--", color=f"C{int(sleeve[-1]) - 1}", linewidth=1.0, label=f"{sleeve}, true")
        ax.set_title(f"{MILLI * clearance:g} mm", fontsize=9)
    for ax in panels[-columns:]:
        ax.set_xlabel("time [s]")
    panels[0].set_ylabel("damping [N s/m]")
    panels[0].legend(fontsize=7)
    return figure


def _own(geometry: Geometry, clearance: float) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Times and dampings of small motion, by sleeve that carries the rod, as the truth has them."""
    given, truth = geometry.rig(clearance, "force"), truth_of(geometry, clearance, "force", JUDGE)
    _, effects = identified_without_error(truth, given, closed_at_rest(given))
    tables = [effect for effect in effects if isinstance(effect, TimeVaryingDamping)]
    return {str(table.place.sleeve): (np.array(table.times), np.array(table.values)) for table in tables}


def _panels(points: Mapping[str, str]) -> tuple[Figure, list[Axes]]:
    columns = 2
    lines = -(-len(points) // columns)
    figure = Figure(figsize=(9.0, 2.7 * lines), layout="constrained")
    return figure, list(figure.subplots(lines, columns, squeeze=False, sharex=True).ravel())


def _labelled(panels: Sequence[Axes]) -> None:
    for ax in panels[-2:]:
        ax.set_xlabel("frequency [Hz]")
    for ax in panels[::2]:
        ax.set_ylabel("|H1| [-]")
    panels[0].legend(fontsize=7)
