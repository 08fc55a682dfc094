"""A diagnosis tells what one set of numbers does not explain, and nothing where they do."""

from types import MappingProxyType

from identification.diagnose import diagnose
from identification.hypothesis import Hypothesis
from models.effects import EFFECTS, Place
from models.effects.cubic_stiffness import CubicStiffness
from tests.identification.trial_records import measured, moved, multisine, oscillator

RIG = oscillator()


def diagnosed(truth):
    records = [measured(truth, multisine(2048, rms=rms), seed=k, name=f"r{k}")[0] for k, rms in enumerate((3.0, 20.0))]
    return diagnose(RIG, records, registry=MappingProxyType({"sensor_gain": EFFECTS["sensor_gain"]}), jobs=1)


def test_a_drift_with_the_level_stands_among_findings_and_decisions():
    found = diagnosed(Hypothesis(RIG, effects=(CubicStiffness(Place(), 0.3 * RIG.structure.stiffness / 1e-3**2),)))

    assert found.verdict == "unexplained"
    drift = next(each for each in found.calibration if each.what == "records")
    # A stiffness that grows and a mass that falls move a resonance alike, and either may be told first.
    assert ("stiffness" in drift.words and "grows" in drift.words) or ("mass" in drift.words and "falls" in drift.words)
    assert f"calibrated model: {drift.words}" in found.findings
    assert f"calibrated model: {drift.words}" in found.decisions


def test_a_complete_model_has_nothing_to_tell():
    found = diagnosed(moved(RIG, 1.0, -0.8, 1.0))

    assert (found.verdict, found.calibration, found.findings) == ("complete", (), ())
