"""Whose turn it is to be the truth, and how finely it has to resolve the rig.

What an engine's discretisation leaves must stay below the noise, or the benchmark would ask for an effect that is none.
So each engine first moves the rig as built, without what is hidden, for some seconds beside our finite elements; where
the difference shows beyond what the rig's toleranced numbers imitate, it resolves the rig further, and where that does
not do, the next engine is taken.
"""

from collections.abc import Iterator
from math import ceil
from zlib import crc32

import numpy as np

from models.chain.segments import Segments
from models.errors import DivergenceError
from models.plant import Plant, build_plant
from models.simulators import protocol, simulator
from models.simulators.mujoco import n_segments
from models.simulators.protocol import Resolution
from testbed.hidden_effects.imitation import Imitation
from testbed.hidden_effects.plan import Task
from testbed.hidden_effects.sets import SETS
from testbed.hidden_effects.sizes import ROUNDS
from testbed.hidden_effects.trials import Trial
from testbed.hidden_effects.truth import ENGINES, FINE, Truth, moved

RESOLVED = 1.05
"""Error over noise that the discretisation alone may leave: itself it is then a third of the noise."""

WATCHED = ("high", "decay")
"""Records on which it is looked at: the loudest, and the blow that reaches the highest modes."""

SEGMENT_SPANS = ((1.2, 1.7), (1.7, 2.4))
"""Segments in units of the engine's own choice; of them the number that puts sleeves where segments speak true."""

STEP_RATES = (4e4,)
"""Steps per second of the cables; with smaller ones the error of the elements, of the other sign, stands alone."""


def engine_for(task: Task, trial: Trial, truth: Truth, rng: np.random.Generator) -> tuple[str, Resolution]:
    """The engine whose turn it is, or the next one that can carry and resolve the plant, and how finely it does.

    Args:
        task: the case.
        trial: with the forces.
        truth: what is there, by whatever engine.
        rng: draws the noise that the difference is compared with.
    """
    plain, fs = build_plant(truth.built), trial.fs
    tests = [protocol.Trial(fs, trial.first_seconds(name)) for name in WATCHED]
    imitation = Imitation(trial, truth.noise, rng, WATCHED)
    for engine in _turns(task):
        if engine == FINE:
            break
        if simulator(engine).cannot_carry(truth.plant, Resolution()):
            continue
        exact = [moved(FINE, Resolution(), plain, test) for test in tests]
        for resolution in _resolutions(engine, truth.plant, fs):
            try:
                coarse = [moved(engine, resolution, plain, test) for test in tests]
            except DivergenceError:
                continue
            if imitation.shown_by([one - other for one, other in zip(coarse, exact, strict=True)], ROUNDS) <= RESOLVED:
                return engine, resolution
    return FINE, Resolution()


def _turns(task: Task) -> list[str]:
    """The engines from the one whose turn it is; each kind begins elsewhere, and in each batch where that says."""
    batch = SETS[task.case_set].batches.get(task.seed)  # None of a seed that was put aside since
    turn = crc32(task.kind.encode()) + task.number + (batch.turned if batch else 0)
    return [ENGINES[(turn + step) % len(ENGINES)] for step in range(len(ENGINES))]


def _resolutions(engine: str, plant: Plant, fs: float) -> Iterator[Resolution]:
    """The engine's own choice, and finer ones."""
    yield Resolution()
    if engine == "exudyn":
        yield from (Resolution(steps_per_sample=ceil(rate / fs)) for rate in STEP_RATES)
    else:
        own = n_segments(plant, fs)
        for low, high in SEGMENT_SPANS:
            numbers = range(round(low * own), round(high * own))
            yield Resolution(n_parts=min(numbers, key=lambda n: _fault(plant, n)))


def _fault(plant: Plant, n: int) -> float:
    """How far from where a rigid segment has the beam's height the sleeves sit, in m^2 (models.chain.segments)."""
    segments = Segments(plant.structure.length, n)
    places = [contact.position or 0.0 for contact in plant.contacts]
    away = [(at - segments.centres[segments.segment_at(at)]) / segments.h for at in places]
    return max((abs(x**2 - 1.0 / 12.0) for x in away), default=0.0) * segments.h**2
