"""Nonlinear FRFs by harmonic balance beside stepping to a steady state; writes results/benchmarks/harmonic_balance."""

import numpy as np
from reference_run import best_of, table, write

from models.harmonic_balance import from_both_ends
from models.plant import build_plant
from models.record import Record
from models.simulate import simulate
from testbed.article.rig import BAND, calibrated
from testbed.article.sines import AMPLITUDES, FS, THROUGH

CLEARANCES = (5e-5, 5e-4, 2e-3)
SETTLED = 7.5
"""S of motion until it is steady and has been watched, in the mean over the article's rig (results/article)."""

TIMES = 4


def test_a_point_of_a_curve_is_found_faster_than_motion_settles():
    geometry, rows, spent, points = calibrated(), [], 0.0, 0
    for clearance in CLEARANCES:
        for amplitude in AMPLITUDES:
            plant = build_plant(geometry.rig(clearance, "force"))
            curves = from_both_ends(plant, amplitude, THROUGH, BAND)
            seconds = best_of(TIMES, lambda plant=plant, level=amplitude: from_both_ends(plant, level, THROUGH, BAND))
            n = sum(len(curve.freqs) for curve in curves)
            spent, points = spent + seconds, points + n
            rows.append([f"{1e3 * clearance:g}", f"{amplitude:g}", str(n), f"{1e3 * seconds / n:.2f}"])
    plant, time = build_plant(geometry.rig(CLEARANCES[1], "force")), np.arange(round(SETTLED * FS)) / FS
    names = tuple(sensor.name for sensor in plant.sensors)
    wave = AMPLITUDES[1] * np.cos(2.0 * np.pi * 9.0 * time)
    record = Record("sine", FS, wave, names, np.zeros((len(names), len(time))))
    stepped = best_of(TIMES, lambda: simulate(plant, record))
    ratio = stepped / (spent / points)
    page = (
        "# Motion under sines: harmonic balance beside stepping\n\n"
        f"The article's rig from {THROUGH[0]:g} to {THROUGH[1]:g} Hz, around all folds, each point with its stability;"
        f" the least processor time of {TIMES} runs. Stepping {SETTLED:g} s of motion takes our compiled stepper"
        f" {1e3 * stepped:.0f} ms: {ratio:.0f} times a point's {1e3 * spent / points:.2f} ms.\n\n"
        f"{table(['clearance, mm', 'force, N', 'points', 'ms a point'], rows)}"
    )
    content = {"points": points, "seconds_a_point": spent / points, "seconds_stepped": stepped, "ratio": ratio}
    write("benchmarks", "harmonic_balance", content, page)
    assert ratio > 5.0
