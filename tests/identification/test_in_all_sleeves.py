"""One cause in all sleeves: it acts as its members do, moves all their numbers, and falls apart into them."""

from dataclasses import replace

import numpy as np
import pytest

from identification.diagnose import diagnose
from identification.fit import fit
from identification.hypothesis import Hypothesis, effect_unknowns, rig_unknowns
from identification.in_all_sleeves import InAllSleeves, fallen_apart, in_all_sleeves
from identification.screen import promising, survey
from models.effects import EFFECTS, Place
from models.effects.squeeze_film import SqueezeFilm
from models.record import Record
from models.simulate import Settings
from tests.identification.trial_records import FS, REFERENCE, evaluator_of, measured, moved, multisine

SLEEVES = tuple(Place(sleeve=sleeve.name, position=sleeve.position) for sleeve in REFERENCE.sleeves)
FILMS = tuple(SqueezeFilm(place, damping=damping) for place, damping in zip(SLEEVES, (0.8, 1.7), strict=True))
ALIKE = in_all_sleeves(EFFECTS, REFERENCE)
FILM = ALIKE["squeeze_film in all sleeves"](SLEEVES[0], members=FILMS)


def channels_with(*effects):
    force, names = multisine(4096), tuple(sensor.name for sensor in REFERENCE.sensors)
    silent = Record("any", FS, force, names, np.zeros((len(names), len(force))))
    return Hypothesis(REFERENCE, effects=effects).simulated(silent, Settings()).channels


def test_every_kind_that_sits_in_a_sleeve_is_there_and_no_other():
    kinds = {cls.part_kind() for cls in ALIKE.values()}
    assert kinds == {name for name, cls in EFFECTS.items() if "sleeve" in cls.places}
    assert all(issubclass(cls, InAllSleeves) for cls in ALIKE.values())


def test_one_sleeve_alone_has_nothing_in_common():
    assert in_all_sleeves(EFFECTS, REFERENCE.model_copy(update={"sleeves": REFERENCE.sleeves[:1]})) == {}


def test_it_acts_as_its_members_do():
    np.testing.assert_array_equal(channels_with(FILM), channels_with(*FILMS))


def test_its_numbers_are_the_members_one_after_the_other():
    np.testing.assert_array_equal(FILM.fitted_values(), [0.8, 1.7])
    assert FILM.with_fitted(np.array([0.3, 0.4])).parts() == tuple(
        replace(film, damping=damping) for film, damping in zip(FILMS, (0.3, 0.4), strict=True)
    )
    np.testing.assert_allclose(FILM.scaled(3.0).fitted_values(), [2.4, 5.1])
    assert len(FILM.fitted_parameters()) == 2


def test_a_fit_without_such_an_effect_is_left_as_it_is():
    spring = EFFECTS["point_stiffness"](Place(position=0.5), stiffness=100.0)
    truth = Hypothesis(REFERENCE, effects=(spring,))
    found = fit(evaluator_of(measured(truth, multisine(512))), truth, effect_unknowns(truth), max_iterations=0)
    assert fallen_apart(found, [["of the spring"]])[0] is found


def test_where_one_sleeve_has_it_already_it_is_not_tried_in_all():
    base = Hypothesis(REFERENCE, effects=FILMS[1:])
    evaluator = evaluator_of(measured(base, multisine(512)))
    start = fit(evaluator, base, rig_unknowns(REFERENCE), max_iterations=0)
    kinds = {name: ALIKE[name] for name in ("squeeze_film in all sleeves", "clearance in all sleeves")}
    assert {suspect.effect.kind for suspect in survey(evaluator, start, kinds, lambda _: None)} == {
        "clearance in all sleeves"
    }


def test_each_sleeve_pays_for_its_number():
    assert [film.n_numbers for film in (*FILMS, FILM)] == [1, 1, 2]
    assert EFFECTS["time_varying_damping"](SLEEVES[0], times=(0.0, 1.0), values=(5.0, 7.0)).n_numbers == 1


def test_from_whichever_sleeve_it_is_begun_it_is_one_suspect():
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE, effects=FILMS), multisine(1024)))
    start = fit(evaluator, Hypothesis(REFERENCE), rig_unknowns(REFERENCE), max_iterations=0)
    kinds = {name: kind for name, kind in ALIKE.items() if kind.part_kind() == "squeeze_film"}
    seen = promising(survey(evaluator, start, kinds, lambda _: None), 2)
    assert [(suspect.effect.kind, suspect.effect.place) for suspect in seen] == [(FILM.kind, SLEEVES[0])]


def test_a_table_is_refined_in_all_sleeves_at_once():
    kind = ALIKE["time_varying_damping in all sleeves"]
    tables = tuple(EFFECTS["time_varying_damping"](place, times=(0.0, 1.0), values=(5.0, 7.0)) for place in SLEEVES)
    finer = kind(SLEEVES[0], members=tables).refined()
    assert [[len(table.times) for table in each.parts()] for each in finer] == [[3, 3], [5, 5]]


def test_a_fit_falls_apart_into_members_that_keep_their_rounds():
    spring = EFFECTS["point_stiffness"](Place(position=0.5), stiffness=100.0)
    truth = Hypothesis(REFERENCE, effects=(spring, FILM))
    evaluator = evaluator_of(measured(truth, multisine(1024)))
    unknowns = (*rig_unknowns(REFERENCE), *effect_unknowns(truth))
    found = fit(evaluator, truth, unknowns, max_iterations=0)
    apart, rounds = fallen_apart(found, [["of the spring"], ["of the film"]])
    assert apart.hypothesis.effects == (spring, *FILMS)
    assert rounds == [["of the spring"], ["of the film"], ["of the film"]]
    assert [u.get(apart.hypothesis) for u in apart.unknowns] == [u.get(truth) for u in unknowns]
    assert [u.set(apart.hypothesis, 0.3).effects[1:] for u in apart.unknowns[-2:]] == [
        u.set(truth, 0.3).effects[1].parts() for u in unknowns[-2:]
    ]
    again = fit(evaluator, apart.hypothesis, apart.unknowns, max_iterations=0)
    np.testing.assert_allclose(again.jacobian, found.jacobian, rtol=1e-6, atol=1e-6 * np.abs(found.jacobian).max())


@pytest.mark.study
def test_grease_in_both_sleeves_is_found_in_both():
    """Told sleeve by sleeve, a dashpot between them looks better than grease in one."""
    built = moved(REFERENCE, 0.5, -0.4, 0.3, 0.5, -0.5, 0.4, -0.6, 0.3, -0.2)
    record, _ = measured(replace(built, effects=FILMS), multisine(16384, rms=6.0), force_noise=0.005)
    kinds = {kind: EFFECTS[kind] for kind in ("squeeze_film", "point_damping", "coulomb_friction")}
    found = diagnose(REFERENCE, [record], registry=kinds, jobs=1, alike=True)
    assert found.verdict == "missing_effect"
    assert [(added.effect.kind, added.effect.place.sleeve) for added in found.added] == [
        ("squeeze_film", place.sleeve) for place in SLEEVES
    ]
    np.testing.assert_allclose([added.effect.damping for added in found.added], [0.8, 1.7], rtol=0.05)
