"""Cases: a rig as its owner describes it, records of it as built, and what the owner does not know of."""

from collections import Counter
from dataclasses import dataclass, replace
from math import hypot, log10
from zlib import crc32

import numpy as np

from identification.calibrate import calibrate, unknowns_of
from identification.hypothesis import Hypothesis
from identification.prepare import prepare
from models.errors import DivergenceError, InputError
from models.record import Record
from models.rig import Rig
from testbed.hidden_effects.engines import engine_for
from testbed.hidden_effects.hiding import draw_wanted, hide
from testbed.hidden_effects.plan import Task
from testbed.hidden_effects.sets import CHAOTIC_SHARE, FEW, MOST, SETS, CaseSet
from testbed.hidden_effects.trials import HELD, LEARNT, MOST_AMPLIFICATION, Trial, draw_trial
from testbed.hidden_effects.truth import MODEL, Truth, measure
from testbed.virtual.noise import Noise

MOST_RIGS, RIGS_A_SIZE = 80, 20
"""Drawn for one case until one has a place for what is to be hidden, and until another size is drawn: some kinds show
as much as was wanted on no rig."""


@dataclass(frozen=True, eq=False)
class Case:
    """One case.

    Attributes:
        task: its name.
        rig: as its owner describes it.
        truth: what is really there.
        growth, amplification: of neighbouring motions (``Trial``).
        chaotic: whether neighbouring motions part, by the trial or by what the noise did in the end.
        wanted: times the noise that each effect was to show.
        shown: that it shows by the search.
        calibrated: residual over noise of the calibrated model on the modal model's records, by which a case is taken.
        records: to learn from.
        holdout: the record kept aside.
        noise_nrmse: what a perfect model leaves on each record, by name.
        turned_down: how many rigs were drawn before, by the reason why they were not taken.
    """

    task: Task
    rig: Rig
    truth: Truth
    growth: float
    amplification: float
    chaotic: bool
    wanted: tuple[float, ...]
    shown: tuple[float, ...]
    calibrated: float | None
    records: tuple[Record, ...]
    holdout: Record
    noise_nrmse: dict[str, float]
    turned_down: dict[str, int]

    @property
    def snr_db(self) -> float:
        """Of every channel."""
        return -20.0 * log10(self.truth.noise.response)

    @property
    def snr_of_force_db(self) -> float:
        """Of the force."""
        return -20.0 * log10(self.truth.noise.excitation)


def draw_case(task: Task) -> Case:
    """The case of this name; the same whatever other cases there are.

    Args:
        task: of a set.

    Raises:
        ArithmeticError: none of the rigs drawn has a place for what is to be hidden.
    """
    case_set = SETS[task.case_set]
    rng = np.random.default_rng([task.seed, crc32(task.kind.encode()), task.number])
    chaotic = bool(rng.random() < CHAOTIC_SHARE)
    noise = _draw_noise(case_set, rng)
    wanted = draw_wanted(task, rng)
    turned_down: Counter[str] = Counter()
    for number in range(MOST_RIGS):
        if number and number % RIGS_A_SIZE == 0:
            wanted = draw_wanted(task, rng)
        trial = draw_trial(case_set, chaotic=chaotic, rng=rng)
        drawn = _attempt(task, trial, noise, wanted, rng)
        if isinstance(drawn, Case):
            return replace(drawn, turned_down=dict(turned_down))
        turned_down[drawn] += 1
    reasons = ", ".join(f"{reason}: {number}" for reason, number in turned_down.items())
    message = f"{task.name} was not drawn from {MOST_RIGS} rigs ({reasons})"
    raise ArithmeticError(message)


def _attempt(task: Task, trial: Trial, noise: Noise, wanted: tuple[float, ...], rng: np.random.Generator) -> Case | str:
    """The case on this rig, or why there is none."""
    try:
        hidden = hide(task, trial, noise, wanted, rng)
        if hidden is None:
            return "no size shows as much as wanted"
        truth = Truth(trial.built, hidden.effects, MODEL, noise)
        calibrated = calibrated_ratio(trial, truth, rng) if hidden.effects else None
        if calibrated is not None and not FEW <= calibrated <= MOST:
            return f"the calibrated error is not {FEW:g} to {MOST:g} times the noise"
        truth = truth.by(*engine_for(task, trial, truth, rng))
        measured = {name: measure(truth, name, force, trial.fs, rng) for name, force in trial.forces.items()}
    except DivergenceError as lost:
        return f"a motion was lost ({str(lost).split(';')[0].split(' the motion')[0]})"
    except InputError:
        return "no state at rest"
    calm = hypot(noise.response, MOST_AMPLIFICATION * noise.excitation)
    return Case(
        task=task,
        rig=trial.rig,
        truth=truth,
        growth=trial.growth,
        amplification=trial.amplification,
        chaotic=trial.chaotic or max(left for _, left in measured.values()) > calm,
        wanted=wanted,
        shown=hidden.shown,
        calibrated=calibrated,
        records=tuple(measured[name][0] for name in LEARNT),
        holdout=measured[HELD][0],
        noise_nrmse={name: left for name, (_, left) in measured.items()},
        turned_down={},
    )


def _draw_noise(case_set: CaseSet, rng: np.random.Generator) -> Noise:
    response = case_set.snr.draw(rng)
    excitation = response if case_set.snr_of_force is None else case_set.snr_of_force.draw(rng)
    return Noise(10.0 ** (-response / 20.0), 10.0 ** (-excitation / 20.0), share_of="channel")


def calibrated_ratio(trial: Trial, truth: Truth, rng: np.random.Generator) -> float:
    """Residual over noise of the calibrated model on the records to learn from.

    Args:
        trial: with the owner's rig and the forces.
        truth: by the modal model, which is fast.
        rng: draws noise.

    Raises:
        DivergenceError: a motion left the finite numbers.
    """
    given = Hypothesis(trial.rig)
    records = [measure(truth, name, trial.forces[name], trial.fs, rng)[0] for name in LEARNT]
    evaluator = prepare(given, records, 1, np.random.default_rng(0))
    return calibrate(evaluator, given, unknowns_of(given, evaluator)).ratio
