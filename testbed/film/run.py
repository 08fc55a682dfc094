"""``testbed film``: from a record or an experiment to its moving pictures."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from PIL import Image

from identification.progress import Progress
from models.errors import InputError, in_file
from models.plant import Plant, build_plant
from models.record import Record
from models.rig import Beam, Rig
from models.simulators import simulator
from models.simulators.protocol import Resolution, Trial
from testbed.figures.film import frames
from testbed.film.glb import magnification, moving_glb
from testbed.film.take import Stretch, Take, length_of_stretch, stretch_that_matters, take
from testbed.outputs import json_text, staged
from testbed.records.read import read_record
from testbed.virtual.campaign import runs_of
from testbed.virtual.experiment import read_experiment
from testbed.virtual.laboratory import laboratory_of
from testbed.whole_rig import whole_rig

FRAMES, PER_SECOND = 160, 20
"""Frames, and how many of them are shown in a second."""

COLOURS = 48


@dataclass(frozen=True)
class Order:
    """What was asked for.

    Attributes:
        rig_path: the rig file.
        path: a record, or an experiment (.toml), whose first run is filmed.
        simulator: by name.
        first, last: of the stretch, s; None leaves the choice to the program.
        magnified: factor on deflections, or None.
        without: channels of the record to leave out.
    """

    rig_path: Path
    path: Path
    simulator: str
    first: float | None = None
    last: float | None = None
    magnified: float | None = None
    without: Sequence[str] = ()


def film(order: Order, out: Path, progress: Progress) -> dict[str, Any]:
    """Move the rig as it was driven, and write ``NAME.gif``, ``NAME.glb`` and ``film.json``.

    Args:
        order: what was asked for.
        out: folder of the results.
        progress: told what is being done.

    Returns:
        the content of ``film.json``.

    Raises:
        InputError: an oscillator, a record that does not say what drove the rig from rest on, what the simulator cannot
            carry, or a stretch that the record does not have.
        DivergenceError: the motion was lost.
    """
    rig = whole_rig(order.rig_path)
    if not isinstance(rig.structure, Beam):
        raise InputError(
            f"{order.rig_path.name}: structure.kind = 'oscillator'", "a film shows how a beam bends", "film a beam"
        )
    plant, trial, name, driven = _acted(order.path, rig, order.without)
    simulator(order.simulator).check(plant, Resolution())
    stretch = _stretch(order, plant, trial)
    progress(f"{order.simulator}: moving the rig up to {stretch.last:.4g} s")
    taken, motion = take(plant, trial, stretch, order.simulator, Resolution())
    magnified = order.magnified or magnification(taken.deflection, plant.structure.length)
    seconds = FRAMES / PER_SECOND
    slowed = seconds / (stretch.last - stretch.first)
    model = f"the model of {order.rig_path.name} in {order.simulator}"
    progress(f"drawing {FRAMES} frames, {slowed:.3g} times slower than it happened")
    with staged(out) as stage:
        _write_gif(taken, f"{model}, {slowed:.3g} times slower,\nmoved by {driven}", stage / f"{name}.gif")
        (stage / f"{name}.glb").write_bytes(moving_glb(taken, FRAMES, seconds, magnified))
        content = {
            "of": order.path.name,
            "shows": f"{model}, moved by {driven}",
            "simulator": order.simulator,
            "first": stretch.first,
            "last": stretch.last,
            "slowed": slowed,
            "magnified": magnified,
            "choices": list(motion.choices),
            "files": [f"{name}.gif", f"{name}.glb"],
        }
        (stage / "film.json").write_text(json_text(content), encoding="utf-8")
    return content


def _acted(path: Path, rig: Rig, without: Sequence[str]) -> tuple[Plant, Trial, str, str]:
    """What moves, what is done to it, how the film is called, and in words what moves the model."""
    if path.suffix == ".toml":
        experiment = read_experiment(path)
        with in_file(path.name):
            run, laboratory = runs_of(experiment, rig)[0], laboratory_of(experiment, rig)
        if run.trial.angle:
            raise InputError(f"{path.name}: excitation.angle", "a film shows the rig's plane", "leave the angle out")
        driven = f"the excitation of {run.name} in {path.name}"
        return laboratory.plant, laboratory.trial_of(run, laboratory.dice_of(0)), run.name, driven
    record, plant = read_record(path, rig, without=without), build_plant(rig)
    if not isinstance(record, Record) or record.excitation is None:
        raise InputError(
            f"{path.name}: no channel of the excitation over time",
            "a film moves the rig by what drove it",
            "name a time record with its excitation, or the experiment that it is of",
        )
    if record.moving_start:
        raise InputError(
            f"{path.name}: it begins in motion",
            "a film begins at rest",
            "film a record whose first samples are at rest",
        )
    excitation = record.excitation
    for effect in plant.effects:
        excitation = effect.change_excitation(excitation)
    driven = f"the excitation measured in {path.name}, not by the motion measured there"
    return plant, Trial(record.fs, excitation, record.excitation_position), path.stem, driven


def _stretch(order: Order, plant: Plant, trial: Trial) -> Stretch:
    whole = trial.n_samples / trial.fs
    if order.first is None and order.last is None:
        return stretch_that_matters(plant, trial)
    first = order.first or 0.0
    stretch = Stretch(first, min(whole, first + length_of_stretch(plant)) if order.last is None else order.last)
    if not 0.0 <= stretch.first < stretch.last <= whole or (stretch.last - stretch.first) * trial.fs < LEAST_SAMPLES:
        raise InputError(
            f"--from {stretch.first:g} --to {stretch.last:g}",
            f"{order.path.name} lasts {whole:g} s, and a film shows {LEAST_SAMPLES} samples of it at least",
            "name two times within it, the first one before the second",
        )
    return stretch


LEAST_SAMPLES = 8


def _write_gif(taken: Take, title: str, path: Path) -> None:
    pictures = list(frames(taken, FRAMES, title))
    palette = pictures[0].quantize(COLOURS)
    first, *others = (picture.quantize(COLOURS, palette=palette, dither=Image.Dither.NONE) for picture in pictures)
    first.save(path, save_all=True, append_images=others, duration=1000 // PER_SECOND, loop=0, optimize=False)
