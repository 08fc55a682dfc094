"""A diagnosis tells what one set of numbers does not explain, and nothing where they do."""

from dataclasses import replace
from types import MappingProxyType

from identification.calibrate import unknowns_of
from identification.consistency.find import beyond_models
from identification.consistency.finding import CalibrationFinding
from identification.diagnose import diagnose
from identification.fit import fit
from identification.hypothesis import Hypothesis
from identification.progress import silent
from models.effects import EFFECTS, Place
from models.effects.cubic_stiffness import CubicStiffness
from tests.identification.trial_records import evaluator_of, measured, moved, multisine, oscillator

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
    assert drift.told not in said  # it stands with the result, once
    assert drift.told not in found.decisions


def of_modes(sigma):
    """A number that the lower modes tell otherwise than the higher ones."""
    return CalibrationFinding(
        "modes", "youngs_modulus", ("modes 1 to 4", "those above"), (2.0738e11, 2.0731e11), (5e6, 5e6), "Pa", sigma, ""
    )


def test_what_two_codes_tell_apart_is_no_contradiction_where_the_noise_is_reached():
    record, noise = measured(Hypothesis(RIG), multisine(2048, rms=3.0))
    evaluator = evaluator_of((record, noise), rig=RIG)
    reached = fit(evaluator, Hypothesis(RIG), unknowns_of(Hypothesis(RIG), evaluator), max_iterations=0)
    left = replace(of_modes(3.6), what="tolerance")

    assert beyond_models([of_modes(2.5), left], replace(reached, n_data=100_000)) == (left,)
    assert beyond_models([of_modes(8.9), left], replace(reached, n_data=100_000)) == (left,)
    assert beyond_models([of_modes(60.0)], replace(reached, n_data=100_000)) == (of_modes(60.0),)
    assert beyond_models([of_modes(8.9)], replace(reached, n_data=1_000)) == (of_modes(8.9),)


def test_a_complete_model_has_nothing_to_tell():
    found = diagnosed(moved(RIG, 1.0, -0.8, 1.0))

    assert (found.verdict, found.calibration, found.all_findings) == ("complete", (), ())
