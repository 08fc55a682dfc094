"""A kind of the library that stands for a law beyond it is told from one that is right."""

import re
from dataclasses import dataclass, replace
from math import exp, tanh
from typing import ClassVar

import pytest
from trial_records import REFERENCE, beam_session, evaluator_of, found_with, measured, multisine, oscillator

from identification.beyond import (
    LEAST_WHERE_MISSED,
    _in_place_of_two,
    is_beyond_library,
    is_beyond_where_missed,
    law_beyond,
    promised,
    with_what_is_seen_along,
    with_what_meets_the_noise,
)
from identification.evidence import LEAST_EVIDENCE, Ranked, misfit_of, with_evidence
from identification.fit import fit
from identification.hypothesis import EffectUnknown, Hypothesis, effect_unknowns, rig_unknowns
from identification.kept_aside import KeptAside, kept_aside
from identification.reached import NOISE_REACHED
from identification.scene import scenes
from identification.session import Session
from identification.unseen import Unseen
from models.effects import EFFECTS, Place
from models.effects.absorber import Absorber
from models.effects.bouc_wen import BoucWen
from models.effects.coulomb_friction import CoulombFriction
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass
from models.effects.point_stiffness import PointStiffness
from models.effects.protocol import parameter
from models.effects.squeeze_film import SqueezeFilm
from models.general_laws import (
    GENERAL_LAWS,
    DampingCurve,
    DirectedSpeedCurve,
    FrictionCurve,
    Lag,
    Memory,
    SpeedCurve,
    SpringCurve,
)
from models.single_law import SingleLaw

THERE = Place(position=0.86)
RELAXING = Memory(THERE, stiffness=3e3, relaxation_time=8e-3)
WEAK = replace(RELAXING, stiffness=450.0)
FRICTION = CoulombFriction(THERE, friction_force=0.4, slip_velocity=5e-3)
HYSTERESIS = BoucWen(THERE, force=1.0, yield_displacement=2e-4, exponent=1.0)
ABSORBER = Absorber(THERE, mass=0.05, frequency=30.0, damping_ratio=0.1)
DASHPOT = PointDamping(THERE, damping=5.0)
SPRING = PointStiffness(THERE, stiffness=1e3)


def asked(*hidden, named):
    session = beam_session(*hidden)
    return session, law_beyond(session, found_with(session), found_with(session, *named))


STUDY = pytest.mark.study


@pytest.mark.parametrize("named", [HYSTERESIS, pytest.param(ABSORBER, marks=STUDY)])
def test_a_force_that_remembers_is_none_of_the_library(named):
    _, found = asked(RELAXING, named=[named])

    assert found.by >= LEAST_EVIDENCE
    assert [effect.kind for effect in found.replaced] == ["absorber"]  # the nearest there, whatever was named
    assert found.row.effect.kind == "force with a memory"
    assert found.row.effect.relaxation_time == pytest.approx(8e-3, rel=0.05)
    assert found.row.effect.place.position == pytest.approx(0.86, abs=0.01)


@pytest.mark.parametrize(
    "true",
    [
        FRICTION,
        HYSTERESIS,
        *(pytest.param(each, marks=STUDY) for each in (ABSORBER, DASHPOT, PointMass(THERE, mass=0.1))),
    ],
)
def test_what_is_right_explains_what_more_general_laws_would(true):
    _, found = asked(true, named=[true])
    assert found is None


def test_two_effects_that_meet_one_law_together_are_held_against_it():
    session = beam_session(RELAXING)
    pair = found_with(session, HYSTERESIS, PointDamping(Place(position=1.2), damping=1.0))

    assert is_beyond_library(session, law_beyond(session, found_with(session), pair))

    assert session.is_beyond
    (told,) = session.decisions
    assert told.startswith("unexplained after all: bouc_wen at 0.8")
    assert "force with a memory at 0.86" in told


@pytest.fixture(scope="module")
def nearly():
    """A weak force that remembers, for which a hysteresis stands: the session, that model, and the law ahead of it."""
    session = beam_session(WEAK)
    named = found_with(session, HYSTERESIS)
    return session, named, law_beyond(session, found_with(session), named)


@pytest.mark.parametrize("is_lost", [False, True])
def test_what_is_nearly_beyond_is_so_where_it_does_better_on_a_record_kept_aside_that_is_missed(nearly, is_lost):
    session, named, law = nearly
    session.decisions.clear()
    session.is_beyond = False
    loud = kept_record(WEAK, name="hold")
    kept = kept_aside(session, Hypothesis(REFERENCE), named.hypothesis, [loud])
    assert list(kept.missed) == ["hold"]
    assert LEAST_WHERE_MISSED < law.by < LEAST_EVIDENCE
    assert not is_beyond_library(session, law)

    assert is_beyond_where_missed(session, named, law, replace(kept, followed=None) if is_lost else kept, [loud])

    assert session.is_beyond
    told = session.decisions[-1]
    assert "absorber at 0.8" in told
    does = "as that law does" if is_lost else "where that law takes away 9"
    assert f"nor does what was learnt hold on hold, {does}" in told


def test_what_is_nearly_beyond_is_not_where_the_record_is_met_or_no_better_by_that_law(nearly):
    session, named, law = nearly
    session.is_beyond = False
    another = kept_record(WEAK, replace(FRICTION, friction_force=2.0), name="hold")
    kept = kept_aside(session, Hypothesis(REFERENCE), named.hypothesis, [another])
    assert list(kept.missed) == ["hold"]
    assert not is_beyond_where_missed(session, named, law, kept, [another])
    assert not is_beyond_where_missed(session, named, law, replace(kept, followed=None), [another])
    assert not is_beyond_where_missed(session, named, law, replace(kept, explained=True), [another])
    assert not is_beyond_where_missed(session, named, law, KeptAside(), [another])
    assert not session.is_beyond


def kept_record(*hidden, name):
    """Louder than what was learnt from."""
    return measured(Hypothesis(REFERENCE, effects=hidden), multisine(8192, rms=6.0, seed=7), seed=8, name=name)[0]


def test_what_a_record_kept_aside_misses_alone_is_not_beyond():
    session = beam_session()
    missed = KeptAside(missed={"hold": "it does not hold there"})
    assert not is_beyond_where_missed(session, found_with(session), None, missed, [])


def round_of(session, *named):
    """The ranking of a round in which these were refitted, each by itself, the best first."""
    return with_evidence([Ranked.of(found_with(session, each)) for each in named])


def test_a_law_that_meets_the_noise_where_the_library_does_not_ends_the_search():
    session = beam_session(Lag.with_values(scene_there(), (0.05, 0.0, -0.1), 3e-3))
    ranked = round_of(session, SPRING)
    assert ranked[0].fit.ratio > NOISE_REACHED

    assert with_what_meets_the_noise(session, found_with(session), ranked) == ranked

    assert session.is_beyond
    (told,) = session.decisions
    assert told.startswith("unexplained after all: point_stiffness at 0.6")  # where it imitates most
    assert "linear force that lags at 0.86" in told


@dataclass(frozen=True)
class FallingFriction(SingleLaw):
    """Friction that falls with the speed, and turns about rest more sharply than a curve between knots can."""

    kind: ClassVar[str] = "falling friction"

    force: float = parameter("F", "N", lower=0.0)
    speed: float = parameter("v_1", "m/s", lower=0.0)

    @staticmethod
    def law(t, q, v, z, p):
        """N, with p = (force, speed)."""
        return -p[0] * (0.1 + 0.9 * exp(-((v / p[1]) ** 2))) * tanh(30.0 * v / p[1])


def test_a_law_far_from_where_the_library_imitates_it_ends_the_search_above_the_noise():
    session = beam_session(FallingFriction(THERE, force=1.0, speed=0.02), rms=4.0)
    ranked = round_of(session, replace(DASHPOT, place=Place(position=0.4)))

    assert with_what_is_seen_along(session, found_with(session), ranked) == ranked

    assert session.is_beyond
    (told,) = session.decisions
    law, left = re.search(r"nearest, but (.*) at 0\.86\d m leaves ([\d.]+) times the noise", told).groups()
    assert law == "resistance over speed"
    assert float(left) > NOISE_REACHED


def test_a_kind_that_stood_at_another_place_is_found_where_a_general_law_is_seen():
    session = beam_session(FRICTION)
    stuck = Hypothesis(REFERENCE, effects=(replace(FRICTION, place=Place(position=0.3)),))
    unknowns = (*rig_unknowns(REFERENCE), *effect_unknowns(stuck, places=False))
    ranked = [Ranked.of(fit(session.fitting, stuck, unknowns, precise=True))]

    first, *_ = with_what_is_seen_along(session, found_with(session), ranked)

    assert not session.is_beyond
    assert first.effect.kind == "coulomb_friction"
    assert first.effect.place.position == pytest.approx(0.86, abs=0.01)


def test_a_friction_and_a_dashpot_at_one_support_are_not_one_law():
    session = beam_session(FRICTION, DASHPOT, rms=4.0)
    ranked = round_of(session, replace(SPRING, place=Place(position=0.4)))

    with_what_is_seen_along(session, found_with(session), ranked)

    assert not session.is_beyond


def test_no_law_is_looked_for_along_an_oscillator():
    rig = oscillator("displacement")
    hidden = FallingFriction(Place(), force=5.0, speed=0.02)
    evaluator = evaluator_of(measured(Hypothesis(rig, effects=(hidden,)), multisine(2048)), rig=rig)
    session = Session(evaluator, evaluator, [], EFFECTS, lambda _: None, 0)
    base, stiffer = Hypothesis(rig), Hypothesis(rig, effects=(PointDamping(Place(), damping=1.0),))
    ranked = [Ranked.of(fit(evaluator, stiffer, effect_unknowns(stiffer)))]
    assert ranked[0].fit.ratio > NOISE_REACHED

    assert with_what_is_seen_along(session, fit(evaluator, base, ()), ranked) is ranked


def test_a_law_that_is_an_event_in_what_was_fitted_does_not_end_the_search(monkeypatch):
    session = beam_session(Lag.with_values(scene_there(), (0.05, 0.0, -0.1), 3e-3))
    ranked = round_of(session, SPRING)
    monkeypatch.setattr("identification.acceptance.left_unseen", lambda *_: Unseen(1.0, 1.0, 1.0))

    rows = with_what_meets_the_noise(session, found_with(session), ranked)

    assert {row.effect.kind for row in rows} <= EFFECTS.keys()
    assert not session.is_beyond
    assert not session.is_passing
    assert not session.decisions


def test_a_law_beside_which_a_small_second_effect_may_be_left_does_not_end_the_search():
    session = beam_session(
        Lag.with_values(scene_there(), (0.02, 0.0, -0.04), 3e-3), PointMass(Place(position=1.3), mass=0.002)
    )
    ranked = round_of(session, SPRING)

    first, *_ = with_what_meets_the_noise(session, found_with(session), ranked)

    assert first.fit.cost < ranked[0].fit.cost  # what comes nearest in the law's place is kept
    assert first.effect.kind in EFFECTS
    assert not session.is_beyond
    assert not session.decisions


def test_a_kind_that_was_lost_is_found_where_a_general_law_meets_the_noise():
    session = beam_session(replace(FRICTION, friction_force=0.05))
    ranked = round_of(session, DASHPOT)
    assert ranked[0].fit.ratio > NOISE_REACHED

    first, *others = with_what_meets_the_noise(session, found_with(session), ranked)

    assert not session.is_beyond
    assert first.effect.kind == "coulomb_friction"
    assert first.effect.friction_force == pytest.approx(0.05, rel=0.05)
    assert not {row.effect.kind for row in others} & set(GENERAL_LAWS)
    assert len({(row.effect.kind, row.effect.place) for row in (first, *others)}) == 1 + len(others)


def test_a_law_is_looked_for_along_the_beam_where_the_best_of_a_round_acts_at_one_place_only():
    session = beam_session(Lag.with_values(scene_there(), (0.05, 0.0, -0.1), 3e-3))
    sleeve = REFERENCE.sleeves[1]
    there = Place(sleeve=sleeve.name, position=sleeve.position)
    ranked = [*round_of(session, SqueezeFilm(there, damping=2.0)), *round_of(session, SPRING)]
    assert ranked[0].fit.ratio > NOISE_REACHED

    assert with_what_is_seen_along(session, found_with(session), ranked) is ranked

    assert session.is_beyond
    assert "linear force that lags at 0.86" in session.decisions[0]


def test_a_round_that_reaches_the_noise_is_left_as_it_is():
    session = beam_session(FRICTION)
    ranked = round_of(session, FRICTION)
    assert with_what_meets_the_noise(session, found_with(session), ranked) is ranked
    assert with_what_is_seen_along(session, found_with(session), ranked) is ranked


def test_a_law_that_is_right_alone_takes_the_place_of_two_with_more_numbers():
    session = beam_session(RELAXING)
    calibrated, law = found_with(session), found_with(session, RELAXING)
    nearly = replace(law, chi2=law.chi2 + 8.0 * misfit_of(law))  # four numbers' worth of odds are asked for
    pair = replace(nearly, hypothesis=replace(law.hypothesis, effects=(HYSTERESIS, DASHPOT)))
    less = found_with(session, HYSTERESIS)

    row, by = _in_place_of_two(session, calibrated, pair, less, 0, 1)

    assert by >= LEAST_EVIDENCE
    assert row.effect.kind == "force with a memory"
    few = replace(nearly, hypothesis=replace(law.hypothesis, effects=(SPRING, DASHPOT)))
    assert _in_place_of_two(session, calibrated, few, found_with(session, SPRING), 0, 1) is None


@pytest.mark.study
def test_two_effects_that_are_there_are_two():
    mass = PointMass(Place(position=1.2), mass=0.1)
    _, found = asked(FRICTION, mass, named=[FRICTION, mass])
    assert found is None


def scene_there():
    return scenes(beam_session().fitting, Hypothesis(REFERENCE), [THERE])[THERE]


def test_a_linear_step_promises_what_is_there():
    session = beam_session(SpringCurve.with_values(scene_there(), (0.0, 0.1, 1.0, 0.0, 0.0, 0.0)))
    odds = promised(session.fitting, found_with(session, PointMass(THERE, mass=0.01)), THERE)
    assert max(odds, key=odds.__getitem__) == "force over displacement"


@pytest.mark.parametrize(
    ("kind", "values", "named"),
    [
        pytest.param(SpeedCurve, (0.4, 0.6, 0.3, 0.05, 0.0), FRICTION, marks=STUDY),
        (DirectedSpeedCurve, (8.0, 8.0, 8.0, 8.0, 0.0, 0.0, 0.0, 0.0), FRICTION),
        pytest.param(DampingCurve, (1.0, 0.2, 0.0, 0.2, 1.0), DASHPOT, marks=STUDY),
        pytest.param(FrictionCurve, (0.0, 0.0, 0.05, 0.5, 0.15), FRICTION, marks=STUDY),
    ],
)
def test_a_law_over_speed_or_displacement_is_none_of_the_library(kind, values, named):
    hidden = kind.with_values(scene_there(), [0.01 * value for value in values])
    _, found = asked(hidden, named=[named])
    assert found.row.effect.kind == kind.kind


def test_a_spring_that_answers_late_is_none_of_the_library():
    """By 6 ms: a spring and, at low frequencies, a dashpot that drives."""
    hidden = Lag.with_values(scene_there(), (0.01, 0.0, -0.02), 3e-3)
    _, found = asked(hidden, named=[SPRING])
    assert found.row.effect.kind == "linear force that lags"
    law = found.row.fit
    ((index, time),) = (
        (i, u) for i, u in enumerate(law.unknowns) if isinstance(u, EffectUnknown) and u.about.symbol == "tau"
    )
    true = time.get(Hypothesis(REFERENCE, effects=(hidden,)))
    assert time.get(law.hypothesis) == pytest.approx(true, abs=3.0 * law.std()[index])  # one of them is 13 % of 3 ms
    assert law.ratio <= NOISE_REACHED


def test_what_a_kind_of_the_library_does_that_was_lost_is_not_beyond_it():
    """The film in the sleeve is right, and a friction there was named."""
    sleeve = REFERENCE.sleeves[1]
    film = SqueezeFilm(Place(sleeve=sleeve.name, position=sleeve.position), damping=2.0)
    named = PointDamping(Place(position=sleeve.position), damping=2.0)
    _, found = asked(film, named=[named])
    assert found is None


def test_where_there_is_no_time_nothing_is_asked():
    session = beam_session(RELAXING)
    session.until = 0.0
    assert law_beyond(session, found_with(session), found_with(session, HYSTERESIS)) is None
    assert "a look at laws beyond the library was not begun" in session.untried[0]
