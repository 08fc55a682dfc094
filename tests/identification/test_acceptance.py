"""What the end of a diagnosis is called: found, complete, or unexplained where an imitation is all there is."""

from dataclasses import replace

import numpy as np
import pytest
from trial_records import (
    REFERENCE,
    beam_session,
    evaluator_of,
    fit_of,
    found_with,
    measured,
    moved,
    multisine,
    oscillator,
)

from identification import acceptance
from identification.acceptance import (
    accepted,
    fit_without,
    in_doubt,
    is_enough,
    is_explained,
    is_incomplete,
    is_of_one_law,
    look_without,
    pruned,
    refuted,
    verdict_of,
    worth_fitting,
)
from identification.established import NO_LAW_OF_ALL, NO_SIZE, TOLD_BY_PARTS
from identification.evaluate import unwhitened
from identification.evidence import Ranked
from identification.fit import fit
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
from identification.kept_aside import KeptAside
from identification.prepare import Horizon
from identification.reached import NOISE_REACHED, is_silenced, missed
from identification.rest_target import ModesTarget
from models.effects import Place
from models.effects.coulomb_friction import CoulombFriction
from models.effects.force_gain import ForceGain
from models.effects.point_mass import PointMass
from models.effects.sensor_gain import SensorGain
from models.record import ModeShapeRecord

MASS = PointMass(Place(position=0.7), mass=0.3)

LOUD = evaluator_of(measured(Hypothesis(REFERENCE), multisine(), noise=0.1))
"""Records whose noise is far above what any two models differ by."""


class Listener:
    """A session that hears decisions, and knows whether a number had to leave its tolerance."""

    class everything:  # noqa: N801
        timed = ("a record",)

    not_followed = ""
    is_beyond = False

    def __init__(self, *, is_passing=False, has_left=False, fitting=LOUD, whole=None):
        self.decisions, self.is_passing, self.has_left, self.fitting = [], is_passing, has_left, fitting
        self.all_predicted, self.ended = whole or (fitting, None)

    def to_the_end(self, calibrated):
        return self.ended or calibrated

    def left_tolerance(self, calibrated):
        return self.has_left

    def decide(self, text):
        self.decisions.append(text)


def fit_with_ratio(ratio, *, effect):
    found = fit_of(MASS, 1000.0 * ratio**2)
    return found if effect else replace(found, hypothesis=replace(found.hypothesis, effects=()), unknowns=())


def called(calibrated, final=None, in_error=None, **session):
    session = Listener(**session)
    base = fit_with_ratio(calibrated, effect=False)
    base = replace(base, residual=np.full(session.fitting.n_data, calibrated))
    end = base if final is None else fit_with_ratio(final, effect=True)
    left = calibrated if final is None else final if in_error is None else in_error
    end = replace(end, residual=np.full(session.fitting.n_data, left))
    return verdict_of(session, base, end), session.decisions[-1]


@pytest.mark.parametrize(
    ("calibrated", "final", "verdict"),
    [
        (10.0, 1.05, "missing_effect"),
        (2.0, 1.1, "missing_effect"),
        (9.0, 1.5, "missing_effect"),
        (60.0, 4.0, "missing_effect"),
        (2.2, 1.45, "unexplained"),
        (10.0, 2.8, "unexplained"),
        (30.0, 6.0, "unexplained"),
    ],
)
def test_an_effect_is_named_where_little_is_left_of_the_misfit(calibrated, final, verdict):
    assert called(calibrated, final)[0] == verdict


@pytest.mark.parametrize(
    ("ratio", "missed", "calibrated", "expected"),
    [
        (1.3, True, 5.0, True),
        (1.1, True, 5.0, False),
        (1.3, False, 5.0, False),
        (4.0, True, 12.0, False),
        (1.3, True, 20.0, False),
    ],
)
def test_what_neither_reaches_the_noise_nor_predicts_is_no_diagnosis(ratio, missed, calibrated, expected):
    session, last = Listener(), fit_with_ratio(ratio, effect=True)
    kept = KeptAside({}, {"burst": "what was learnt does not hold there"} if missed else {})

    assert refuted(session, fit_with_ratio(calibrated, effect=False), last, last, kept, []) == expected

    told = f"unexplained after all: {MASS.label()} comes nearest, but leaves 1.30 times the noise where fitted, "
    assert session.decisions == ([f"{told}and what was learnt does not hold on burst"] if expected else [])


def test_where_a_law_beyond_the_library_was_found_nothing_is_complete():
    session = Listener()
    base = fit_with_ratio(1.1, effect=False)
    assert verdict_of(session, base, base) == "complete"
    session.is_beyond = True
    assert verdict_of(session, base, base) == "unexplained"


def test_the_error_is_told_where_it_is_not_what_the_lines_leave():
    assert called(10.0, 1.05)[1] == "missing effect found; residual 1.05 times the noise"
    assert called(10.0, 1.05, in_error=2.0)[1].startswith("missing effect found; residual 1.05 times the noise line by")
    assert "and 2.0 times in the error" in called(10.0, 1.05, in_error=2.0)[1]


@pytest.mark.parametrize(("left", "verdict"), [(0.3, "unexplained"), (0.05, "missing_effect")])
def test_what_leaves_much_of_the_motion_is_no_diagnosis_however_much_it_took_away(left, verdict):
    evaluator, calibrated = quiet(error=8.0)
    _, near = quiet(error=left)
    final = replace(fit_leaving(near.chi2, near.residual, effect=True), hypothesis=near.hypothesis.with_effects(MASS))
    assert calibrated.ratio > final.ratio > 10.0
    assert verdict_of(Listener(fitting=evaluator), calibrated, final) == verdict


def test_what_nothing_explains_is_complete_only_within_what_is_known_of_the_noise():
    assert called(1.1)[0] == "complete"
    assert called(1.2)[0] == "complete"
    assert called(1.4)[0] == "unexplained"


@pytest.mark.parametrize("is_passing", [False, True])
def test_what_reaches_the_noise_with_a_number_beyond_its_tolerance_is_not_complete(is_passing):
    assert called(1.0, is_passing=is_passing, has_left=True)[0] == "unexplained"


def test_what_is_left_of_an_event_that_passes_is_no_effect():
    verdict, words = called(1.6, is_passing=True)

    assert verdict == "complete"
    assert "but for an event that passes" in words


def quiet(*, error, rig=REFERENCE):
    """Records with hardly any noise, and a calibrated model that leaves this share of them."""
    evaluator = evaluator_of(measured(Hypothesis(rig), multisine(4096), noise=5e-4))
    (target,) = evaluator.targets
    true, wrong = Hypothesis(rig), moved(rig, *[0.002] * len(rig.parameters()))
    residual = target.residual(wrong, evaluator.settings) - target.residual(true, evaluator.settings)
    spectrum = unwhitened(residual, target)
    shares = np.sum(np.abs(spectrum) ** 2, axis=1) / np.sum(np.abs(target.measured) ** 2, axis=1)
    residual *= error / np.sqrt(np.mean(shares) * target.record.n_samples)
    residual += np.random.default_rng(0).standard_normal(len(residual))
    calibrated = fit_leaving(float(np.sum(residual**2)), residual, effect=False)
    return evaluator, replace(calibrated, hypothesis=Hypothesis(rig))


def fit_leaving(chi2, residual, *, effect):
    return replace(fit_with_ratio(1.0, effect=effect), chi2=chi2, n_data=len(residual), residual=residual)


@pytest.mark.parametrize(("error", "verdict"), [(0.003, "complete"), (0.007, "unexplained")])
@pytest.mark.parametrize("searched_in_vain", [True, False])
def test_no_model_is_asked_to_be_closer_than_two_models_of_one_rig_are(error, verdict, searched_in_vain):
    fitting, calibrated = quiet(error=error)
    assert calibrated.ratio > 1.5
    imitation = fit_leaving(0.6 * calibrated.chi2, calibrated.residual, effect=True)
    session = Listener(fitting=fitting)

    found = verdict_of(session, calibrated, imitation if searched_in_vain else calibrated)

    assert found == verdict
    assert verdict == "unexplained" or "misses 0.3" in session.decisions[-1]


def test_where_no_wall_is_struck_two_models_are_nearer():
    for error, verdict in ((0.0007, "complete"), (0.003, "unexplained")):
        fitting, calibrated = quiet(error=error, rig=oscillator())
        calibrated = replace(calibrated, chi2=4.0 * calibrated.n_data)

        assert verdict_of(Listener(fitting=fitting), calibrated, calibrated) == verdict


@pytest.mark.parametrize(("share", "taken_out"), [(0.6, False), (0.95, False), (0.0, True)])
def test_what_an_effect_explains_is_not_the_models_own_error(share, taken_out):
    """An effect that takes away most and yet is no diagnosis, or one whose numbers are not told, may be there."""
    fitting, calibrated = quiet(error=0.003)
    calibrated = replace(calibrated, chi2=30.0 * calibrated.n_data)
    left = calibrated.n_data + (1.0 - share) * (calibrated.chi2 - calibrated.n_data)
    effect = fit_leaving(left, calibrated.residual, effect=True)
    final = calibrated if taken_out else effect
    assert taken_out or effect.ratio > 1.15

    session = Listener(fitting=fitting)

    assert verdict_of(session, calibrated, final, taken_out=taken_out) == "unexplained"


def test_records_of_small_motion_must_reach_the_noise_beside():
    fitting, calibrated = quiet(error=0.003)
    rest = ModesTarget.of(ModeShapeRecord("modes", ("P1",), np.array([10.0]), None, np.ones((1, 1), complex)))
    both = fitting.with_targets([*fitting.targets, rest])
    for size, verdict in ((1.0, "complete"), (3.0, "unexplained")):
        residual = np.append(calibrated.residual, np.full(rest.n_data, size))
        found = replace(calibrated, residual=residual, n_data=len(residual))

        assert verdict_of(Listener(fitting=both), found, found) == verdict


def test_what_was_not_fitted_is_asked_too():
    """A sweep whose first seconds are right: a model that fails later is no complete one."""
    part, calibrated = quiet(error=0.003)
    whole = quiet(error=0.05)

    assert verdict_of(Listener(fitting=part), calibrated, calibrated) == "complete"
    assert verdict_of(Listener(fitting=part, whole=whole), calibrated, calibrated) == "unexplained"


def test_complete_tells_how_much_of_the_records_it_is_about():
    part, calibrated = quiet(error=0.003)
    for ratio in (1.0, 1.6):  # at the noise, and by the models' own error
        session = Listener(fitting=part)
        session.not_followed = "; only 1.0 of 4.0 s"
        found = replace(calibrated, chi2=ratio**2 * calibrated.n_data)

        assert verdict_of(session, found, found) == "complete"
        assert session.decisions[-1].endswith("; only 1.0 of 4.0 s")


def test_a_law_that_explains_even_so_little_is_named():
    fitting, calibrated = quiet(error=0.003)
    law = fit_leaving(float(fitting.n_data), calibrated.residual, effect=True)

    assert verdict_of(Listener(fitting=fitting), calibrated, law) == "missing_effect"


def test_the_record_that_is_missed_most_counts():
    right = measured(Hypothesis(oscillator()), multisine(), name="right", noise=5e-4)
    wrong = measured(moved(oscillator(), 0.0, 0.01, 0.0), multisine(), name="wrong", noise=5e-4)

    assert missed_of(right, wrong) == pytest.approx(missed_of(wrong))
    assert missed_of(wrong) > 1e-3 > 2.0 * missed_of(right)


def missed_of(*records):
    evaluator = evaluator_of(*records)
    residual = evaluator.residuals([(Hypothesis(oscillator()), None)])[0]
    return missed(evaluator, replace(fit_with_ratio(1.0, effect=False), residual=residual))


def test_a_channel_in_another_unit_counts_as_much_as_the_others():
    """A displacement in metres that is half wrong beside accelerations a hundred thousand times as large."""
    quiet_ones = REFERENCE.model_copy(update={"sensors": REFERENCE.sensors[:4]})
    read = (*quiet_ones.sensors[:3], quiet_ones.sensors[3].model_copy(update={"quantity": "displacement"}))
    rig = quiet_ones.model_copy(update={"sensors": read})
    record, noise = measured(Hypothesis(rig), multisine(), noise=1e-4)
    evaluator = evaluator_of((replace(record, responses=record.responses * [[1.0], [1.0], [1.0], [1.5]]), noise))
    residual = evaluator.residuals([(Hypothesis(rig), None)])[0]

    found = missed(evaluator, replace(fit_with_ratio(1.0, effect=False), residual=residual))

    assert found == pytest.approx(np.sqrt(0.25 * (1.0 / 3.0) ** 2), rel=0.01)


def test_an_imitation_is_told_with_its_share():
    _, words = called(2.2, 1.45)

    assert "leaves 1.45 times the noise" in words
    assert "takes away 71.3% of the misfit" in words


def test_the_newest_makes_a_later_one_needless_too():
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE, effects=(MASS,)), multisine(2048, rms=2.0)))
    patch = PointMass(Place(position=1.3), mass=0.01)
    session = Listener()
    session.fitting = evaluator
    base = fit(evaluator, Hypothesis(REFERENCE), rig_unknowns(REFERENCE))
    both = Hypothesis(REFERENCE, effects=(MASS, patch))
    found = fit(evaluator, both, (*rig_unknowns(REFERENCE), *effect_unknowns(both)))

    ((index, less),) = pruned(session, base, found, newest=0)

    assert index == 1
    assert [effect.place.position for effect in less.hypothesis.effects] == pytest.approx([0.7], abs=1e-3)
    assert "beside point_mass at 0.700 m the noise is reached without it" in session.decisions[-1]


PATCH = PointMass(Place(position=1.3), mass=0.001)
"""So light that without it little more than the noise is left."""


def test_a_faint_effect_is_kept_where_it_takes_nearly_all_that_is_left_beside_another():
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE, effects=(MASS, PATCH)), multisine(8192, rms=2.0)))
    session = Listener()
    session.fitting = evaluator
    base, less, found = (
        fit(evaluator, hypothesis, (*rig_unknowns(REFERENCE), *effect_unknowns(hypothesis)))
        for hypothesis in (Hypothesis(REFERENCE, effects=effects) for effects in ((), (MASS,), (MASS, PATCH)))
    )
    assert is_enough(session, less)
    assert not is_explained(session, less)
    assert is_explained(session, found)
    assert not list(pruned(session, base, found, newest=0))


@pytest.mark.parametrize(("share", "added"), [(0.95, True), (0.5, False)])
def test_beside_an_effect_that_reaches_the_noise_another_must_take_nearly_all_that_is_left(share, added):
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE, effects=(MASS,)), multisine(2048, rms=2.0)))
    session = Listener()
    session.fitting = session.everything = evaluator
    session.limits, session.holds = [Horizon("test", 1.0, 1.0)], lambda _: True
    one, both = Hypothesis(REFERENCE, effects=(MASS,)), Hypothesis(REFERENCE, effects=(MASS, PATCH))
    found = fit(evaluator, both, (*rig_unknowns(REFERENCE), *effect_unknowns(both)), max_iterations=0)
    found = replace(found, chi2=float(found.n_data), penalty=0.0)
    base = fit(evaluator, one, (*rig_unknowns(REFERENCE), *effect_unknowns(one)), max_iterations=0)
    base = replace(base, chi2=1.1**2 * base.n_data, penalty=0.0)
    left = replace(found, chi2=base.n_data + (1.0 - share) * (base.chi2 - base.n_data))

    chosen = accepted(session, base, [Ranked.of(left)])

    assert (chosen is not None) == added
    assert added or "takes away only 50% of the misfit: not added" in session.decisions[-1]


@pytest.mark.parametrize(("both", "kept"), [(True, True), (False, False)], ids=["in every record", "in one record"])
def test_an_effect_whose_size_is_not_known_is_kept_where_the_other_records_need_it(both, kept):
    truths = [Hypothesis(REFERENCE, effects=(MASS,)), Hypothesis(REFERENCE, effects=(MASS,) if both else ())]
    pairs = [measured(t, multisine(seed=k, rms=2.0), name=f"record {k}") for k, t in enumerate(truths, start=1)]
    session, unknowns = Listener(fitting=evaluator_of(*pairs)), rig_unknowns(REFERENCE)
    calibrated = fit(session.fitting, Hypothesis(REFERENCE), unknowns, precise=True)
    heavy = Hypothesis(REFERENCE, effects=(MASS,))
    final = fit(session.fitting, heavy, (*unknowns, *effect_unknowns(heavy, places=False)), precise=True)
    unsure = replace(final, covariance=1e12 * final.covariance)

    assert in_doubt(session, calibrated, final, final) is None
    assert session.decisions == []
    assert in_doubt(session, calibrated, final, unsure) == (None if kept else (0, NO_SIZE))
    assert [text.startswith("point_mass at 0.700 m: its size moves far") for text in session.decisions] == [True] * kept


@pytest.mark.parametrize("predicted", [True, False])
def test_a_law_that_parts_disagree_about_is_kept_where_it_predicts_what_was_kept_aside(predicted):
    session, asked = Listener(), []
    last = fit_of(CoulombFriction(MASS.place, 5.0, 1.0), 1000.0)
    last = replace(last, covariance=1.5 * TOLD_BY_PARTS**2 * np.eye(2), widened=np.array([2.0, 2.0]))

    doubted = in_doubt(session, last, last, last, lambda model: asked.append(model) or predicted)

    assert doubted == (None if predicted else (0, NO_LAW_OF_ALL))
    assert asked == [last.hypothesis]
    assert ["what was kept aside is predicted" in told for told in session.decisions] == [True] * predicted


def test_two_laws_at_one_place_are_no_diagnosis():
    session, one = Listener(), CoulombFriction(MASS.place, 5.0, 1.0)
    found = fit_of(one, 1000.0)

    def with_two(other):
        model = replace(found.hypothesis, effects=(one, other))
        unknowns = effect_unknowns(model)
        return replace(found, hypothesis=model, unknowns=unknowns, covariance=1e-8 * np.eye(len(unknowns)))

    assert not is_of_one_law(session, with_two(replace(one, place=Place(position=0.3))))
    assert session.decisions == []
    assert is_of_one_law(session, with_two(replace(one, place=Place(position=0.705))))
    assert session.decisions[0].startswith(
        "unexplained after all: coulomb_friction against base at 0.700 m and coulomb_friction against base at 0.705 m "
    )


@pytest.mark.parametrize(
    ("explained", "others", "told"),
    [
        (None, 0, ()),
        (True, 0, ()),
        (
            False,
            0,
            ("unexplained after all: {} comes nearest, but no numbers of it were found that explain burst as well",),
        ),
        (False, 1, ("another in its place may explain burst: what cannot be told from it stays in question",)),
    ],
)
def test_what_reaches_the_noise_is_refuted_by_what_no_numbers_explain(explained, others, told):
    session, last = Listener(), fit_with_ratio(1.05, effect=True)
    kept = KeptAside({}, {"burst": "what was learnt does not hold there"}, explained=explained)
    ranked = [Ranked.of(last), *[replace(Ranked.of(last), log_evidence=-1.0)] * others]

    assert refuted(session, fit_with_ratio(50.0, effect=False), last, last, kept, [ranked]) == (
        explained is False and not others
    )

    assert len(session.decisions) == len(told)
    assert all(said.startswith(words.format(MASS.label())) for said, words in zip(session.decisions, told, strict=True))


@pytest.mark.parametrize(("explained", "incomplete"), [(None, False), (True, False), (False, True)])
def test_a_calibrated_model_is_incomplete_only_where_no_numbers_explain_what_was_kept_aside(explained, incomplete):
    session = Listener()

    assert is_incomplete(session, KeptAside({}, {"burst": "it does not hold"}, explained=explained)) == incomplete

    assert [said.split(":")[0] for said in session.decisions] == ["unexplained after all"] * incomplete


def test_a_model_with_an_effect_less_is_fitted_to_its_end_only_where_its_first_steps_come_near(monkeypatch):
    gain, mass = SensorGain(Place(sensor="P4"), gain=0.8), PointMass(Place(position=0.86), mass=1e-4)
    session = beam_session(gain)
    calibrated, found = found_with(session), found_with(session, mass, gain)
    assert worth_fitting(found) == pytest.approx(3.0, rel=0.1)
    assert look_without(session, calibrated, found, 0).ratio < worth_fitting(found)
    assert look_without(session, calibrated, found, 1).ratio > worth_fitting(found)
    fitted = []

    def to_its_end(session, calibrated, found, index):
        fitted.append(index)
        return fit_without(session, calibrated, found, index)

    monkeypatch.setattr(acceptance, "fit_without", to_its_end)
    ((taken, less),) = pruned(session, calibrated, found, newest=1)
    assert (taken, less.ratio) == (0, pytest.approx(1.0, abs=0.1))
    assert pruned(session, calibrated, found, newest=0) == []
    assert fitted == [0]


@pytest.mark.parametrize(
    ("effect", "verdict"), [(ForceGain(Place(), gain=450.0), "unexplained"), (MASS, "missing_effect")]
)
def test_a_model_that_says_that_nothing_moves_is_no_diagnosis(effect, verdict):
    """Noise of three times the motion: a force divided by 450 leaves little more than the right model."""
    noisy = evaluator_of(measured(Hypothesis(REFERENCE).with_effects(MASS), multisine(), noise=3.0))
    final = fit(noisy, Hypothesis(REFERENCE).with_effects(effect), (), max_iterations=0)
    assert 0.9 < noisy.nrmse_of_noise < 1.0
    assert final.ratio < NOISE_REACHED
    assert is_silenced(noisy, final) == (verdict == "unexplained")
    session = Listener(fitting=noisy)
    assert verdict_of(session, replace(final, chi2=9.0 * final.chi2), final) == verdict
    assert ("next to nothing moves" in session.decisions[-1]) == (verdict == "unexplained")
