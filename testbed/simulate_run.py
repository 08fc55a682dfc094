"""A virtual experiment over files: records, the truth in a file of its own, what the simulator did, and pictures."""

import hashlib
import json
from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

from identification.progress import Progress
from models.effects import entry_of
from models.errors import InputError, in_file
from models.plant import Plant
from models.rig import Rig
from models.simulators import simulator
from models.simulators.protocol import Motion, Resolution
from testbed import __version__
from testbed.figures.contact import contact_figure, orbit_figure
from testbed.figures.save import save
from testbed.inputs import sha256
from testbed.outputs import Json, check_open, json_text, staged
from testbed.processes import as_done
from testbed.records.write import node_at, write_record
from testbed.virtual.campaign import Run, runs_of
from testbed.virtual.experiment import Experiment, read_experiment
from testbed.virtual.laboratory import Laboratory, carry_out, laboratory_of
from testbed.virtual.truth_file import on_the_same_rig, read_truth
from testbed.whole_rig import whole_rig

TRUTH, SIMULATION = "truth.toml", "simulation.json"


@dataclass(frozen=True)
class Order:
    """What was asked for.

    Attributes:
        rig_path: the rig file.
        experiment_path: the experiment.
        simulator: by name.
        resolution: how finely.
        suffix: of the records.
        truth_path: truth of an earlier test, whose rig this one is carried out on; None for the experiment's own.
        prefix: before the names of the records.
        seed: in place of the experiment's; None for that.
    """

    rig_path: Path
    experiment_path: Path
    simulator: str
    resolution: Resolution
    suffix: str
    truth_path: Path | None = None
    prefix: str = ""
    seed: int | None = None

    def digest(self) -> str:
        """By which a run that was stopped is known again."""
        asked = [__version__, sha256(self.rig_path), sha256(self.experiment_path), self.simulator, self.resolution]
        asked += [None if self.truth_path is None else sha256(self.truth_path), self.prefix, self.seed]
        return hashlib.sha256(repr(asked).encode()).hexdigest()


def run_experiment(order: Order, out: Path, *, jobs: int, progress: Progress, pool: Executor | None = None) -> Json:
    """Carry out an experiment, each record written as it is done; records that are there already are kept.

    Args:
        order: what was asked for.
        out: folder of the results.
        jobs: processes.
        progress: told what is being done.
        pool: processes that several experiments share, or None.

    Returns:
        the content of ``simulation.json``.

    Raises:
        InputError: a rig, an experiment or a simulator that do not fit together, or a folder that cannot be written.
        ArithmeticError: the motion left the finite numbers.
    """
    rig, experiment, runs, laboratory = _planned(order)
    for run in runs:
        simulator(order.simulator).check(laboratory.plant, order.resolution, run.trial.angle)
        _check_format(run, rig, order.suffix)
    _check_alone(out, order, runs)
    check_open(out, [f"{run.name}{order.suffix}" for run in runs])
    known = _known(out, order)
    todo = [number for number, run in enumerate(runs) if run.name not in known]
    if len(todo) < len(runs):
        progress(f"{len(runs) - len(todo)} of {len(runs)} records were there already; kept")
    for done, (number, row) in enumerate(as_done(partial(one_run, order, out), todo, jobs, pool), start=1):
        known[runs[number].name] = row
        with staged(out) as stage:
            content = _content(order, [known[run.name] for run in runs if run.name in known])
            (stage / SIMULATION).write_text(json_text(content), encoding="utf-8")
        progress(f"{done} of {len(todo)}: {row['record']}, {row['seconds_of_motion']:.3g} s of motion; {_briefly(row)}")
    with staged(out) as stage:
        (stage / TRUTH).write_text(tomlkit.dumps(_truth(laboratory, experiment, order)), encoding="utf-8")
    return _content(order, [known[run.name] for run in runs])


def _planned(order: Order) -> tuple[Rig, Experiment, tuple[Run, ...], Laboratory]:
    """What is to be done, on which rig."""
    rig, experiment = whole_rig(order.rig_path), read_experiment(order.experiment_path)
    if order.seed is not None:
        experiment = experiment.model_copy(update={"seed": order.seed})
    known = None if order.truth_path is None else read_truth(order.truth_path)
    with in_file(order.experiment_path.name):
        runs, laboratory = runs_of(experiment, rig), laboratory_of(experiment, rig)
        if known is not None:
            laboratory = on_the_same_rig(laboratory, experiment, known)
    return rig, experiment, tuple(replace(run, name=f"{order.prefix}{run.name}") for run in runs), laboratory


def _briefly(row: Json) -> str:
    """The last choice of a run without its reason, which is told once for all runs."""
    return str(row["choices"][-1]).partition(":")[0]


def _check_format(run: Run, rig: Rig, suffix: str) -> None:
    """Refuse, before anything moves, a place of the force that the records' format cannot tell."""
    at = run.trial.position
    if suffix == ".uff" and at is not None and node_at(rig, at) is None:
        raise InputError(
            f"{run.name}: the force acts at {at:g} m, where no sensor has a node",
            "a UFF file says by a node where a roving hammer strikes",
            "write --format h5, or strike where a sensor with a node is",
        )


def _check_alone(out: Path, order: Order, runs: Sequence[Run]) -> None:
    """Refuse a folder in which records of another experiment would be left beside this one's truth."""
    ours = {f"{run.name}{order.suffix}" for run in runs}
    _, rows = _left_by_the_last(out)
    left = [row["record"] for row in rows if row["record"] not in ours and (out / row["record"]).is_file()]
    if left:
        raise InputError(
            f"--out {out}: it holds {left[0]} of another experiment",
            "a folder holds the records of one experiment, and its truth",
            "name another folder with --out, or remove that one",
        )


def _known(out: Path, order: Order) -> dict[str, Json]:
    """Rows of the records that an earlier run of the same order left whole."""
    made_for, rows = _left_by_the_last(out)
    files = [(row, out / row["record"]) for row in rows if made_for == order.digest()]
    return {file.stem: row for row, file in files if file.is_file() and sha256(file) == row["sha256"]}


def _left_by_the_last(out: Path) -> tuple[str, list[Json]]:
    """Digest of the order that a folder's records were made for, and their rows; none where there is no such file."""
    try:
        content = json.loads((out / SIMULATION).read_text(encoding="utf-8"))
        return content["order"], [row for row in content["records"] if row["record"] and row["sha256"]]
    except (OSError, ValueError, KeyError, TypeError):
        return "", []


def _content(order: Order, rows: Sequence[Json]) -> Json:
    return {
        "simulator": order.simulator,
        "rig": order.rig_path.name,
        "experiment": order.experiment_path.name,
        "order": order.digest(),
        "records": list(rows),
    }


def one_run(order: Order, out: Path, number: int) -> Json:
    """Carry out one run and write its record and picture.

    Args:
        order: what was asked for.
        out: folder of the results.
        number: of the run.
    """
    rig, _, runs, laboratory = _planned(order)
    run = runs[number]
    record, motion = carry_out(laboratory, run, number, order.simulator, order.resolution)
    file = f"{run.name}{order.suffix}"
    with staged(out) as stage:
        write_record(record, rig, stage / file)
        if motion.gaps.size:
            save(contact_figure(motion, laboratory.plant, run.name), stage / "figures", run.name)
            if motion.across is not None:
                save(orbit_figure(motion, laboratory.plant, run.name), stage / "figures", f"{run.name}-orbit")
    at_end = laboratory.at_their_ends(record)
    return {"record": file, "sha256": sha256(out / file), **_row(run, motion, laboratory.plant), "clipped": at_end}


def _row(run: Run, motion: Motion, plant: Plant) -> Json:
    """What the simulator did, in numbers."""
    closed = motion.gaps < 0.0
    contacts = [
        {
            "sleeve": contact.sleeve,
            "share_closed": float(shut.mean()),
            "impacts": int(np.sum(shut[1:] & ~shut[:-1])),
            "largest_force": float(force.max()),
            "deepest": float(max(0.0, -gap.min())),
        }
        for contact, shut, force, gap in zip(plant.contacts, closed, motion.pushes, motion.gaps, strict=True)
    ]
    return {
        "seconds_of_motion": run.trial.n_samples / run.trial.fs,
        "choices": list(motion.choices),
        "energy_fault": motion.energy.fault,
        "contacts": contacts,
    }


def _truth(laboratory: Laboratory, experiment: Experiment, order: Order) -> tomlkit.TOMLDocument:
    """What was really tested, for whoever wants to see how close a diagnosis came."""
    document = tomlkit.document()
    document.add(
        tomlkit.comment(
            "What these records were made with; only testbed simulate --truth and the end of the demo read this file."
        )
    )
    document.add("simulator", tomlkit.item(order.simulator))
    document.add("seed", tomlkit.item(experiment.seed))
    if order.resolution.spatial:
        document.add("spatial", tomlkit.item(value=True))
        document.add("angle", tomlkit.item(getattr(experiment.excitation, "angle", 0.0)))
    numbers = {p.path: float(f"{p.value:.8g}") for p in laboratory.built.parameters()}
    document.add("parameters", tomlkit.item(numbers))
    places = {s.name: s.position for s in laboratory.built.sensors if s.position is not None}
    document.add("sensor_positions", tomlkit.item(places))
    document.add("effects", tomlkit.item([_table(entry_of(effect)) for effect in laboratory.hidden]))
    return document


def _table(entry: Any) -> Json:
    content: Json = entry.model_dump(exclude_none=True)
    return {key: list(value) if isinstance(value, tuple) else value for key, value in content.items()}
