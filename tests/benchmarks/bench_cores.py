"""Residuals on one core, in threads and with companions; writes results/benchmarks/cores."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from time import perf_counter

import numpy as np
from reference_run import FS, RMS, reference_record, reference_rig, table, write

from identification.evaluate import Evaluator, TimeTarget
from identification.hypothesis import Hypothesis, RigUnknown
from identification.noise import Noise
from models.plant import build_plant
from models.rig import Rig
from models.simulate import simulate

CORES, TIMES = 2, 5
LENGTHS = (0.5, 2.0, 10.0)
"""Seconds of the record: of the beginning in which most suspects are fitted, and of whole tests."""

SIZES = tuple(0.1 * k for k in range(-5, 6))
"""Of each toleranced number, in standard deviations."""

BEGUN = 8.0
"""Seconds within which a companion has begun and has loaded what it runs."""


def test_a_companion_beats_a_thread_where_records_are_short():
    rig = reference_rig()
    rows = {seconds: spent_on(rig, seconds) for seconds in LENGTHS}
    head = ["seconds of the record", "ms a residual, one core", f"{CORES} threads, times", "with a companion, times"]
    lines = [
        [f"{seconds:g}", f"{one:.2f}", f"{one / threads:.2f}", f"{one / beside:.2f}"]
        for seconds, (one, threads, beside) in rows.items()
    ]
    page = (
        "# Residuals on two cores\n\n"
        f"Hypotheses about the reference rig against records at {FS:g} Hz; the least time of {TIMES} runs in turn.\n\n"
        f"{table(head, lines)}"
    )
    write("benchmarks", "cores", {"ms": {f"{seconds:g} s": row for seconds, row in rows.items()}}, page)
    _, threads, beside = rows[LENGTHS[0]]
    assert beside < threads


def spent_on(rig: Rig, seconds: float) -> tuple[float, float, float]:
    """ms a residual on one core, in threads, and with a companion."""
    plant = build_plant(rig)
    record = reference_record(plant, seconds)
    record = replace(record, responses=simulate(plant, record).channels)
    noise = 0.005 * RMS * np.ones(len(record.sensors))
    target = TimeTarget.of(record, Noise(noise, 0.0, "as assumed", "none"))
    alone, shared = (Evaluator([target], jobs) for jobs in (1, CORES))
    given = Hypothesis(rig)
    asked = [(RigUnknown(number).set(given, x), None) for number in rig.parameters() for x in SIZES]
    with ThreadPoolExecutor(CORES) as pool:
        runs = (
            lambda: alone.residuals(asked),
            lambda: list(pool.map(lambda each: alone.residuals([each]), asked)),
            lambda: shared.residuals(asked),
        )
        until = perf_counter() + BEGUN
        while perf_counter() < until:
            shared.residuals(asked)
        taken = [[_timed(run) for run in runs] for _ in range(1 + TIMES)]  # in turn: the machine's moods meet all alike
    one, threads, beside = (1e3 * float(least) / len(asked) for least in np.min(taken[1:], axis=0))
    return one, threads, beside


def _timed(run):
    began = perf_counter()
    run()
    return perf_counter() - began
