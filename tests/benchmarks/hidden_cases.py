"""Cases of the hidden-effect benchmark: a rig as built, perhaps with an effect that its owner does not know of.

How much an effect is to show is drawn first: the error of the calibrated model is to be R times the noise, R
log-uniform from 2 to 5 in a third of the cases and from 5 to 30 in the others. The effect's size follows from a search
with the modal model, in which a few Gauss-Newton steps stand for the calibration (``hidden_imitation``). Where the
calibration itself, which starts from the owner's numbers, imitates the effect to below twice the noise on the records
as measured, nothing is missing that the records show, and another case is drawn.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import exp, log
from zlib import crc32

import numpy as np

from identification.calibrate import calibrate, unknowns_of
from identification.hypothesis import Hypothesis
from identification.prepare import prepare
from models.effects import EFFECTS, Effect, Place
from models.effects.protocol import Scene
from models.plant import build_plant
from models.record import Record
from models.rig import Rig
from testbed.virtual import Noise, perturbed, virtual_record
from tests.benchmarks.hidden_imitation import Imitation
from tests.benchmarks.hidden_rigs import FS, Trial, channels_of, draw_trial, watched

NOTHING = "nothing"
"""Name of the cases in which nothing is hidden."""

FEW, MANY, MOST = 2.0, 5.0, 30.0
"""Bounds of R."""

CLOSE = 1.4
"""Factor within which a size meets the R drawn for it."""

PLACES, SEARCHES = 2, 8
"""Places tried on one rig, and sizes at each."""

SMALLEST, LARGEST = 1e-4, 30.0
"""Factors on a trial value of the library between which a size is looked for."""

ROUNDS = 4
"""Steps of the calibration that stands for the diagnosis' own."""


@dataclass(frozen=True, eq=False)
class Case:
    """One case.

    Attributes:
        kind: of the hidden effect, or ``NOTHING``.
        rig: as its owner describes it.
        built: the rig as built.
        hidden: the effect that the description lacks, or None.
        noise: of the sensors and of the force, as a share of their rms.
        wanted: R that was drawn.
        expected: R by the search.
        floor: error of a perfect model by that search, the unit of R; 0 where nothing is hidden.
        records: to learn from.
        holdout: the record kept aside.
    """

    kind: str
    rig: Rig
    built: Rig
    hidden: Effect | None
    noise: float
    wanted: float
    expected: float
    floor: float
    records: tuple[Record, ...]
    holdout: tuple[Record, ...]


def draw_case(kind: str, seed: int, number: int) -> Case:
    """The case of a kind with this number; the same for the same seed whatever other kinds there are.

    Args:
        kind: of the registry, or ``NOTHING``.
        seed: of the benchmark.
        number: from 0.
    """
    rng = np.random.default_rng([seed, crc32(kind.encode()), number])
    noise = exp(rng.uniform(log(0.003), log(0.01)))
    few = rng.random() < 1.0 / 3.0
    wanted = exp(rng.uniform(log(FEW if few else MANY), log(MANY if few else MOST)))
    while True:
        trial = draw_trial(rng)
        built = perturbed(trial.rig, rng)
        if kind == NOTHING:
            return _measured(Case(kind, trial.rig, built, None, noise, 1.0, 1.0, 0.0, (), ()), trial, rng)
        imitation = Imitation(trial, built, noise, rng)
        found = _find_effect(kind, trial, imitation, wanted, rng)
        if found is not None:
            case = Case(kind, trial.rig, built, found[0], noise, wanted, found[1], imitation.floor, (), ())
            case = _measured(case, trial, rng)
            if calibrated_ratio(case) >= FEW:
                return case


def calibrated_ratio(case: Case) -> float:
    """Residual over noise of the calibrated model on the records to learn from."""
    given = Hypothesis(case.rig)
    evaluator = prepare(given, case.records, 1, np.random.default_rng(0))
    return calibrate(evaluator, given, unknowns_of(given, evaluator)).ratio


def _measured(case: Case, trial: Trial, rng: np.random.Generator) -> Case:
    hidden = [] if case.hidden is None else [case.hidden]
    noise = Noise(case.noise, case.noise)
    records = {
        name: virtual_record(case.built, hidden, force, FS, noise, rng, name) for name, force in trial.forces.items()
    }
    learnt = tuple(records.pop(name) for name in trial.training)
    return replace(case, records=learnt, holdout=tuple(records.values()))


def _find_effect(
    kind: str, trial: Trial, imitation: Imitation, wanted: float, rng: np.random.Generator
) -> tuple[Effect, float] | None:
    """An effect that shows about ``wanted`` times the noise, and how much it does; None where this rig has none."""
    for _ in range(PLACES):
        trials = list(EFFECTS[kind].trials(_scene(kind, trial, imitation.built, rng)))
        if not trials:
            return None
        start = _jittered(trials[int(rng.integers(len(trials)))], rng, 0.3)
        has_size = any(about.neutral is not None for _, about in start.fitted_parameters())
        for effect, shown in _sized(start, imitation, wanted) if has_size else _varied(start, imitation, wanted, rng):
            if 1.0 / CLOSE < shown / wanted < CLOSE:
                return effect, shown
    return None


def _sized(start: Effect, imitation: Imitation, wanted: float) -> Iterator[tuple[Effect, float]]:
    """An effect made larger and smaller, and how much it shows each time."""
    low, high = log(SMALLEST), log(LARGEST)
    for _ in range(10):  # without calibration an effect shows at its smallest size
        middle = 0.5 * (low + high)
        shown = imitation.shown(start.scaled(exp(middle)), rounds=0)
        low, high = (middle, high) if shown < wanted else (low, middle)
    low, size, high = log(SMALLEST), low, log(LARGEST)
    for _ in range(SEARCHES):
        effect = start.scaled(exp(size))
        shown = imitation.shown(effect, ROUNDS)
        yield effect, shown
        low, high = (size, high) if shown < wanted else (low, size)
        guess = size + min(
            0.5 * log((wanted**2 - 1.0) / max(shown**2 - 1.0, 1e-3)), log(6.0)
        )  # squares are in proportion
        size = guess if low < guess < high else 0.5 * (low + high)
        if size > log(LARGEST / 2.0):
            return


def _varied(
    start: Effect, imitation: Imitation, wanted: float, rng: np.random.Generator
) -> Iterator[tuple[Effect, float]]:
    """An effect without a scale: numbers at random, then halfway between what shows too little and too much."""
    small: Effect | None = None
    large: Effect | None = None
    for _ in range(SEARCHES):
        effect = _jittered(start, rng, 0.7) if small is None or large is None else _between(small, large)
        shown = imitation.shown(effect, ROUNDS)
        yield effect, shown
        small, large = (effect, large) if shown < wanted else (small, effect)


def _between(one: Effect, other: Effect) -> Effect:
    """The effect with the mean of two effects' numbers, the geometric one where both have a sign in common."""
    first, second = one.fitted_values(), other.fitted_values()
    product = first * second
    return one.with_fitted(np.where(product > 0.0, np.sign(first) * np.sqrt(np.abs(product)), 0.5 * (first + second)))


def _jittered(effect: Effect, rng: np.random.Generator, spread: float) -> Effect:
    """The effect with its numbers moved by random factors, within their bounds."""
    values = effect.fitted_values()
    for i, (_, about) in enumerate(effect.fitted_parameters()):
        values[i] = np.clip(values[i] * np.exp(spread * rng.standard_normal()), about.lower, about.upper)
    return effect.with_fitted(values)


def _scene(kind: str, trial: Trial, built: Rig, rng: np.random.Generator) -> Scene:
    """A random place for the effect, and the motion there in the record of the higher level."""
    place, length, force = Place(), built.structure.length, trial.forces["high"]
    kinds = EFFECTS[kind].places
    if kinds:
        chosen = str(rng.choice(kinds))
        if chosen == "sleeve":
            sleeve = built.sleeves[int(rng.integers(len(built.sleeves)))]
            place = Place(sleeve=sleeve.name, position=sleeve.position)
        elif chosen == "sensor":
            place = Place(sensor=built.sensors[int(rng.integers(len(built.sensors)))].name)
        else:
            place = Place(position=round(float(rng.uniform(0.2, 0.98)) * length, 3))
    displacement, velocity = channels_of(watched(built, place.position or length), force)
    plant = build_plant(built)
    contact = next((contact for contact in plant.contacts if contact.sleeve == place.sleeve), None)
    largest = float(np.ptp(displacement)) / 2
    return Scene(
        place=place,
        contact=contact,
        structure=plant.structure,
        displacement=largest,
        velocity=float(np.sqrt(np.mean(velocity**2))),
        force=float(np.sqrt(np.mean(force**2))),
        penetration=0.0 if contact is None else max(0.0, largest - contact.clearance),
        duration=len(force) / FS,
        driven_base=False,
    )
