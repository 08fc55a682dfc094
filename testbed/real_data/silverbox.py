"""The Silverbox: an electronic oscillator with a hardening spring, and what is beyond that.

Source: T. Wigren, J. Schoukens, Three free data sets for development and benchmarking in nonlinear system
identification, ECC 2013, 2933.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import pi
from pathlib import Path

import numpy as np
from scipy.signal import welch

from identification.diagnose import diagnose
from identification.hypothesis import Hypothesis
from identification.progress import Progress
from identification.result import Diagnosis
from models.arrays import FloatArray
from models.record import Record
from models.rig import Excitation, Oscillator, Rig, Sensor
from models.simulate import Settings
from testbed.real_data.bars import Bar
from testbed.real_data.files import read_variables, set_folder

SOURCE = "nonlinearbenchmark.org (Silverbox)"
FILE = "SNLS80mV.mat"
FS = 1e7 / 2**14
"""Hz."""

ARROW, MULTISINES = slice(100, 40575), slice(40650, 127400)
"""Samples: noise whose level grows, never trained on; ten odd random-phase multisines."""

TRAINED = 20000
"""Samples of the multisines that are learnt from; the last quarter of all is the test."""

SKIPPED = 50
"""Samples of a test that are not scored."""

MULTISINE_BAR, ARROW_BAR = 0.5, 0.7
"""MV, rms of free simulation."""


@dataclass(frozen=True, eq=False)
class Test:
    """One part that is predicted from its input alone.

    Attributes:
        run: simulated from rest, with what comes before the part.
        scored: samples of the run that count.
    """

    run: Record
    scored: slice


@dataclass(frozen=True, eq=False)
class Silverbox:
    """The finished study.

    Attributes:
        diagnosis: from the training part alone.
        errors: label of a stage -> (multisine test, arrow) rms error, mV.
        frequency: (n,) Hz.
        spectra: label -> (n,) V/sqrt(Hz), the multisine test as measured and what each stage leaves of it.
    """

    diagnosis: Diagnosis
    errors: Mapping[str, tuple[float, float]]
    frequency: FloatArray
    spectra: Mapping[str, FloatArray]

    @property
    def bars(self) -> tuple[Bar, ...]:
        """What it has to reach."""
        first = self.diagnosis.added[0].effect.kind if self.diagnosis.added else "nothing"
        multisine, arrow = self.errors[self.diagnosis.final.label]
        return (
            Bar("named first", first, "cubic_stiffness"),
            Bar("multisine test", multisine, MULTISINE_BAR, "mV"),
            Bar("arrow", arrow, ARROW_BAR, "mV"),
        )


def guessed_rig() -> Rig:
    """The circuit as its user would guess it: 68 Hz, 5 % damping, gain 1; V stand for N and for m."""
    omega = 2.0 * pi * 68.0
    return Rig(
        structure=Oscillator(kind="oscillator", mass=omega**-2, stiffness=1.0, damping=2.0 * 0.05 / omega),
        tolerances={"stiffness": 0.1, "damping": 0.3, "mass": 0.1},
        excitation=Excitation(name="V1", quantity="force"),
        sensors=(Sensor(name="V2", quantity="displacement"),),
    )


def study_silverbox(folder: Path, seed: int, jobs: int, progress: Progress) -> Silverbox:
    """Diagnose the circuit from a part of the multisines and predict the rest.

    Args:
        folder: with the published file.
        seed: of every random choice.
        jobs: cores.
        progress: told what is being done.

    Raises:
        InputError: the file is missing or not the published one.
    """
    content = read_variables(set_folder(folder, "silverbox") / FILE, ("V1", "V2"), SOURCE)
    drive, answer = np.ravel(content["V1"]).astype(float), np.ravel(content["V2"]).astype(float)

    def run_of(name: str, part: slice) -> Record:
        return Record(name, FS, drive[part].copy(), ("V2",), answer[None, part].copy())

    learnt = slice(MULTISINES.start, MULTISINES.start + TRAINED)
    train = replace(run_of("multisines, first part", learnt), moving_start=True)
    n_kept = (MULTISINES.stop - MULTISINES.start) // 4
    multisines = run_of("multisines", slice(ARROW.stop, MULTISINES.stop))
    arrow = run_of("arrow", slice(0, ARROW.stop))
    tests = (
        Test(multisines, slice(multisines.n_samples - n_kept, None)),
        Test(arrow, slice(ARROW.start + SKIPPED, None)),
    )
    found = diagnose(guessed_rig(), [train], seed=seed, jobs=jobs, progress=progress)
    errors: dict[str, tuple[float, float]] = {}
    spectra = {"measured": _spectrum(answer[MULTISINES.stop - n_kept : MULTISINES.stop])}
    for stage in found.stages:
        progress(f"predicting the tests: {stage.label}")
        ends = [_left(stage.hypothesis, train.name, test) for test in tests]
        first, second = (float(1e3 * np.sqrt(np.mean(end**2))) for end in ends)
        errors[stage.label], spectra[stage.label] = (first, second), _spectrum(ends[0])
    return Silverbox(found, errors, np.linspace(0.0, 0.5 * FS, LINES // 2 + 1), spectra)


LINES = 2048
"""Samples of the stretches over which spectra are averaged."""


def _spectrum(signal: FloatArray) -> FloatArray:
    return np.asarray(np.sqrt(welch(signal, FS, nperseg=LINES)[1]))


def _left(hypothesis: Hypothesis, trained: str, test: Test) -> FloatArray:
    """(N,) V, predicted from the input alone less measured: from rest, with the zero that the training found."""
    zero = hypothesis.offsets.get(trained, 0.0)
    model = replace(hypothesis, starts={}, offsets={test.run.name: zero})
    predicted = model.simulated(test.run, Settings()).channels
    return np.asarray((predicted - test.run.responses)[0, test.scored])
