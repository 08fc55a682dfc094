"""What is read of a test, how a model is updated with it, and how models are judged."""

from dataclasses import replace

import numpy as np
import pytest

from models.linear import linearised, natural_modes
from models.modal import build_modal
from models.plant import build_plant
from testbed.article.bars import bars_of
from testbed.article.compared import EXACT, EXACT_RIG, PERFECT
from testbed.article.judging import judged, measured
from testbed.article.reading import frfs_of, tapped_modes
from testbed.article.rig import BAND
from testbed.article.tables import bars_table
from testbed.article.truth import truth_of
from testbed.article.updating import closed_at_rest, identified_without_error, updated
from tests.testbed.article.article_scenes import bench_test_by_model, geometry

HALF, TWO = 5e-4, 2e-3


def test_the_taps_show_the_modes_of_the_rig_at_rest():
    """The damping that the last tap shows lies between those of the grease at the taps before and after."""
    truth = truth_of(geometry(), HALF, "force", "modal")
    found = tapped_modes(bench_test_by_model(HALF, "force").taps, geometry().rig(HALF, "force"))
    at_begin = natural_modes(linearised(build_modal(truth.plant, BAND)), (), BAND)
    np.testing.assert_allclose(found.natural_freqs[0], at_begin.natural_freqs[:4], rtol=3e-3)
    assert np.all(found.damping_ratios[0] < at_begin.damping_ratios[:4])
    assert np.all(np.diff(found.damping_ratios, axis=0)[:3] < 0.0)


def test_frfs_are_those_of_the_lines_that_were_driven():
    found = frfs_of(bench_test_by_model(HALF, "table").struck)
    np.testing.assert_allclose(np.diff(found.frequency), 0.5)
    assert found.frequency[0] == pytest.approx(5.0)
    assert found.h1.shape == (8, len(found.frequency))


def test_the_sleeves_that_the_rod_lies_in_are_known():
    assert closed_at_rest(geometry().rig(HALF, "force")) == ("sleeve 1", "sleeve 2")
    assert closed_at_rest(geometry().rig(TWO, "force")) == ("sleeve 2",)


def test_updating_finds_stiffness_and_the_damping_of_all_that_acts_in_contact():
    rig, truth = geometry().rig(HALF, "force"), truth_of(geometry(), HALF, "force", "modal")
    found = updated(rig, tapped_modes(bench_test_by_model(HALF, "force").taps, rig))
    ours, theirs = ({p.path: p.value for p in one.parameters()} for one in (found.rig, truth.built))
    for path, within in (("youngs_modulus", 2e-3), ("sleeves[0].stiffness", 0.04), ("sleeves[1].stiffness", 0.02)):
        assert ours[path] == pytest.approx(theirs[path], rel=within)
    exact, courses = identified_without_error(truth, rig, ("sleeve 1", "sleeve 2"))
    changed = {p.path for p, q in zip(exact.parameters(), rig.parameters(), strict=True) if p.value != q.value}
    assert changed == {"youngs_modulus", "sleeves[0].stiffness", "sleeves[1].stiffness"}
    for effect, other in zip(found.dampings, courses, strict=True):
        np.testing.assert_allclose(effect.values, np.interp(effect.times, other.times, other.values), rtol=0.06)


def test_the_perfect_model_leaves_the_noise_and_every_other_one_more():
    rig, test = geometry().rig(HALF, "table"), bench_test_by_model(HALF, "table")
    seen, truth = measured(rig, test), truth_of(geometry(), HALF, "table", "modal")
    perfect, initial = judged(truth.plant, seen), judged(build_plant(rig), seen)
    assert perfect.nrmse == pytest.approx(test.noise, rel=0.15)  # whose figure ends at 0.35 fs
    assert perfect.frac.min() > 0.9999
    assert perfect.mac.min() > 0.99999
    assert np.abs(perfect.freq_errors).max() < 3e-4
    assert np.all(initial.mre > 20.0 * perfect.mre)


def row(initial, updated, diagnosed):
    """One clearance whose indices are all the same number."""
    keys = ("natural_freqs", "damping_ratios", "freq_errors", "mac", "mre", "rmse", "frac", "csf", "csac", "nrmse")
    models = {"initial": initial, "updated": updated, "diagnosed": diagnosed}
    models |= {EXACT: updated, EXACT_RIG: updated, PERFECT: diagnosed}
    found = {name: {"mujoco": dict.fromkeys(keys, [one] * 4)} for name, one in models.items()}
    return {"clearance": 1e-3, "tests": {"mujoco": {}}, "models": found}


def test_bars_are_met_by_what_is_enough_and_missed_by_what_is_not():
    met = {bar.what: bar.is_met for bar in bars_of([row(1.0, 0.5, 0.1)], "mujoco")}
    assert met["updated: MRE of the FRF"]
    assert met["diagnosed: RMSE of the FRF"]
    assert not met["updated: mean MAC"]
    assert not met["diagnosed: least FRAC of all points"]
    assert not met["updated: largest frequency error"]
    assert not {bar.what: bar.is_met for bar in bars_of([row(1.0, 0.9, 0.3)], "mujoco")}["diagnosed: MRE of the FRF"]


def test_a_missed_bar_says_whose_fault_it_is():
    lines = list(bars_table([row(1.0, 0.9, 0.3)]))
    assert len({line.count("|") for line in lines if line.startswith("|")}) == 1
    assert "updated: MRE of the FRF is missed by the model, not by identification" in lines[-1]
    assert "worst at 1 mm" in lines[-1]


def test_shapes_of_any_phase_are_averaged():
    found = tapped_modes(bench_test_by_model(HALF, "force").taps, geometry().rig(HALF, "force"))
    turned = replace(found, shapes=found.shapes * np.exp(1j * np.arange(len(found.shapes)))[:, None, None])
    np.testing.assert_allclose(np.abs(turned.mean_shapes), np.abs(found.mean_shapes), rtol=1e-12)
