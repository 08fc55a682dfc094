"""Section 4.3 of the article and beyond it: what uncertain numbers do to frequencies and to the struck response."""

from pathlib import Path

import numpy as np
from scipy.stats import gaussian_kde

from identification.progress import Progress
from models.arrays import FloatArray
from models.rig import Rig
from testbed.article.emulated import BASE, CHECKED_ON, NAMES, TRAINED_ON, emulated, frequency_shares
from testbed.article.judging import Measured
from testbed.article.reading import TappedModes
from testbed.article.rig import TIP
from testbed.article.small_motion import Draws, SmallMotion
from testbed.article.three_models import UPDATED, ThreeModels
from testbed.article.uncertain import (
    BURNT,
    CONDITIONS,
    CONFIDENCE,
    EVERY,
    LOG_COURSE,
    MISFITS,
    NUMBERS,
    SAMPLES,
    STEPS,
    WALKERS,
    Statistics,
    coincidence,
    condition,
    difference,
    posterior,
)
from testbed.outputs import Json, digest_of, kept

KEPT = "probability.json"

DRAWN = 200
"""Points of a density in the figure."""


def probability(
    given: Rig,
    three: ThreeModels,
    taps: TappedModes,
    seen: Measured,
    out: Path,
    jobs: int,
    progress: Progress,
    samples: int = SAMPLES,
) -> Json:
    """The three conditions, the posterior beside them, the shares of the variance, and the emulator.

    Args:
        given: the rig as its owner describes it, with the force test's excitation.
        three: models of this clearance.
        taps: of the force test, which the posterior is made from.
        seen: the table test, which judges.
        out: folder of the results.
        jobs: cores.
        progress: told what is being done.
        samples: of each condition.

    Raises:
        DivergenceError: a rig's motion left the finite numbers.
    """
    rig = with_mean_damping(three.rigs[UPDATED])
    course = np.stack([told["damping"] for told in three.identified.values()], axis=1)
    inputs = (rig, given, course, taps.natural_freqs, taps.damping_ratios, seen.modes.natural_freqs, samples)
    signals = seen.test.struck.excitation, seen.test.struck.responses
    chosen = (CONDITIONS, WALKERS, STEPS, BURNT, EVERY, LOG_COURSE, MISFITS, TRAINED_ON, CHECKED_ON, BASE)
    return kept(
        out / KEPT,
        digest_of(*inputs, *signals, *chosen),
        lambda: _found(rig, given, course, taps, seen, jobs, progress, samples),
    )


def _found(
    rig: Rig,
    given: Rig,
    course: FloatArray,
    taps: TappedModes,
    seen: Measured,
    jobs: int,
    progress: Progress,
    samples: int,
) -> Json:
    progress(f"probability: {samples} rigs in each of {len(CONDITIONS)} conditions, and with all random")
    motion = SmallMotion.of(rig)
    freqs = {what: condition(motion, rig, what, samples) for what in CONDITIONS}
    together = condition(motion, rig, None, samples)
    shares = frequency_shares(motion, rig)
    progress("probability: the posterior of what the taps say")
    nominal = SmallMotion.of(given)
    told = posterior(nominal, given, taps, course)
    at_taps, tests = told.at_taps(nominal, course), seen.modes.natural_freqs
    computed = at_taps.reshape(-1, tests.shape[1])
    progress("probability: emulating the struck response, and checking the emulator")
    driven = rig.model_copy(update={"excitation": seen.rig.excitation})
    answer = emulated(driven, seen.test.struck, TIP, jobs)
    ends = [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE]
    return {
        "samples": samples,
        "conditions": {
            **{what: _statistics(found) for what, found in freqs.items()},
            "all": _statistics(together),
        },
        "posterior": {
            **_statistics(at_taps.mean(axis=1), told.independent),
            "samples": len(told.numbers),
            "stiffness": [told.draws.stiffness.mean(axis=0), told.draws.stiffness.std(axis=0)],
            "damping_factor": [told.draws.damping.mean(axis=0), told.draws.damping.std(axis=0)],
            "modulus": [told.draws.modulus.mean(), told.draws.modulus.std()],
            "own_errors": np.median(np.array(MISFITS) * np.exp(told.numbers[:, 5:]), axis=0),
            "correlation": np.corrcoef(told.numbers.T),
            "numbers": NUMBERS,
            "steps_to_forget": told.forgotten,
            "independent": told.independent,
        },
        "coincidence": {
            "posterior": [coincidence(computed[:, order], tests[:, order]) for order in range(4)],
            "assumed": [coincidence(together[:, order], tests[:, order]) for order in range(4)],
        },
        "difference": vars(difference(at_taps, tests)),
        "intervals": {
            "test": tests.mean(axis=0),
            "alone": motion.natural_freqs(Draws.of(rig, 1))[0],
            "posterior": np.quantile(at_taps.mean(axis=1), ends, axis=0).T,
            "assumed": np.quantile(together, ends, axis=0).T,
        },
        "shares": {"names": NAMES, **vars(shares)},
        "emulator": {
            **{key: value for key, value in vars(answer).items() if key != "samples"},
            "mean": answer.samples.mean(),
            "std": answer.samples.std(),
            "interval": np.quantile(answer.samples, ends),
            "measured": np.std(seen.test.struck.responses[seen.test.struck.sensors.index(TIP)]),
        },
        "densities": _densities(computed, together, tests),
    }


def with_mean_damping(rig: Rig) -> Rig:
    """An updated rig whose dampings stay at their mean over the test, where they were told.

    Args:
        rig: with ``time_varying_damping`` in some sleeves.
    """
    told = {entry.sleeve: entry.settings["values"] for entry in rig.effects if entry.kind == "time_varying_damping"}
    sleeves = tuple(
        sleeve.model_copy(update={"damping": float(np.mean(told[sleeve.name]))}) if sleeve.name in told else sleeve
        for sleeve in rig.sleeves
    )
    others = tuple(entry for entry in rig.effects if entry.kind != "time_varying_damping")
    return rig.model_copy(update={"sleeves": sleeves, "effects": others})


def _statistics(freqs: FloatArray, independent: float | None = None) -> Json:
    found = Statistics.of(freqs, independent)
    return {**vars(found), "variation": found.variation}


def _densities(*samples: FloatArray) -> list[Json]:
    """Per order the densities of the posterior, of the assumed distributions and of the tests, for the figure."""
    rows = []
    for order in range(4):
        columns = [sample[:, order] for sample in samples]
        narrow = np.concatenate([columns[0], columns[2]])
        room = 0.5 * np.ptp(narrow)
        grid = np.linspace(narrow.min() - room, narrow.max() + room, DRAWN)
        keys = ("posterior", "assumed", "tests")
        curves = {key: gaussian_kde(column)(grid) for key, column in zip(keys, columns, strict=True)}
        rows.append({"frequency": grid, **curves})
    return rows
