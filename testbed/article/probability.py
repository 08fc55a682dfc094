"""Section 4.3 of the article and beyond it: what uncertain numbers do to frequencies and to the struck response."""

import json
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import gaussian_kde

from identification.progress import Progress
from models.arrays import FloatArray
from models.rig import Rig
from testbed.article.emulated import NAMES, emulated, frequency_shares
from testbed.article.judging import Measured
from testbed.article.reading import TappedModes
from testbed.article.rig import TIP
from testbed.article.small_motion import Draws, SmallMotion
from testbed.article.three_models import UPDATED, ThreeModels
from testbed.article.uncertain import (
    CONDITIONS,
    CONFIDENCE,
    SAMPLES,
    Statistics,
    coincidence,
    condition,
    difference,
    posterior,
)
from testbed.outputs import json_text, keep_json

Json = dict[str, Any]

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
        jobs: threads.
        progress: told what is being done.
        samples: of each condition.

    Raises:
        DivergenceError: a rig's motion left the finite numbers.
    """
    rig = with_mean_damping(three.rigs[UPDATED])
    path, made_of = out / KEPT, _made_of(rig, taps, seen, samples)
    if not path.is_file() or json.loads(path.read_text(encoding="utf-8")).get("made_of") != made_of:
        progress(f"probability: {samples} rigs in each of {len(CONDITIONS)} conditions")
        motion = SmallMotion.of(rig)
        freqs = {what: condition(motion, rig, what, samples) for what in CONDITIONS}
        shares = frequency_shares(motion, rig)
        progress("probability: the posterior of what the taps say")
        nominal = SmallMotion.of(given)
        found = posterior(nominal, given, taps, samples)
        computed = nominal.natural_freqs(found.draws)
        progress("probability: emulating the struck response, and checking the emulator")
        driven = rig.model_copy(update={"excitation": seen.rig.excitation})
        answer = emulated(driven, seen.test.struck, TIP, jobs)
        measured = float(np.std(seen.test.struck.responses[seen.test.struck.sensors.index(TIP)]))
        tests = seen.modes.natural_freqs
        assumed = np.concatenate(list(freqs.values()))
        content = {
            "samples": samples,
            "conditions": {what: _statistics(found_freqs) for what, found_freqs in freqs.items()},
            "posterior": {
                **_statistics(computed),
                "stiffness": [found.draws.stiffness.mean(axis=0), found.draws.stiffness.std(axis=0)],
                "damping": [found.draws.damping.mean(axis=0), found.draws.damping.std(axis=0)],
                "modulus": [found.draws.modulus.mean(), found.draws.modulus.std()],
                "steps_to_forget": found.autocorrelation,
            },
            "coincidence": {
                "posterior": [coincidence(computed[:, order], tests[:, order]) for order in range(4)],
                "assumed": [coincidence(assumed[:, order], tests[:, order]) for order in range(4)],
            },
            "difference": vars(difference(computed, tests)),
            "intervals": {
                "test": tests.mean(axis=0),
                "alone": motion.natural_freqs(Draws.of(rig, 1))[0],
                "posterior": np.quantile(computed, [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], axis=0).T,
                "assumed": np.quantile(assumed, [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE], axis=0).T,
            },
            "shares": {"names": NAMES, **vars(shares)},
            "emulator": {
                **{key: value for key, value in vars(answer).items() if key != "samples"},
                "mean": answer.samples.mean(),
                "std": answer.samples.std(),
                "interval": np.quantile(answer.samples, [0.5 - 0.5 * CONFIDENCE, 0.5 + 0.5 * CONFIDENCE]),
                "measured": measured,
            },
            "densities": _densities(computed, assumed, tests),
        }
        keep_json(path, {"made_of": made_of, **content})
    kept: Json = json.loads(path.read_text(encoding="utf-8"))
    return kept


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


def _statistics(freqs: FloatArray) -> Json:
    found = Statistics.of(freqs)
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


def _made_of(rig: Rig, taps: TappedModes, seen: Measured, samples: int) -> str:
    """Digest of all that is random about."""
    parts = [json_text([rig.model_dump(exclude_none=True), CONDITIONS, samples]).encode()]
    parts += [array.tobytes() for array in (taps.natural_freqs, taps.damping_ratios, seen.test.struck.responses)]
    return sha256(b"".join(parts)).hexdigest()
