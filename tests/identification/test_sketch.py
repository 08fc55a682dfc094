"""The heats: a suspect far from its size and place is brought to both, and its rivals are seen from its numbers."""

from dataclasses import replace

import pytest
from trial_records import REFERENCE, evaluator_of, fit_of, measured, moved, multisine

from identification import sketch as sketching
from identification.calibrate import beginning
from identification.fit import fit
from identification.hypothesis import Hypothesis, own_unknowns, rig_unknowns
from identification.sketch import Sketch, apart, ground_of, grown_from_bare, heats, rivals, sketched
from models.effects import EFFECTS, Place
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.squeeze_film import SqueezeFilm

SIGMAS = (0.5, -1.0, 0.3, 0.8, -0.6, 0.4, -0.3, 0.7, -0.5)
GREASE = SqueezeFilm(Place(sleeve="sleeve 2", position=1.0), damping=2.0)
DASHPOT = PointDamping(Place(position=1.0), damping=5.0)
NEAR = ("squeeze_film", "point_damping", "point_mass")
REGISTRY = {kind: EFFECTS[kind] for kind in NEAR}


def sketch(effect, share=0.5):
    return Sketch(fit_of(effect, 1000.0), fit_of(effect, 1000.0 * (1.0 - share)), effect)


@pytest.fixture(scope="module")
def greased():
    """The beginning of two records of a rig with grease in sleeve 2, and the rig as given on them."""
    truth = moved(REFERENCE, *SIGMAS[: len(REFERENCE.parameters())]).with_effects(GREASE)
    pairs = [measured(truth, multisine(1024, rms=rms, seed=seed), name=f"{rms} N") for seed, rms in ((1, 5), (2, 20))]
    evaluator = evaluator_of(*pairs)
    return evaluator, fit(evaluator, Hypothesis(REFERENCE), rig_unknowns(REFERENCE), max_iterations=2)


def test_the_truth_is_fitted_from_half_its_size(greased):
    evaluator, base = greased
    small = GREASE.scaled(0.5)

    (found,) = sketched(ground_of(evaluator, Hypothesis(REFERENCE), base), [Hypothesis(REFERENCE, effects=(small,))])

    assert found.fit.ratio < 0.1 * found.base.ratio
    assert found.effect.damping == pytest.approx(GREASE.damping, rel=0.1)


def test_a_suspect_that_was_lost_on_its_way_is_begun_again_beside_the_numbers_that_fit_without_it(greased):
    evaluator, base = greased
    ground = ground_of(evaluator, Hypothesis(REFERENCE), base)
    far = Hypothesis(REFERENCE, effects=(GREASE.scaled(50.0),))
    unknowns = (*ground.bare.unknowns, *own_unknowns(far))
    lost = Sketch(ground.bare, fit(evaluator, far, unknowns, max_iterations=0), far.effects[-1])
    near = Sketch(ground.bare, replace(ground.bare, chi2=0.5 * ground.bare.chi2), DASHPOT)
    assert lost.fit.ratio > ground.bare.ratio

    again, *others = grown_from_bare(ground, [near, lost])

    assert again.begun == lost.begun
    assert again.fit.ratio < 0.1 * ground.bare.ratio
    assert again.effect.damping == pytest.approx(GREASE.damping, rel=0.1)
    assert others == [near]


def test_the_model_without_a_suspect_is_followed_until_it_hardly_falls(greased):
    """Else suspects that ended farther off than numbers alone can do would not be seen to be lost."""
    evaluator, base = greased
    ground = ground_of(evaluator, Hypothesis(REFERENCE), base)

    further = fit(evaluator, ground.bare.hypothesis, ground.bare.unknowns, max_iterations=30)

    assert further.cost > 0.95 * ground.bare.cost
    assert ground.bare.cost < 0.5 * ground.quick.cost


def test_the_rivals_of_a_dashpot_near_a_sleeve_are_the_films_in_it(greased):
    evaluator, base = greased
    (imitator,) = sketched(
        ground_of(evaluator, Hypothesis(REFERENCE), base), [Hypothesis(REFERENCE, effects=(DASHPOT,))]
    )

    others = rivals(evaluator, base, [imitator], REGISTRY)

    assert abs(imitator.effect.place.position - 1.0) < 0.1
    assert {h.effects[-1].kind for h in others} == {"squeeze_film", "point_mass"}
    film = next(h.effects[-1] for h in others if h.effects[-1].kind == "squeeze_film")
    assert film.place == GREASE.place
    assert film.damping == pytest.approx(GREASE.damping, rel=1.0)


def test_a_sensor_has_no_rivals_and_a_kind_that_fits_alike_is_not_seen_again(greased):
    evaluator, base = greased
    alike = [sketch(DASHPOT), sketch(GREASE, 0.45)]

    assert rivals(evaluator, base, [], REGISTRY) == []
    assert {h.effects[-1].kind for h in rivals(evaluator, base, alike, REGISTRY)} == {"point_mass"}


def test_heats_that_start_with_an_imitator_end_with_the_truth(greased):
    evaluator, base = greased

    first, *others = heats(evaluator, Hypothesis(REFERENCE), base, [DASHPOT], REGISTRY)

    assert first.effect.kind == "squeeze_film"
    assert first.effect.place.sleeve == "sleeve 2"
    assert "point_damping" in {other.effect.kind for other in others}
    assert all(first.share >= other.share for other in others)


def test_what_is_far_off_where_another_has_reached_the_noise_is_not_sketched_on_longer_records(greased, monkeypatch):
    evaluator, base = greased
    ratios = {"squeeze_film": 1.0, "point_damping": 1.9, "point_mass": 2.1}
    asked = []
    bases = iter([1e5, 1e5, 1e4, 1e4])

    def fitted(ground, suspects, **_):
        asked.append([suspect.effects[-1].kind for suspect in suspects])
        ends = [(s.effects[-1], 1000.0 * ratios[s.effects[-1].kind] ** 2) for s in suspects]
        left = next(bases)
        return [Sketch(fit_of(GREASE, left), fit_of(effect, cost), effect) for effect, cost in ends]

    monkeypatch.setattr(sketching, "sketched", fitted)
    monkeypatch.setattr(sketching, "rivals", lambda *_: [])

    suspects = [GREASE, DASHPOT, PointMass(Place(position=1.0), mass=0.1)]
    found = heats(evaluator, Hypothesis(REFERENCE), base, suspects, REGISTRY, [(0.3, 0.2, 8), (1.0, 0.0, 8)])

    assert asked[0] == ["squeeze_film", "point_damping", "point_mass"]
    assert asked[2] == ["squeeze_film", "point_damping"]
    assert [sketch.effect.kind for sketch in found[:2]] == ["squeeze_film", "point_damping"]
    (last,) = found[2:]
    assert last.effect.kind == "point_mass"
    longest = beginning(evaluator, 1.0, 0.0)
    assert last.fit.n_data == last.base.n_data == longest.n_judged


@pytest.mark.parametrize(("near", "which"), [(True, (0, 1)), (False, (0,))])
def test_beside_near_numbers_what_is_lost_is_begun_again_in_every_heat(greased, monkeypatch, near, which):
    """From afar in the first alone: what grew there is no longer lost."""
    evaluator, base = greased
    schedule, begun_again = [(0.3, 0.2, 8), (1.0, 0.0, 8)], []

    def grown(ground, sketches):
        begun_again.append(ground.evaluator.n_data)
        return sketches

    monkeypatch.setattr(
        sketching, "sketched", lambda *_, **__: [Sketch(fit_of(GREASE, 1e5), fit_of(GREASE, 9e4), GREASE)]
    )
    monkeypatch.setattr(sketching, "rivals", lambda *_: [])
    monkeypatch.setattr(sketching, "grown_from_bare", grown)

    heats(evaluator, Hypothesis(REFERENCE), base, [GREASE], REGISTRY, schedule, near=near)

    extents = [beginning(evaluator, *schedule[heat][:2]).n_data for heat in which]
    assert begun_again == extents
    assert len(set(extents)) == len(extents)


def test_two_sketches_that_ended_at_one_place_are_one():
    rows = [sketch(PointMass(Place(position=x), mass=0.1)) for x in (0.7, 0.71, 0.9)]

    assert [row.effect.place.position for row in apart(rows)] == [0.7, 0.9]
    assert (
        apart([sketch(GREASE), sketch(PointDamping(Place(position=1.0), damping=1.0))])[1].effect.kind
        == "point_damping"
    )
