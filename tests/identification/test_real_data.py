"""Other people's measurements: the effect that their authors describe is found, and a kept part is predicted.

The files lie in the folder that TESTBED_DATA names, in ``friction_frame`` and ``silverbox``, as published.
"""

import os
from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat

from identification.calibrate import calibrate, unknowns_of
from identification.diagnose import diagnose
from identification.hypothesis import Hypothesis
from identification.prepare import prepare
from models.record import Record
from models.rig import Excitation, Oscillator, Rig, Sensor

pytestmark = [pytest.mark.real_data, pytest.mark.slow]


def found_file(*parts):
    """A file of the data, or the test is left out."""
    path = Path(os.environ["TESTBED_DATA"], *parts)
    if not path.is_file():
        pytest.skip(f"TESTBED_DATA holds no {'/'.join(parts)}")
    return loadmat(path)


def rms_error(score, skipped=0):
    (record,) = score.records
    return float(np.sqrt(np.mean((record.predicted - record.record.responses)[:, skipped:] ** 2)))


def run_of(name, fs, excitation, response, part, sensor):
    return Record(name, fs, excitation[part].copy(), (sensor,), response[None, part].copy(), moving_start=True)


FRAME = Rig(
    structure=Oscillator(kind="oscillator", mass=3.0799, stiffness=1191.0, damping=0.669),
    tolerances={"mass": 0.01, "stiffness": 0.02, "damping": 0.2},
    excitation=Excitation(name="base", quantity="base_displacement"),
    sensors=(Sensor(name="top", quantity="displacement"),),
)


def frame_signals(load):
    """fs, Hz, and the displacements of the base, file y, and of the frame, file x, in m (mm in the files)."""
    top, base = (found_file("friction_frame", f"s_b_{load}g_{axis}.mat") for axis in "xy")

    def signal(content):
        return np.ravel(next(v for k, v in content.items() if not k.startswith("_") and k != "t")) * 1e-3

    return 1.0 / float(np.median(np.diff(np.ravel(base["t"])))), signal(base), signal(top)


def test_a_frame_that_rubs_against_the_ground():
    fs, base, top = frame_signals(450)
    half = len(base) // 2
    first = run_of("first half", fs, base, top, slice(None, half), "top")
    second = run_of("second half", fs, base, top, slice(half, None), "top")

    found = diagnose(FRAME, [first], [second], most_effects=1)

    effect = found.added[0].effect
    assert (effect.kind, effect.against) == ("coulomb_friction", "ground")
    assert rms_error(found.holdout["updated"]) <= 0.14e-3
    assert rms_error(found.holdout["as given"]) > 3.0 * rms_error(found.holdout["updated"])


SILVERBOX_FS = 1e7 / 2**14
"""Hz; T. Wigren, J. Schoukens, Three free data sets for development and benchmarking, ECC 2013."""

ARROW = slice(40650, 127400)
"""The samples whose level grows."""


def linear_silverbox():
    """The electronic oscillator as its user would guess it: 68 Hz, 5 % damping, gain 1; V stand for N and m."""
    omega = 2.0 * np.pi * 68.0
    return Rig(
        structure=Oscillator(kind="oscillator", mass=omega**-2, stiffness=1.0, damping=2.0 * 0.05 / omega),
        tolerances={"stiffness": 0.1, "damping": 0.3, "mass": 0.1},
        excitation=Excitation(name="V1", quantity="force"),
        sensors=(Sensor(name="V2", quantity="displacement"),),
    )


def calibrated(rig, record):
    """The rig with the numbers that a record of low level gives."""
    given = Hypothesis(rig)
    evaluator = prepare(given, [record], 2, np.random.default_rng(0))
    return calibrate(evaluator, given, unknowns_of(given, evaluator)).hypothesis.updated_rig


def test_an_electronic_oscillator_that_hardens():
    content = found_file("silverbox", "SNLS80mV.mat")
    drive, answer = content["V1"].ravel(), content["V2"].ravel()
    last_quarter = ARROW.start + int(0.75 * (ARROW.stop - ARROW.start))
    parts = {
        "low": slice(100, 8000),
        "train": slice(ARROW.start, ARROW.start + 20000),
        "kept": slice(last_quarter, ARROW.stop),
    }
    low, train, kept = (run_of(name, SILVERBOX_FS, drive, answer, part, "V2") for name, part in parts.items())
    rig = calibrated(linear_silverbox(), low)
    rig = rig.model_copy(update={"tolerances": {"stiffness": 0.01, "damping": 0.05, "mass": 0.01}})

    found = diagnose(rig, [train], [kept])

    assert found.added[0].effect.kind == "cubic_stiffness"
    assert rms_error(found.holdout["updated"], skipped=50) <= 0.95e-3
