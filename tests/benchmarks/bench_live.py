"""The live model, block by block, beside the whole record at once; writes results/benchmarks/live."""

import numpy as np
from reference_run import FS, RMS, SECONDS, reference_plant, reference_record, spent, table, write

from models.live import LiveModel
from models.simulate import simulate

BLOCKS = (20, 205, 1024)
"""Samples: a hundredth, a tenth and half of a second."""

TIMES = 5


def test_a_live_model_costs_a_few_times_what_a_record_does():
    plant = reference_plant()
    record = reference_record(plant)
    force, peak = record.excitation, float(np.abs(record.excitation).max())

    def live(size: int) -> None:
        model = LiveModel.of(plant, FS, peak=peak)
        for start in range(0, len(force), size):
            model.advance(force[start : start + size])

    runs = {"the whole record": lambda: simulate(plant, record)}
    runs |= {f"blocks of {size} samples": lambda size=size: live(size) for size in BLOCKS}
    costs = {name: [] for name in runs}
    for _ in range(1 + TIMES):  # in turn, so that the machine's moods meet all alike; the first compiles
        for name, run in runs.items():
            costs[name].append(spent(run))
    seconds = {name: min(several[1:]) for name, several in costs.items()}
    whole = seconds["the whole record"]
    rows = [[name, f"{SECONDS / value:.0f}", f"{value / whole:.2f}"] for name, value in seconds.items()]
    page = (
        "# Speed of the live model\n\n"
        f"The reference rig with 8 sensors at {FS:g} Hz, {SECONDS} s of a multisine of {RMS:g} N rms on one core;"
        f" building the model counts. The least processor time of {TIMES} runs in turn.\n\n"
        f"{table(['run', 'times real time', 'cost, ratio'], rows)}"
    )
    write("benchmarks", "live", {"seconds": seconds}, page)
    assert seconds[f"blocks of {BLOCKS[1]} samples"] < 3.0 * whole
