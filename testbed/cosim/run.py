"""A co-simulation over files: cosim.json and its picture."""

from pathlib import Path

import numpy as np

from identification.decay.sleeve_poles import ratios_of
from identification.progress import Progress
from testbed.cosim.lockstep import Run, run_in_lockstep
from testbed.cosim.measures import Measures, effect_of, measures_of
from testbed.cosim.plan import Plan, Wish, plan_of
from testbed.figures.cosim import cosim_figure
from testbed.figures.save import save
from testbed.outputs import Json, json_text, staged
from testbed.whole_rig import whole_rig

OFTEN = 0.05
"""Share of estimates that contradict themselves from which on it is said; chance makes a quarter of a percent."""

MATTERS = 0.01
"""Standard deviation, as a share of the damping, from which on a contradiction counts: the steps of the models leave
some that is far smaller, and shows where there is hardly any noise."""


def cosimulate(rig_path: Path, wish: Wish, out: Path, progress: Progress) -> Json:
    """Run plant, identifier and twin, and write what came of it.

    Args:
        rig_path: the rig file.
        wish: what was asked for.
        out: folder of the results.
        progress: told what is being done.

    Returns:
        the content of ``cosim.json``.

    Raises:
        InputError: a rig that cannot be followed: see ``plan_of`` and ``run_in_lockstep``.
    """
    plan = plan_of(whole_rig(rig_path), wish)
    run = run_in_lockstep(plan, progress)
    measures = measures_of(plan, run)
    content = {"rig": rig_path.name, **_plan_json(plan), **_measures_json(measures, run), **_course_json(plan, run)}
    with staged(out) as stage:
        (stage / "cosim.json").write_text(json_text(content), encoding="utf-8")
        save(cosim_figure(plan, run, measures), stage / "figures", "cosim")
    return content


def _plan_json(plan: Plan) -> Json:
    """What was run: every choice, asked for or not."""
    names = [sensor.name for sensor in plan.truth.sensors]
    return {
        "sleeve": plan.sleeve,
        "rest_force": plan.rest_force,
        "start_damping": plan.table.own,
        "seconds": plan.n_samples / plan.fs,
        "fs": plan.fs,
        "window": plan.window,
        "hop": plan.hop / plan.fs,
        "taps": {"period": plan.taps.period, "width": plan.taps.width, "peak": plan.taps.peak},
        "snr": plan.wish.snr,
        "seed": plan.wish.seed,
        "channels": [{"sensor": names[i], "noise": plan.noise[i]} for i in plan.watched],
    }


def _measures_json(measures: Measures, run: Run) -> Json:
    """How far it lagged and erred, and how fast it was."""
    plant, identifier, twin = measures.shares.tolist()
    return {
        "lag": {"by_window": measures.lag, "by_alignment": measures.aligned_lag, "of_channels": run.latency},
        "damping_error": {
            "identified": measures.identified,
            "fed_back": measures.fed_back,
            "fed_back_from": measures.first_exchange,
            "moved_with": measures.moved_with,
            "coverage": measures.coverage,
            "contradicted": float(np.mean(run.exchanges.contradicted)),
        },
        "twin_error": {
            "told": measures.told,
            "alone": measures.alone,
            "times": measures.times,
            "told_over_time": measures.told_over_time,
            "alone_over_time": measures.alone_over_time,
        },
        "real_time_factor": measures.real_time_factor,
        "time_shares": {"plant": plant, "identifier": identifier, "twin": twin},
        "slowest_exchange": measures.slowest,
        "findings": findings(run),
    }


def findings(run: Run) -> list[str]:
    """What a user should know of the estimates.

    Args:
        run: finished.
    """
    got = run.exchanges
    share = float(np.mean(got.contradicted & (got.stds > MATTERS * got.values)))
    if share < OFTEN:
        return []
    text = f"in {share:.0%} of the windows no damping gives all modes their ratios: it changes within a window, or the"
    return [f"{text} rig lacks a damping elsewhere; the intervals are the wider for it"]


def _course_json(plan: Plan, run: Run) -> Json:
    """The modes, the damping over time, and the effect that it makes."""
    got, effect = run.exchanges, effect_of(plan, run.exchanges)
    modes = zip(np.abs(plan.poles) / (2.0 * np.pi), ratios_of(plan.poles), got.shares.mean(axis=0), strict=True)
    return {
        "modes": [{"natural_freq": freq, "damping_ratio": ratio, "share": share} for freq, ratio, share in modes],
        "effect": {"kind": effect.kind, "sleeve": plan.sleeve, "times": effect.times, "values": effect.values},
        "damping": {
            "times": got.times,
            "acts": got.acts,
            "values": got.values,
            "stds": got.stds,
            "low": got.bounds[:, 0],
            "high": got.bounds[:, 1],
            "truth": plan.true_damping(got.times),
        },
    }
