"""The judgement: few of each kind are refitted, and what the beginning rules out is not."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from trial_records import REFERENCE, evaluator_of, fit_of, let_go, measured, multisine

from identification import in_its_place
from identification import judge as judging
from identification.evidence import Ranked, log_occam
from identification.fit import fit
from identification.hypothesis import Hypothesis, effect_unknowns
from identification.in_its_place import RULED_OUT
from identification.judge import FINALISTS, LEAST_REFITS, LEFT_BEHIND, _best, finals, judge, restarted
from identification.look import View
from identification.prepare import start_unknowns
from identification.sketch import FAR_BEHIND, Sketch
from models.effects import Place
from models.effects.coulomb_friction import CoulombFriction
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.point_stiffness import PointStiffness
from models.effects.sensor_gain import SensorGain
from models.effects.wear import Wear
from models.simulate import Settings

HERE = Place(position=0.7)
SLEEVES = ("sleeve 1", 0.45), ("sleeve 2", 1.0)
MASS = PointMass(HERE, mass=0.3)
BASE = fit_of(MASS, 1000.0)


FAR = fit_of(MASS, 40_000.0)


def sketch(effect, share, base=BASE):
    return Sketch(base, fit_of(effect, base.chi2 * (1.0 - share)), effect)


def kinds(sketches):
    return [s.fit.hypothesis.effects[-1].kind for s in sketches]


def test_the_share_of_a_sketch_is_what_it_takes_away_less_its_occam_factor():
    assert sketch(MASS, 0.3).share == pytest.approx(0.3 + 2.0 * log_occam(fit_of(MASS, 700.0)) / 1000.0)


def test_the_best_sketches_are_few_of_each_kind():
    rows = [sketch(PointMass(Place(position=x), mass=0.1), 0.9 - x / 10) for x in (0.2, 0.6, 1.0)]
    rows += [sketch(PointDamping(HERE, damping=1.0), 0.8)]

    assert kinds(_best(rows, 4)) == ["point_mass", "point_mass", "point_damping"]
    assert len(_best(rows, 1)) == 1


def test_two_sketches_that_ended_at_one_place_are_one():
    rows = [sketch(PointMass(Place(position=x), mass=0.1), 0.9) for x in (0.7, 0.71)]
    rows.append(sketch(PointMass(Place(position=0.9), mass=0.1), 0.6))

    assert [s.fit.hypothesis.effects[-1].place.position for s in _best(rows, 4)] == [0.7, 0.9]


def test_a_sleeve_and_its_position_are_one_place():
    at_sleeve = CoulombFriction(Place(sleeve="sleeve 2", position=1.0), 1.0, 1e-3)
    beside = CoulombFriction(Place(position=1.01), 1.0, 1e-3)
    elsewhere = CoulombFriction(Place(sleeve="sleeve 1", position=0.45), 1.0, 1e-3)

    rows = [sketch(beside, 0.9), sketch(at_sleeve, 0.8), sketch(elsewhere, 0.7)]

    assert [s.effect for s in _best(rows, 4)] == [beside, elsewhere]


def test_those_far_behind_are_left_out_when_there_are_enough_and_those_that_worsen_always():
    close = [MASS, PointDamping(HERE, damping=1.0), PointStiffness(HERE, stiffness=1.0)]
    far = SensorGain(Place(sensor="P3"), gain=0.5)
    rows = [sketch(effect, 0.9) for effect in close] + [sketch(far, 0.9 * FAR_BEHIND - 0.05)]

    assert len(close) == LEAST_REFITS
    assert "sensor_gain" not in kinds(_best(rows, 9))
    assert "sensor_gain" in kinds(_best(rows[1:], 9))
    assert _best([sketch(MASS, -0.1)], 9) == []


@pytest.fixture
def refits(monkeypatch):
    """Refits that leave a residual over noise by the effect's kind, and the kinds that were refitted."""
    ratios, asked = {}, []

    def refit(evaluator, base, found):
        effect = found.effects[-1]
        asked.append(effect.kind)
        return fit_of(effect, 1000.0 * ratios[effect.kind] ** 2)

    def against(leader, base, found):
        ratio = ratios[found.effects[-1].kind]
        return fit_of(found.effects[-1], 1000.0 * ratio**2), ratio / leader.fit.ratio

    monkeypatch.setattr(in_its_place, "refit", refit)
    for module in (judging, in_its_place):
        monkeypatch.setattr(module, "against", against)
    return ratios, asked


def refitted(sketches, base=BASE, **known):
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE), multisine(512)))
    return finals(sketches, evaluator, base, {}, lambda _: None, **known)


@pytest.mark.parametrize("left", [1.0, 1.3])
def test_when_the_first_or_its_sketch_reaches_the_noise_those_far_off_are_not_refitted(refits, left):
    ratios, asked = refits
    ratios.update(point_mass=left, point_damping=3.0)
    first, last = sketch(MASS, 0.9), sketch(PointDamping(HERE, damping=1.0), 1.0 - 0.1 * 1.1 * RULED_OUT**2)

    rows = refitted([first, last])

    assert asked == ["point_mass"]
    assert [(r.effect.kind, r.refitted) for r in rows] == [("point_mass", True), ("point_damping", False)]
    assert rows[1].log_evidence < rows[0].log_evidence


def test_what_is_plainly_above_the_noise_beside_the_one_that_reaches_it_is_not_fitted_further(refits):
    ratios, asked = refits
    ratios.update(point_mass=1.5, point_damping=1.0, point_stiffness=1.1 * RULED_OUT, sensor_gain=0.9 * RULED_OUT)
    effects = [
        MASS,
        PointDamping(HERE, damping=1.0),
        PointStiffness(HERE, stiffness=1.0),
        SensorGain(Place(sensor="P3"), gain=0.5),
    ]

    rows = refitted([sketch(effect, 0.9) for effect in effects])

    assert asked == ["point_mass", "point_damping", "sensor_gain"]
    assert [(r.effect.kind, r.refitted) for r in rows] == [
        ("point_damping", True),
        ("sensor_gain", True),
        ("point_mass", True),
        ("point_stiffness", False),
    ]


def test_kinds_in_time_which_are_sketched_on_other_records_take_no_others_place(refits):
    ratios, asked = refits
    instant = [
        MASS,
        PointDamping(HERE, damping=1.0),
        PointStiffness(HERE, stiffness=1.0),
        SensorGain(Place(sensor="P3"), gain=0.5),
    ]
    lasting = [Wear(Place(sleeve=name, position=x), rate=1e-6) for name, x in SLEEVES]
    ratios.update(dict.fromkeys([effect.kind for effect in (*instant, *lasting)], 2.0))
    assert len(instant) == FINALISTS

    refitted([*(sketch(effect, 0.9) for effect in lasting), *(sketch(effect, 0.6) for effect in instant)])

    assert asked == ["wear", "wear", "point_mass", "point_damping", "point_stiffness", "sensor_gain"]


def test_shares_of_other_records_are_not_held_against_each_other(refits):
    ratios, asked = refits
    ratios.update(point_mass=1.0, wear=1.0)
    lasting = replace(sketch(Wear(Place(sleeve="sleeve 1", position=0.45), rate=1e-6), 0.2), base=fit_of(MASS, 200.0))
    first = sketch(MASS, 0.9)
    assert lasting.share < LEFT_BEHIND * first.share
    near = replace(lasting, fit=replace(lasting.fit, chi2=first.fit.chi2))

    refitted([first, near])

    assert asked == ["point_mass", "wear"]


def test_while_none_reaches_the_noise_all_that_take_much_are_refitted(refits):
    ratios, asked = refits
    ratios.update(point_mass=2.0, point_damping=1.5)

    rows = refitted([sketch(MASS, 0.9, FAR), sketch(PointDamping(HERE, damping=1.0), 0.4, FAR)], FAR)

    assert asked == ["point_mass", "point_damping"]
    assert [r.effect.kind for r in rows] == ["point_damping", "point_mass"]


LITTLE = sketch(PointDamping(HERE, damping=1.0), 0.2, FAR)
LESS = sketch(PointDamping(HERE, damping=1.0), 0.02, FAR)
MUCH = sketch(MASS, 0.9, FAR)


@pytest.mark.parametrize(("behind", "left", "others"), [(LITTLE, 2.0, []), (LESS, 6.0, ["point_damping"])])
def test_what_takes_next_to_nothing_beside_what_a_refit_takes_is_not_refitted(refits, behind, left, others):
    """And where the refit of the best one itself takes little, sketches say little."""
    ratios, asked = refits
    ratios.update(point_mass=left, point_damping=1.5)

    rows = refitted([MUCH, behind], FAR)

    assert asked == ["point_mass", *others]
    kept = {row.effect.kind: row.refitted for row in rows}
    assert kept == {"point_mass": True, "point_damping": bool(others)}  # it stays in the ranking, behind


def test_it_may_be_refitted_from_elsewhere(refits):
    """Where a later look finds it to take much."""
    ratios, asked = refits
    ratios.update(point_mass=2.0, point_damping=1.5)
    known = refitted([MUCH, LITTLE], FAR)
    asked.clear()

    rows = refitted([sketch(LITTLE.effect, 0.9, FAR)], FAR, known=known)

    assert asked == ["point_damping"]
    assert [(row.effect.kind, row.refitted) for row in rows] == [("point_damping", True)]


def test_the_best_of_each_family_is_refitted_in_each_look(refits):
    ratios, asked = refits
    ratios.update(point_damping=1.5, wear=1.5)
    first = Ranked.of(fit_of(MASS, 4000.0))
    worn = [sketch(Wear(Place(sleeve=name, position=x), rate=1e-6), 0.1, FAR) for name, x in SLEEVES]

    rows = refitted([LITTLE, LESS, *worn], FAR, known=[first])

    assert asked == ["point_damping", "wear"]
    assert [row.refitted for row in rows] == [True, True, False]
    assert all(row.log_evidence < first.log_evidence for row in rows if not row.refitted)


def test_a_part_on_which_little_is_missing_rules_nothing_out(refits):
    ratios, asked = refits
    ratios.update(point_mass=2.0, point_damping=1.5)
    quiet = fit_of(MASS, 1000.0 * 1.2**2)

    refitted([sketch(MASS, 0.9, FAR), sketch(PointDamping(HERE, damping=1.0), 0.01 + LITTLE.share / 9.0, quiet)], FAR)

    assert asked == ["point_mass", "point_damping"]


def test_what_is_refitted_already_is_not_thrown_away(refits):
    ratios, asked = refits
    ratios.update(point_mass=2.0)

    rows = refitted([MUCH, LITTLE], FAR, refits={LITTLE: fit_of(LITTLE.effect, 1200.0)})

    assert asked == ["point_mass"]
    assert [(row.effect.kind, row.refitted) for row in rows] == [("point_damping", True), ("point_mass", True)]


def test_those_that_fit_nearly_alike_are_fitted_to_the_end(refits, monkeypatch):
    ratios, _ = refits
    ratios.update(point_mass=1.0, point_damping=1.0004, point_stiffness=1.2)
    asked = []

    def to_the_end(evaluator, hypothesis, unknowns, *, tolerance, precise, like):
        asked.append((hypothesis.effects[-1].kind, tolerance))
        return fit_of(hypothesis.effects[-1], 990.0 if hypothesis.effects[-1].kind == "point_damping" else 1000.0)

    monkeypatch.setattr(in_its_place, "fit", to_the_end)
    others = PointDamping(HERE, damping=1.0), PointStiffness(HERE, stiffness=1.0)

    rows = refitted([sketch(MASS, 0.9), *(sketch(effect, 0.89) for effect in others)])

    assert asked == [("point_mass", 0.0), ("point_damping", 0.0)]
    assert [row.effect.kind for row in rows] == ["point_damping", "point_mass", "point_stiffness"]


@pytest.mark.parametrize(
    ("left", "is_late", "refitted", "looked_at"),
    [
        (1.05, False, 1.0, [False]),
        (1.5, False, 1.0, [False]),
        (1.5, False, 1.2, [False, True]),
        (2.0, False, 1.0, [False, True]),
        (1.05, True, 1.0, [False, True]),
        (1.05, False, 1.5, [False, True]),
    ],
)
def test_kinds_in_time_are_looked_at_where_no_other_reaches_the_noise(monkeypatch, left, is_late, refitted, looked_at):
    """Where the view begins late, what reaches the noise there may be a drift that has come so far.

    And what reaches it in the view may not in all that is fitted.
    """
    asked, far = [], fit_of(MASS, 4000.0)

    def beside(view, base, progress):
        asked.append(view.is_lasting)
        return [Sketch(far, fit_of(MASS, 1000.0 * left**2), MASS)]

    def settled(sketches, fitting, base, registry, progress, known, refits):
        return [] if known else [Ranked(MASS, fit_of(MASS, 1000.0 * refitted**2), refitted=True, log_evidence=0.0)]

    monkeypatch.setattr(judging, "beside", beside)
    monkeypatch.setattr(judging, "refit_sketched", lambda *_: fit_of(MASS, 1000.0 * refitted**2))
    monkeypatch.setattr(judging, "finals", settled)
    views = [View(None, far, {"point_mass": PointMass}, is_late=is_late), View(None, far, {"wear": Wear})]

    judge(views, SimpleNamespace(targets=(), strays=0.0, extent=""), far, lambda _: None)

    assert asked == looked_at


@pytest.mark.parametrize("left", [1.0, 1.06, 1.3])
def test_the_best_is_refitted_once_whatever_that_shows(refits, monkeypatch, left):
    """A residual of 1.06 is no reason to pass over kinds in time: beside it another effect would be looked for."""
    ratios, asked = refits
    ratios.update(point_mass=left, wear=left)
    far, worn = fit_of(MASS, 4000.0), Wear(Place(sleeve="sleeve 1", position=0.45), rate=1e-6)
    begun = {False: Sketch(far, fit_of(MASS, 2000.0), MASS), True: Sketch(far, fit_of(worn, 1800.0), worn)}
    looked = []

    def beside(view, base, progress):
        looked.append(view.is_lasting)
        return [begun[view.is_lasting]]

    monkeypatch.setattr(judging, "beside", beside)
    monkeypatch.setattr(judging, "looks_from", lambda _: [beside])
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE), multisine(512)))

    judge([View(None, far, {}), View(None, far, {"wear": Wear})], evaluator, far, lambda _: None)

    assert looked == ([False] if left == 1.0 else [False, True])
    assert asked.count("point_mass") == 1


@pytest.mark.parametrize(("is_unbent", "order"), [(False, ["afar", "beside"]), (True, ["beside", "afar"])])
def test_a_model_that_a_fault_has_not_bent_is_looked_beside_first(monkeypatch, is_unbent, order):
    asked, far = [], fit_of(MASS, 1e6)

    def look(name):
        return lambda *_: (asked.append(name), [Sketch(far, far, MASS)])[1]

    monkeypatch.setattr(judging, "beside", look("beside"))
    monkeypatch.setattr(judging, "afar", look("afar"))
    monkeypatch.setattr(judging, "finals", lambda *_, **__: [])

    judge([View(None, far, {}, is_unbent=is_unbent)], SimpleNamespace(targets=()), far, lambda _: None)

    assert asked == order


def test_begun_again_from_the_given_numbers_a_lost_start_is_found():
    """A beam let go from a hard sleeve: a fit of all its record at once, from rest, does not find its state."""
    load = PointMass(Place(position=1.2), mass=0.3)
    evaluator = evaluator_of(let_go(REFERENCE, -60.0, load), settings=Settings(steps_per_sample=8))
    starts = start_unknowns(Hypothesis(REFERENCE), [target.record for target in evaluator.timed])
    base = fit(evaluator, Hypothesis(REFERENCE), starts)
    stuck = Hypothesis(REFERENCE).with_effects(load.scaled(0.7))
    found = fit(evaluator, stuck, (*starts, *effect_unknowns(stuck, places=False)))

    again = restarted(evaluator, base, found)

    assert found.ratio > 3.0
    assert again.ratio < 1.1
    assert again.hypothesis.effects[-1].mass == pytest.approx(0.3, rel=1e-2)
