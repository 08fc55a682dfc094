"""Fits whose slopes follow the steps against differences in every iteration; writes results/benchmarks/fit."""

from dataclasses import replace

import numpy as np
from reference_run import FS, RMS, best_of, reference_record, reference_rig, table, write

from identification import fit as fitting
from identification.calibrate import calibrate, unknowns_of
from identification.evaluate import Evaluator, TimeTarget
from identification.fit import Fit
from identification.hypothesis import Hypothesis, at_coordinates
from identification.noise import Noise
from models.plant import build_plant
from models.rig import Rig
from models.simulate import simulate

SECONDS, NOISE = 10.0, 0.005 * RMS
"""Length of the record, s, and noise of each sensor, m/s^2."""

STARTS, TIMES, ALIKE = 6, 3, 1.0
"""Rigs to be found, runs of each, and how much more chi-square and prior may be left: a standard deviation's worth."""

NEVER = 1.0
"""Of ``FOLLOWED_SHARE``: no step brings exactly what it promised."""


def test_slopes_that_follow_the_steps_save_most_differences(monkeypatch):
    rig = reference_rig()
    rows = []
    for seed in range(STARTS):
        evaluator = asked_about(rig, seed)
        followed, n_after, after = calibrated(evaluator, rig)
        with monkeypatch.context() as patched:
            patched.setattr(fitting, "FOLLOWED_SHARE", NEVER)
            anew, n_before, before = calibrated(evaluator, rig)
        rows.append((n_before, n_after, before, after, followed.cost - anew.cost))
    head = ["rig", "simulations, differences in every iteration", "followed", "time, share", "cost at the end, more by"]
    lines = [
        [f"{k}", f"{before}", f"{after}", f"{new / old:.2f}", f"{more:.2g}"]
        for k, (before, after, old, new, more) in enumerate(rows)
    ]
    page = (
        "# Fits whose slopes follow their steps\n\n"
        f"The reference rig's numbers, each off by a standard deviation or so, fitted to {SECONDS:g} s of eight "
        f"channels at {FS:g} Hz with noise of {NOISE:g} m/s^2: simulations of the whole record, and processor time "
        f"with those of its beginnings, the least of {TIMES} runs.\n\n"
        f"{table(head, lines)}"
    )
    write("benchmarks", "fit", {"rows": rows}, page)
    assert max(more for *_, more in rows) < ALIKE
    assert sum(n_after for _, n_after, *_ in rows) < sum(n_before for n_before, *_ in rows)


def asked_about(rig: Rig, seed: int) -> Evaluator:
    """A record of the rig with other numbers, and noise."""
    rng, given = np.random.default_rng(seed), Hypothesis(rig)
    record = reference_record(build_plant(rig), SECONDS)
    blank = Evaluator([_target(record)], 1)
    unknowns = unknowns_of(given, blank)
    truth = at_coordinates(given, unknowns, rng.standard_normal(len(unknowns)))
    channels = simulate(truth.plant(), record).channels
    noise = NOISE * rng.standard_normal(channels.shape)
    return Evaluator([_target(replace(record, responses=channels + noise))], 1)


def _target(record):
    return TimeTarget.of(record, Noise(NOISE * np.ones(len(record.sensors)), 0.0, "as added", "none"))


def calibrated(evaluator: Evaluator, rig: Rig) -> tuple[Fit, int, float]:
    """The fit, how often it simulated the whole record, and the processor time it took, s."""
    given, before = Hypothesis(rig), evaluator.n_runs
    found = calibrate(evaluator, given, unknowns_of(given, evaluator))
    n_runs = evaluator.n_runs - before
    return found, n_runs, best_of(TIMES, lambda: calibrate(evaluator, given, found.unknowns))
