"""The cross-check of the three simulators: every measure on every rig, and why they differ."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from identification.progress import Progress
from models.arrays import FloatArray
from models.errors import InputError
from models.plant import build_plant
from models.rig import Rig
from models.simulators import simulator
from models.simulators.protocol import Motion, Resolution, Trial
from testbed.crosscheck.measures import (
    BOUNDS,
    FS,
    LEVEL,
    SEED,
    Measure,
    freq_differences,
    frf_differences,
    impulse_difference,
    is_beam,
    motion_difference,
    multisine,
    predictable,
    rest_differences,
    shaken,
    variant,
)
from testbed.processes import as_done

CLEARANCES = (None, 5e-5, 2e-3)
"""m; the first leaves the rig as it is."""


@dataclass(frozen=True, eq=False)
class Convergence:
    """How a simulator's error falls when one thing gets finer.

    Attributes:
        simulator: which.
        what: segments, elements, modes or steps per sample.
        values: (n,) of it.
        errors: (n,) largest relative error of f1 to f4 against theory, or of motion against the finest, percent.
        order: of the fall, by least squares.
    """

    simulator: str
    what: str
    values: FloatArray
    errors: FloatArray
    order: float


@dataclass(frozen=True, eq=False)
class CrossCheck:
    """All that was found.

    Attributes:
        measures: in order.
        convergence: why models differ.
        motions: of the rig as given, by simulator, for the figures.
        horizons: predictable seconds by rig.
        seed: of the excitation's phases.
    """

    measures: tuple[Measure, ...]
    convergence: tuple[Convergence, ...]
    motions: dict[str, Motion]
    horizons: dict[str, float]
    seed: int

    @property
    def holds(self) -> bool:
        """Whether every bound is kept."""
        return all(measure.holds for measure in self.measures)


@dataclass(frozen=True, eq=False)
class _Pair:
    """The modal model and one other simulator on one rig."""

    rig: str
    measures: tuple[Measure, ...]
    ours: Motion
    theirs: Motion
    horizon: float


def crosscheck(
    rig: Rig,
    others: Sequence[str],
    progress: Progress,
    clearances: Sequence[float | None] = CLEARANCES,
    *,
    seed: int = SEED,
    jobs: int = 1,
) -> CrossCheck:
    """Hold the modal model against other simulators.

    Args:
        rig: a beam in sleeves.
        others: simulators.
        progress: told what is done.
        clearances: m, of the rigs that are checked; None for the rig as it is.
        seed: of the excitation's phases.
        jobs: processes; the result does not depend on them.

    Raises:
        InputError: a rig that the others cannot carry.
        DivergenceError: a simulator lost the motion.
    """
    if not is_beam(rig) or not rig.sleeves:
        raise InputError("a rig without beam or sleeves", "the cross-check is of beams in sleeves", "take another rig")
    for each in others:
        if each not in BOUNDS:
            raise InputError(
                f"--against {each}", f"the modal model is held against {' or '.join(BOUNDS)}", "name one of these"
            )
        simulator(each).check(build_plant(rig), Resolution())
    pairs = [(clearance, each) for clearance in clearances for each in others]
    found: dict[tuple[float | None, str], _Pair] = {}
    for done, pair in as_done(partial(_held, rig, seed), pairs, jobs):
        found[done] = pair
        progress(f"{pair.rig}: modal against {done[1]}")
    progress("how the differences fall with segments, elements, modes and steps")
    falls = dict(as_done(partial(_convergence, rig, seed), list(dict.fromkeys(["modal", *others])), jobs))
    first = {each: found[clearances[0], each] for each in others}
    return CrossCheck(
        measures=tuple(measure for pair in pairs for measure in found[pair].measures),
        convergence=tuple(fall for each in ["modal", *others] for fall in falls[each]),
        motions={"modal": first[others[0]].ours, **{each: pair.theirs for each, pair in first.items()}},
        horizons={found[pair].rig: found[pair].horizon for pair in pairs},
        seed=seed,
    )


def _held(rig: Rig, seed: int, pair: tuple[float | None, str]) -> _Pair:
    """Every measure of the rig with one clearance, in one other simulator."""
    clearance, each = pair
    varied, name = variant(rig, clearance), "as given" if clearance is None else f"{1e3 * clearance:g} mm"
    plant, force = build_plant(varied), multisine(LEVEL, seed=seed)
    modal, other, bounds = simulator("modal"), simulator(each), BOUNDS[each]
    seconds = predictable(modal, plant, force)
    measures = [*freq_differences(varied, name, modal, other), *rest_differences(varied, name, modal, other)]
    if clearance is None:
        measures += frf_differences(varied, name, modal, other, seed)
    ours, theirs = shaken(modal, plant, force), shaken(other, plant, force)
    found = (
        (f"motion with impacts, {seconds:.2f} s", motion_difference(ours, theirs, seconds), bounds.motion),
        ("impulse per impact", impulse_difference(ours, theirs, seconds), bounds.impulse),
        ("energy unaccounted for, 1 s", 100.0 * theirs.energy.fault, bounds.energy),
    )
    measures += [Measure(name, quantity, each, value, bound, "%") for quantity, value, bound in found]
    return _Pair(name, tuple(measures), ours, theirs, seconds)


PARTS = {"modal": (4, 6, 8, 12), "mujoco": (8, 12, 16, 24, 32), "exudyn": (4, 6, 8, 12, 16)}
WORDS = {"modal": "modes", "mujoco": "segments", "exudyn": "elements"}
STEPS = {"modal": (2, 4, 8), "mujoco": (24, 48, 96), "exudyn": (8, 16, 32)}
FINEST = {"modal": Resolution(None, 32), "mujoco": Resolution(None, 192), "exudyn": Resolution(None, 64)}


def _convergence(rig: Rig, seed: int, name: str) -> list[Convergence]:
    """How one simulator's errors fall."""
    free = build_plant(rig.model_copy(update={"sleeves": ()}))
    plant = build_plant(rig)
    engine, falls = simulator(name), []
    if name != "modal":
        exact = simulator("modal").natural_freqs(free, 4, Resolution(40))
        found = [engine.natural_freqs(free, 4, Resolution(n)) for n in PARTS[name]]
        errors = 100.0 * np.array([np.abs(f / exact - 1.0).max() for f in found])
        falls.append(_falling(name, f"{WORDS[name]}, f1 to f4 free", PARTS[name], errors))
    trial = Trial(FS, multisine(LEVEL, STEP_SECONDS, seed))
    best = engine.run(plant, trial, FINEST[name]).channels
    motions = [engine.run(plant, trial, Resolution(None, steps)).channels for steps in STEPS[name]]
    size = np.sqrt(np.mean(best**2))
    errors = 100.0 * np.array([np.sqrt(np.mean((motion - best) ** 2)) / size for motion in motions])
    return [*falls, _falling(name, "steps per sample, motion with impacts", STEPS[name], errors)]


STEP_SECONDS = 0.25
"""Of motion over which steps are compared."""


def _falling(name: str, what: str, values: Sequence[int], errors: FloatArray) -> Convergence:
    slope = np.polyfit(np.log(values), np.log(np.maximum(errors, 1e-12)), 1)[0]
    return Convergence(name, what, np.array(values, float), errors, -float(slope))
