"""From an experiment to its runs: what drives each of them, and which part of it is recorded."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from math import radians
from typing import Any

import numpy as np

from models.arrays import FloatArray
from models.errors import InputError
from models.excitations import (
    half_sine_hammer,
    logarithmic_sweep,
    random_phase_multisine,
    stepped_sine,
)
from models.rig import Beam, Rig
from models.simulators.protocol import Hold, Trial
from testbed.virtual.experiment import (
    AnyExcitation,
    Drive,
    Experiment,
    FreeDecay,
    Hammer,
    Multisine,
    Placed,
    Release,
    RovingHammer,
    SteppedSine,
    Sweep,
)


@dataclass(frozen=True, eq=False)
class Run:
    """One simulation and the record of it.

    Attributes:
        name: of the record, without suffix.
        trial: what is done.
        first: sample at which the record begins; what was before it excites a decay.
        driven: whether the record holds the excitation's channel.
    """

    name: str
    trial: Trial
    first: int = 0
    driven: bool = True


def runs_of(experiment: Experiment, rig: Rig) -> tuple[Run, ...]:
    """The runs of an experiment, in order.

    Args:
        experiment: as its file describes it.
        rig: whose excitation drives it.

    Raises:
        InputError: an excitation that the rig cannot have, or two runs whose records would have one name.
    """
    excitation, rng = experiment.excitation, np.random.default_rng(experiment.seed)
    if rig.excitation is None and not isinstance(excitation, Release):
        raise InputError(
            f"excitation.kind = {excitation.kind!r} on a rig without [excitation]",
            "what drives a rig stands in its file",
            "add [excitation] to the rig file, or release it from a deflected shape",
        )
    if isinstance(excitation, Hammer | RovingHammer) and not _is_pushed(rig):
        raise InputError(
            f"excitation.kind = {excitation.kind!r} on a driven base", "a hammer is a force", "take another kind"
        )
    _check_on_beam(excitation, rig)
    angle = radians(excitation.angle) if isinstance(excitation, Drive) else 0.0
    at = excitation.position if isinstance(excitation, Placed) else None
    runs = tuple(PLANS[type(excitation)](excitation, experiment.fs, rng))
    _check_names([run.name for run in runs])
    trials = [replace(run.trial, angle=angle, position=run.trial.position if at is None else at) for run in runs]
    return tuple(replace(run, trial=trial) for run, trial in zip(runs, trials, strict=True))


def _is_pushed(rig: Rig) -> bool:
    return rig.excitation is not None and rig.excitation.quantity == "force"


def _check_on_beam(excitation: AnyExcitation, rig: Rig) -> None:
    places = getattr(excitation, "positions", None) or [getattr(excitation, "position", None)]
    if isinstance(excitation, Placed) and excitation.position is not None and not _is_pushed(rig):
        raise InputError(
            f"excitation.position = {excitation.position:g} m on a driven base",
            "a base moves as a whole; a force acts at a place",
            "leave the position out",
        )
    length = rig.structure.length if isinstance(rig.structure, Beam) else 0.0
    for place in places:
        if place is not None and not 0.0 < place <= length:
            raise InputError(
                f"excitation: position {place:g} m", f"a force acts on the beam, 0 to {length:g} m", "correct it"
            )


def _check_names(names: Sequence[str]) -> None:
    for name, number in Counter(names).items():
        if number > 1:
            raise InputError(
                f"excitation: {number} runs are called {name}",
                "each run of an experiment is a record of its own, called by its level or place to six digits",
                "give each level of rms and each of the positions once; realisations repeat a level with other phases",
            )


def _multisines(about: Multisine, fs: float, rng: np.random.Generator) -> Iterator[Run]:
    levels = about.rms if isinstance(about.rms, tuple) else (about.rms,)
    n_samples = round(about.period * fs) * about.periods
    for level in levels:
        for number in range(about.realisations):
            force = random_phase_multisine(rng, fs, n_samples, about.periods, about.low, about.high, level, about.lines)
            more = f"_{number + 1}" if about.realisations > 1 else ""
            yield Run(f"multisine_{level:g}{more}", Trial(fs, force))


def _sweeps(about: Sweep, fs: float, rng: np.random.Generator) -> Iterator[Run]:  # noqa: ARG001
    force = logarithmic_sweep(fs, round(about.duration * fs), about.low, about.high, about.amplitude)
    yield Run(f"sweep_{about.amplitude:g}", Trial(fs, force))


def _stepped(about: SteppedSine, fs: float, rng: np.random.Generator) -> Iterator[Run]:  # noqa: ARG001
    force = stepped_sine(fs, about.low, about.high, about.steps, about.cycles, about.amplitude)
    yield Run(f"stepped_sine_{about.amplitude:g}", Trial(fs, force))


def _blows(about: Hammer, fs: float, rng: np.random.Generator) -> Iterator[Run]:  # noqa: ARG001
    n_samples = round((about.start + about.blows * about.interval) * fs)
    force = np.zeros(n_samples)
    for number in range(about.blows):
        start = about.start + number * about.interval
        force += half_sine_hammer(fs, n_samples, start, about.width, about.peak)
        if about.double:
            force += half_sine_hammer(fs, n_samples, start + about.rebound, about.width, about.double * about.peak)
    yield Run(f"hammer_{about.peak:g}", Trial(fs, force))


def _roving(about: RovingHammer, fs: float, rng: np.random.Generator) -> Iterator[Run]:  # noqa: ARG001
    force = half_sine_hammer(fs, round(about.duration * fs), about.start, about.width, about.peak)
    for position in about.positions:
        yield Run(f"hammer_at_{1000.0 * position:g}mm", Trial(fs, force, position=position))


def _released(about: Release, fs: float, rng: np.random.Generator) -> Iterator[Run]:  # noqa: ARG001
    still = np.zeros(round(about.duration * fs))
    yield Run("release", Trial(fs, still, hold=Hold(about.position, about.force)), driven=False)


def _decays(about: FreeDecay, fs: float, rng: np.random.Generator) -> Iterator[Run]:  # noqa: ARG001
    burst = round(about.cycles / about.frequency * fs)
    time = np.arange(burst + round(about.duration * fs)) / fs
    fade = 0.5 * (1.0 - np.cos(2.0 * np.pi * np.clip(time * fs / burst, 0.0, 1.0)))
    force = about.amplitude * fade * np.sin(2.0 * np.pi * about.frequency * time)
    yield Run("free_decay", Trial(fs, force), first=burst, driven=False)


Plan = Callable[[Any, float, np.random.Generator], Iterator[Run]]

PLANS: dict[type[Any], Plan] = {
    Multisine: _multisines,
    Sweep: _sweeps,
    SteppedSine: _stepped,
    Hammer: _blows,
    RovingHammer: _roving,
    Release: _released,
    FreeDecay: _decays,
}


def excitation_seen(run: Run, excitation: FloatArray) -> FloatArray:
    """The part of a signal that the record of a run holds.

    Args:
        run: with its first sample.
        excitation: (..., N).
    """
    return np.asarray(excitation[..., run.first :])
