"""The run that the benchmarks share: the reference rig under a random-phase multisine, 30 N rms from 3 to 250 Hz."""

import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from models.arrays import FloatArray
from models.excitations import random_phase_multisine
from models.plant import Plant, build_plant
from models.record import Record
from models.rig import Rig
from models.rig_file import read_rig

HOUSE = Path(__file__).parents[2]
FS, SECONDS = 2048.0, 10
LOW, HIGH, RMS = 3.0, 250.0, 30.0
SEED = 1


def reference_rig() -> Rig:
    """The reference rig as its file describes it."""
    return read_rig(HOUSE / "tests" / "data" / "reference_rig.toml")


def reference_plant(**sleeves: float) -> Plant:
    """The reference rig, 8 accelerometers, two sleeves, with other numbers of the sleeves if given."""
    rig = reference_rig()
    changed = tuple(sleeve.model_copy(update=sleeves) for sleeve in rig.sleeves)
    return build_plant(rig.model_copy(update={"sleeves": changed}))


def reference_record(plant: Plant, seconds: float = SECONDS) -> Record:
    """A record whose responses are still to be computed."""
    n, names = int(seconds * FS), tuple(sensor.name for sensor in plant.sensors)
    force = random_phase_multisine(np.random.default_rng(SEED), FS, n, 1, LOW, HIGH, RMS)
    return Record("multisine", FS, force, names, np.zeros((len(names), n)))


def nrmse(found: FloatArray, expected: FloatArray) -> float:
    """rms(found - expected) / rms(expected), all channels together."""
    return float(np.sqrt(np.mean((found - expected) ** 2) / np.mean(expected**2)))


def spent(run: Callable[[], object]) -> float:
    """Processor time of a run, s."""
    start = process_time()
    run()
    return process_time() - start


def best_of(times: int, run: Callable[[], object]) -> float:
    """The least processor time of several runs, s; one more, before them, may compile."""
    run()
    return min(spent(run) for _ in range(times))


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def write(folder: str, name: str, content: Mapping[str, Any], page: str) -> None:
    """``results/<folder>/<name>.json`` and ``.md``."""
    target = HOUSE / "results" / folder
    target.mkdir(parents=True, exist_ok=True)
    (target / f"{name}.json").write_text(json.dumps(content, indent=2) + "\n")
    (target / f"{name}.md").write_text(page)
    print(f"\n{page}")
