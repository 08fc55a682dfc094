"""The identifier's study: all that is computed, before it is written down."""

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

from identification.decay.scale_search import ScaleSearch
from identification.progress import Progress
from testbed.identifier_study.bound_table import Cell, bound_table
from testbed.identifier_study.searches import (
    AblationRow,
    RunRow,
    SearchRow,
    ablation_rows,
    all_searches,
    grid_shares,
    scales_of,
    search_rows,
    ten_runs,
    tracking_time,
)
from testbed.identifier_study.verification import RIDGE_BARS, Row, Trace, trace_of, verification_rows

JUMP = (0.06, 0.01, 50.0)
"""The step's levels, N s/m, and its time, s."""

QUIET = 60.0
"""dB, the noise at which the article's figures are taken."""


@dataclass(frozen=True, eq=False)
class Study:
    """All that was computed.

    Attributes:
        rows: of the verification.
        searches: every method on every training record.
        step_search: of the plain ridge on the step at 60 dB, for its objective.
        shares: of error and cost in its objective on the grid: see ``grid_shares``.
        runs: ten quantum searches.
        ablation: windows and ends.
        cells: distance to the bound.
        traces: one record of each case at each noise.
        tracking: method -> seconds to follow the step at 60 dB.
        seeds: records behind each mean.
    """

    rows: Sequence[Row]
    searches: Sequence[SearchRow]
    step_search: ScaleSearch
    shares: Sequence[tuple[float, float, float]]
    runs: Sequence[RunRow]
    ablation: Sequence[AblationRow]
    cells: Sequence[Cell]
    traces: Sequence[Trace]
    tracking: dict[str, float]
    seeds: int

    @property
    def missed(self) -> list[str]:
        """Bars that were not met, in words."""
        smoother = [
            f"{row.case} at {row.snr_db:g} dB: {row.smoother:.2g} against {row.bar:g} N s/m"
            for row in self.rows
            if row.smoother > row.bar
        ]
        told = [
            f"{row.case} at {row.snr_db:g} dB, form told: {row.told / row.mean_floor:.2f} times the floor against 1.5"
            for row in self.rows
            if row.told > 1.5 * row.mean_floor
        ]
        ridge = [
            f"ridge past jumps, {row.case}: {row.past_jumps:.2g} against {RIDGE_BARS[row.case]:g} N s/m"
            for row in self.rows
            if row.snr_db == QUIET and row.past_jumps > RIDGE_BARS[row.case]
        ]
        return smoother + told + ridge


def identifier_study(seeds: int, pool: Executor, progress: Progress) -> Study:
    """Compute everything.

    Args:
        seeds: records behind each mean.
        pool: processes.
        progress: told what is being done.
    """
    progress("searching scales: four methods on eight training records")
    found = all_searches(pool)
    scales = scales_of(found)
    progress("ten runs of the quantum search")
    runs = list(ten_runs(pool))
    progress(f"verification: {seeds} records of each case and noise")
    rows = list(verification_rows(scales, seeds, pool))
    progress("windows and ends")
    ablation = list(ablation_rows(scales, max(seeds // 4, 2), pool))
    cells: list[Cell] = []
    for cell in bound_table(seeds, pool):
        cells.append(cell)
        if len(cells) % 10 == 0:
            progress(f"distance to the bound: {len(cells)} cells")
    traces = [trace_of(case, snr, own, 0) for (case, snr), own in scales.items()]
    step = next(trace for trace in traces if (trace.case, trace.snr_db) == ("step", QUIET))
    tracking = {
        name: tracking_time(step.time, getattr(step, name), *JUMP)
        for name in ("multiscale", "ridge", "past_jumps", "smoother")
    }
    search = found["step", QUIET, False]
    shares = grid_shares(search, "step", QUIET)
    searches = list(search_rows(found))
    return Study(rows, searches, search, shares, runs, ablation, cells, traces, tracking, seeds)
