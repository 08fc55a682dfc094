"""A frame that rubs on its ground: the friction force against the weight that presses, and a linear fit refused.

Source: L. Marino, A. Cicirello, A switching Gaussian process latent force model, arXiv 2303.03858 (2023).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import log
from pathlib import Path

import numpy as np

from identification.assess import assess
from identification.calibrate import calibrate, unknowns_of
from identification.diagnose import diagnose
from identification.hypothesis import LARGEST_SIGMA, Hypothesis
from identification.prepare import prepare
from identification.progress import Progress
from identification.result import Diagnosis
from models.arrays import FloatArray
from models.record import Record
from models.rig import Excitation, Oscillator, Rig, Sensor
from testbed.processes import processes
from testbed.real_data.bars import Bar
from testbed.real_data.files import read_variables, set_folder

SOURCE = "github.com/l-marino/switching-GPLFM"
WEIGHTS = (250, 350, 450)
"""G of the disc; the last is predicted from the others."""

FORCE_BAR = 0.05
"""N."""

FRICTION = "coulomb_friction"

MOST_ADDED = 2
"""Friction and one effect beside it, as far as the error on the half kept aside goes. Weights are compared by friction
alone: what is added beside it has another sign at one of them, so it is none of the frame's, and bends the friction."""

FRAME = Rig(
    structure=Oscillator(kind="oscillator", mass=3.0799, stiffness=1191.0, damping=0.669),
    tolerances={"stiffness": 0.02, "damping": 0.2},
    excitation=Excitation(name="base", quantity="base_displacement"),
    sensors=(Sensor(name="top", quantity="displacement"),),
)
"""The authors' start values. Where the base drives, mass, stiffness, damping and friction can be scaled together: no
force is measured. The scale is the mass, which was weighed."""

GIVEN = next(parameter for parameter in FRAME.parameters() if parameter.path == "stiffness")
"""The authors' stiffness and its tolerance."""


@dataclass(frozen=True, eq=False)
class Halves:
    """One weight's test: the first half is learnt from, the second is kept aside."""

    weight: int
    first: Record
    second: Record


@dataclass(frozen=True, eq=False)
class WeightResult:
    """One weight.

    Attributes:
        weight: g.
        diagnosis: from the first half.
        force, std: of the friction, N, in the model that lacks nothing but friction: the same model at every weight.
        beside, beside_std: the same beside what else was found.
        given, linear, updated: rms error on the second half, mm: as given, calibrated linear, and with what was found.
        loose: stiffness, N/m, of a linear model whose tolerances were taken away, and its rms error, mm.
        unheld: diagnosis of the same half that is given the loose model and may add nothing: is it complete?
        fs: Hz.
        measured, predicted: (N,) mm, the second half.
    """

    weight: int
    diagnosis: Diagnosis
    force: float
    std: float
    beside: float
    beside_std: float
    given: float
    linear: float
    updated: float
    loose: tuple[float, float]
    unheld: Diagnosis
    fs: float
    measured: FloatArray
    predicted: FloatArray


@dataclass(frozen=True, eq=False)
class FrictionFrame:
    """The finished study.

    Attributes:
        rows: by weight.
        elsewhere: weight -> weight -> rms error, mm, of the loose linear model fitted at the first on the second.
    """

    rows: Sequence[WeightResult]
    elsewhere: Mapping[int, Mapping[int, float]]

    @property
    def predicted(self) -> float:
        """Friction at the last weight on the line through the others, N."""
        return self._on_line[0]

    @property
    def predicted_std(self) -> float:
        """Standard deviation of that, N."""
        return self._on_line[1]

    @property
    def predicted_beside(self) -> float:
        """The same friction beside what else was found at each weight, N."""
        *learnt, last = self.rows
        return predicted_force([(row.weight, row.beside, row.beside_std) for row in learnt], last.weight)[0]

    @property
    def _on_line(self) -> tuple[float, float]:
        *learnt, last = self.rows
        return predicted_force([(row.weight, row.force, row.std) for row in learnt], last.weight)

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why the linear model that nobody holds is refused, though it fits better than the one that is held."""
        loose = [row.loose[0] for row in self.rows]
        sigmas = [sigmas_of(stiffness) for stiffness in loose]
        times = [row.loose[1] / row.updated for row in self.rows]
        off = f"{min(sigmas):.0f} to {max(sigmas):.0f} standard deviations off the authors' {GIVEN.value:.0f} N/m"
        each = ", ".join(f"{stiffness:.0f}" for stiffness in loose)
        more = f"{min(times):.1f} to {max(times):.1f} times what the model with friction leaves"
        verdicts = ", ".join(f"`{row.unheld.verdict}` at {row.weight} g" for row in self.rows)
        return (
            f"Its stiffness is {off}; a diagnosis moves no number of the rig by more than {LARGEST_SIGMA:g}.",
            f"It is another one at each weight, although the frame is the same: {each} N/m.",
            f"On the half kept aside it leaves {more}.",
            f"A diagnosis that is given it, and may move it as far as it likes, does not call it complete: {verdicts}.",
        )

    @property
    def bars(self) -> tuple[Bar, ...]:
        """What it has to reach."""
        named = {r.diagnosis.added[0].effect.kind if r.diagnosis.added else "nothing" for r in self.rows}
        forces = [row.force for row in self.rows]
        grows = "grows with the weight" if forces == sorted(forces) else "does not grow with the weight"
        let_through = [f"{row.weight} g" for row in self.rows if row.unheld.verdict == "complete"]
        return (
            Bar("named at every weight", " and ".join(sorted(named)), FRICTION),
            Bar("friction force", grows, "grows with the weight"),
            Bar(
                "predicted at 450 g less identified, by friction alone",
                abs(self.predicted - forces[-1]),
                FORCE_BAR,
                "N",
            ),
            Bar(
                "linear fit with an absurd stiffness",
                f"let through at {', '.join(let_through)}" if let_through else "refused",
                "refused",
            ),
        )


def sigmas_of(stiffness: float) -> float:
    """How many standard deviations of its tolerance a stiffness of the frame lies from the authors' value."""
    return abs(log(stiffness / GIVEN.value)) / GIVEN.tolerance


def study_friction_frame(folder: Path, seed: int, jobs: int, progress: Progress) -> FrictionFrame:
    """Diagnose the frame at three weights, draw the friction's line and predict the last weight from the others.

    Args:
        folder: with the published files.
        seed: of every random choice.
        jobs: processes.
        progress: told what is being done.

    Raises:
        InputError: a file that is missing or not the published one.
    """
    tests = [read_halves(folder, weight) for weight in WEIGHTS]
    progress(f"diagnosing {', '.join(f'{test.weight} g' for test in tests)}")
    with processes(min(jobs, len(tests))) as pool:
        waiting = {test.weight: pool.submit(weight_result, test, seed) for test in reversed(tests)}
        rows = []
        for weight, future in sorted(waiting.items()):
            rows.append(future.result())
            progress(f"{weight} g: {rows[-1].diagnosis.verdict}, {', '.join(_labels(rows[-1].diagnosis))}")
    return FrictionFrame(rows, {row.weight: _elsewhere(row.loose[0], tests) for row in rows})


def _labels(diagnosis: Diagnosis) -> list[str]:
    return [added.effect.label() for added in diagnosis.added]


def predicted_force(points: Sequence[tuple[float, float, float]], weight: float) -> tuple[float, float]:
    """(force, standard deviation) at a weight, N, on the line through two points.

    Coulomb's law in the weight of the disc, with a constant for what else presses or rubs: F = F_0 + mu g m.

    Args:
        points: (weight, force, standard deviation) of two tests.
        weight: in the same unit.
    """
    (w1, f1, s1), (w2, f2, s2) = points
    share = (weight - w1) / (w2 - w1)
    return f1 + share * (f2 - f1), float(np.hypot((1.0 - share) * s1, share * s2))


def read_halves(folder: Path, weight: int) -> Halves:
    """The two halves of one weight's test.

    Args:
        folder: with the published files.
        weight: of the disc, g.

    Raises:
        InputError: a file that is missing or not the published one.
    """
    place = set_folder(folder, "friction_frame")
    files = {axis: place / f"s_b_{weight}g_{axis}.mat" for axis in "xy"}
    top, base = (read_variables(file, (axis, "t"), SOURCE) for axis, file in files.items())
    moved, shaken = (np.ravel(content[axis]) * 1e-3 for content, axis in ((top, "x"), (base, "y")))
    fs, half = 1.0 / float(np.median(np.diff(np.ravel(base["t"])))), len(shaken) // 2

    def part(name: str, which: slice) -> Record:
        return Record(name, fs, shaken[which].copy(), ("top",), moved[None, which].copy(), moving_start=True)

    return Halves(weight, part("first half", slice(None, half)), part("second half", slice(half, None)))


def weight_result(test: Halves, seed: int) -> WeightResult:
    """One weight's diagnosis from its first half, and what it and the linear models are worth on the second.

    Args:
        test: of the weight.
        seed: of every random choice.
    """
    found = diagnose(FRAME, [test.first], seed=seed, jobs=1, most_effects=MOST_ADDED)
    is_alone = len(found.added) <= 1
    alone = found if is_alone else diagnose(FRAME, [test.first], seed=seed, jobs=1, most_effects=1)
    calibrated = found.calibrated
    loose = _loose(test.first)
    unheld = diagnose(loose.updated_rig, [test.first], seed=seed, jobs=1, most_effects=0)
    stages = (Hypothesis(FRAME), calibrated.hypothesis, found.final.hypothesis, loose)
    left = [_predicted(hypothesis, test.second) for hypothesis in stages]
    measured = 1e3 * test.second.responses[0]
    given, linear, updated, bad = (float(np.sqrt(np.mean((p - measured) ** 2))) for p in left)
    stiffness = loose.updated_rig.structure
    assert isinstance(stiffness, Oscillator)
    return WeightResult(
        test.weight,
        _lighter(found),
        *_friction(alone),
        *_friction(found),
        given,
        linear,
        updated,
        (stiffness.stiffness, bad),
        _lighter(unheld),
        test.second.fs,
        measured,
        left[2],
    )


def _friction(diagnosis: Diagnosis) -> tuple[float, float]:
    """(force, standard deviation), N; none where no friction was found."""
    for added in diagnosis.added:
        if added.effect.kind == FRICTION:
            estimate = next(each for each in added.estimates if each.name == "friction_force")
            return float(np.mean(estimate.value)), float(np.mean(estimate.std))
    return 0.0, 0.0


def _lighter(diagnosis: Diagnosis) -> Diagnosis:
    """Without what the page does not tell, to be sent between processes."""
    return replace(diagnosis, traces={}, missing_forces=())


def _predicted(hypothesis: Hypothesis, record: Record) -> FloatArray:
    """(N,) mm, the record predicted from its base; the state at its start is estimated, nothing else is."""
    (score,) = assess(replace(hypothesis, starts={}, offsets={}), [record], jobs=1).records
    return np.asarray(1e3 * score.predicted[0])


LOOSE = {"stiffness": 1.0, "damping": 1.0}
"""Tolerances that are none: a factor of 50 to either side lies within four standard deviations."""

LOOSE_FRAME = FRAME.model_copy(update={"tolerances": LOOSE})

LOOSE_STARTS = (1191.0, 300.0, 135.0, 80.0)
"""N/m, from where the loose fit begins; the best is kept."""


def _loose(record: Record) -> Hypothesis:
    """The linear model that fits best when nobody holds its numbers."""
    fits = []
    for stiffness in LOOSE_STARTS:
        structure = FRAME.structure.model_copy(update={"stiffness": stiffness})
        given = Hypothesis(LOOSE_FRAME.model_copy(update={"structure": structure}))
        evaluator = prepare(given, [record], 1, np.random.default_rng(0))
        fits.append(calibrate(evaluator, given, unknowns_of(given, evaluator)))
    return min(fits, key=lambda found: found.cost).hypothesis


def _elsewhere(stiffness: float, tests: Sequence[Halves]) -> dict[int, float]:
    """Rms error, mm, on every weight's second half of a linear model with this stiffness, its damping fitted there."""
    structure = FRAME.structure.model_copy(update={"stiffness": stiffness})
    rig = FRAME.model_copy(update={"structure": structure, "tolerances": {"damping": 1.0}})
    errors = {}
    for test in tests:
        given = Hypothesis(rig)
        evaluator = prepare(given, [test.first], 1, np.random.default_rng(0))
        fitted = calibrate(evaluator, given, unknowns_of(given, evaluator)).hypothesis
        error = _predicted(fitted, test.second) - 1e3 * test.second.responses[0]
        errors[test.weight] = float(np.sqrt(np.mean(error**2)))
    return errors
