"""A diagnosis tells what one set of numbers does not explain, and nothing where they do."""

from types import MappingProxyType

from identification.diagnose import diagnose
from identification.hypothesis import Hypothesis
from identification.progress import silent
from models.effects import EFFECTS, Place
from models.effects.cubic_stiffness import CubicStiffness
from tests.identification.trial_records import measured, moved, multisine, oscillator

RIG = oscillator()


def diagnosed(truth, progress=silent):
    records = [measured(truth, multisine(2048, rms=rms), seed=k, name=f"r{k}")[0] for k, rms in enumerate((3.0, 20.0))]
    kinds = MappingProxyType({"sensor_gain": EFFECTS["sensor_gain"]})
    return diagnose(RIG, records, registry=kinds, jobs=1, progress=progress)


def test_a_drift_with_the_level_stands_among_the_findings():
    said = []
    found = diagnosed(
        Hypothesis(RIG, effects=(CubicStiffness(Place(), 0.3 * RIG.structure.stiffness / 1e-3**2),)), said.append
    )

    assert found.verdict == "unexplained"
    drift = next(each for each in found.calibration if each.what == "records")
    # A stiffness that grows and a mass that falls move a resonance alike, and either may be told first.
    assert ("stiffness" in drift.words and "grows" in drift.words) or ("mass" in drift.words and "falls" in drift.words)
    assert drift.told == f"calibrated model: {drift.words}"
    assert drift.told in found.all_findings
    assert drift.told in said
    assert drift.told not in found.decisions


def test_a_complete_model_has_nothing_to_tell():
    found = diagnosed(moved(RIG, 1.0, -0.8, 1.0))

    assert (found.verdict, found.calibration, found.all_findings) == ("complete", (), ())
