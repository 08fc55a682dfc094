"""The three simulators on one test, each as coarse as half a percent of error lets it be; writes simulators.md."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import product

from reference_run import FS, nrmse, reference_plant, reference_record, spent, table, write
from threadpoolctl import threadpool_limits

from models.arrays import FloatArray
from models.errors import DivergenceError
from models.record import Record
from models.simulate import Settings, simulate
from models.simulators import simulator
from models.simulators.protocol import Resolution, Trial

SECONDS, ERROR = 1.0, 5e-3
"""Of motion, over which the error is counted."""

LONGER, TIMES = 5.0, 3
"""Seconds of motion that are timed, so that building a model counts as it does in use, and how often."""

PLANT = reference_plant()
RECORD, LONG_RECORD = reference_record(PLANT, SECONDS), reference_record(PLANT, LONGER)


@dataclass(frozen=True)
class Ladder:
    """What is tried of one simulator.

    Attributes:
        run: channels of a record at a number of parts and of steps per sample.
        parts: modes, segments or elements.
        steps: per sample.
        converged: parts and steps that errors are counted from.
    """

    run: Callable[[Record, int, int], FloatArray]
    parts: tuple[int, ...]
    steps: tuple[int, ...]
    converged: tuple[int, int]


def by_modal(record: Record, parts: int, steps: int) -> FloatArray:
    return simulate(PLANT, record, Settings(parts, steps)).channels


def by_engine(name: str) -> Callable[[Record, int, int], FloatArray]:
    engine = simulator(name)
    return lambda record, n, k: engine.run(PLANT, Trial(FS, record.excitation), Resolution(n, k)).channels


LADDERS = {
    "modal": Ladder(by_modal, (5, 6, 7, 8, 10, 12), (1, 2, 3, 4), (40, 64)),
    "mujoco": Ladder(by_engine("mujoco"), (14, 16, 18, 20, 24, 28), (6, 8, 10, 12, 14, 18, 24), (40, 64)),
    "exudyn": Ladder(by_engine("exudyn"), (8, 10, 12, 14, 16), (6, 8, 10, 14, 20), (32, 64)),
}
WORDS = {"modal": "modes", "mujoco": "segments", "exudyn": "elements"}


def coarsest(ladder: Ladder) -> tuple[float, int, int]:
    """(error, parts, steps) of the fewest parts times steps that keep the error."""
    exact = ladder.run(RECORD, *ladder.converged)
    for parts, steps in sorted(product(ladder.parts, ladder.steps), key=lambda row: row[0] * row[1]):
        try:
            error = nrmse(ladder.run(RECORD, parts, steps), exact)
        except DivergenceError:  # longer steps than the engine is stable with
            continue
        if error <= ERROR:
            return error, parts, steps
    raise AssertionError("no rung of the ladder keeps the error")


def test_speed_at_equal_accuracy():
    with threadpool_limits(1):
        chosen = {name: coarsest(ladder) for name, ladder in LADDERS.items()}
        seconds = dict.fromkeys(LADDERS, float("inf"))
        for _ in range(TIMES):  # one after the other, so that the machine's moods meet all alike
            for name, (_, parts, steps) in chosen.items():
                run = partial(LADDERS[name].run, LONG_RECORD, parts, steps)
                seconds[name] = min(seconds[name], spent(run) / LONGER)
    ratios = {name: seconds[name] / seconds["modal"] for name in LADDERS}
    rows = [
        [name, f"{parts} {WORDS[name]}", str(steps), f"{100 * error:.2f}", f"{seconds[name]:.3g}",
         f"{1.0 / seconds[name]:.3g}", f"{ratios[name]:.0f}"]
        for name, (error, parts, steps) in chosen.items()
    ]  # fmt: skip
    head = [
        "simulator",
        "parts",
        "steps per sample",
        "error, %",
        "s per s of motion",
        "times real time",
        "modal faster",
    ]
    page = (
        "# Speed of the three simulators\n\n"
        f"Reference rig, 8 accelerometers at {FS:.0f} Hz under a multisine of 30 N rms, both sleeves struck; each with"
        f" the fewest parts times steps that stay within {100 * ERROR:g} % of its own converged motion."
        f" Processor time of {LONGER:g} s of motion, models built anew, the least of {TIMES} runs taken in turn.\n\n"
        f"{table(head, rows)}"
    )
    content = {
        name: {"error": error, "parts": parts, "steps": steps, "seconds": seconds[name], "ratio": ratios[name]}
        for name, (error, parts, steps) in chosen.items()
    }
    write("benchmarks", "simulators", content, page)
    assert min(ratios["mujoco"], ratios["exudyn"]) > 10.0
