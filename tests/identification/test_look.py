"""Looking for suspects: from numbers that nothing has pulled, where the beginning of the records tells enough."""

from itertools import pairwise

import pytest
from trial_records import REFERENCE, evaluator_of, measured, moved, multisine

from identification.calibrate import beginning, calibrate, put_back, unknowns_of
from identification.fit import fit
from identification.hypothesis import Hypothesis, rig_unknowns, with_own_number
from identification.look import (
    TELLING,
    TELLING_WINDOWS,
    View,
    _ever_longer,
    _telling,
    beside,
    first_of_each_kind,
    worth_a_sketch,
)
from identification.screen import Suspect
from models.effects import EFFECTS, Place
from models.effects.base_motion import BaseMotion
from models.effects.coulomb_friction import CoulombFriction
from models.effects.point_damping import PointDamping
from models.effects.point_mass import PointMass

SILENT = lambda _: None  # noqa: E731
DASHPOT = PointDamping(Place(position=0.95), damping=4.0)


def test_the_best_place_of_every_kind_comes_before_the_second_of_any():
    here, there = (PointMass(Place(position=x), mass=0.1) for x in (0.7, 1.2))
    friction = CoulombFriction(Place(sleeve="sleeve 1", position=0.45), 1.0, 1e-3)
    suspects = [Suspect(here, 9.0), Suspect(there, 8.0), Suspect(friction, 1.0)]

    assert [s.effect for s in first_of_each_kind(suspects)] == [here, friction, there]


def test_what_took_next_to_nothing_of_what_the_best_did_is_not_sketched():
    here, there = (PointMass(Place(position=x), mass=0.1) for x in (0.7, 1.2))
    friction = CoulombFriction(Place(sleeve="sleeve 1", position=0.45), 1.0, 1e-3)
    gains = [(9.0, 0.3, -2.0), (-1.0, -2.0, -3.0), (0.0, -1.0, -1.0)]

    rows = [[Suspect(e, g) for e, g in zip((here, friction, there), row, strict=True)] for row in gains]
    kept = [len(worth_a_sketch(row)) for row in rows]

    assert kept == [2, 3, 3]
    assert worth_a_sketch([]) == []


def test_numbers_at_the_end_of_their_tolerance_are_put_back_and_the_others_stay():
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE), multisine(512)))
    sigmas = (0.5, 3.9, -1.0, 2.0, -3.5, 0.0, 0.0, 0.0, 0.0)[: len(REFERENCE.parameters())]
    pulled = fit(evaluator, moved(REFERENCE, *sigmas), rig_unknowns(REFERENCE), max_iterations=0)

    start = put_back(pulled)

    wanted = [0.0 if abs(sigma) > 3.0 else sigma for sigma in sigmas]
    assert [unknown.get(start) for unknown in pulled.unknowns] == pytest.approx(wanted, abs=1e-9)


def test_the_shortest_beginning_that_shows_more_than_noise_is_surveyed():
    truth = Hypothesis(REFERENCE)
    force = multisine(4096, rms=10.0)
    plain, damped = measured(truth, force), measured(truth.with_effects(DASHPOT), force)
    windows = []
    for record in (plain, damped):
        evaluator = evaluator_of(record)
        there = fit(evaluator, truth, rig_unknowns(REFERENCE), max_iterations=0)
        windows.append(_telling(evaluator, truth, there))

    assert windows[0] is None
    assert windows[1] is not None
    assert windows[1][0] in TELLING_WINDOWS
    assert windows[1][1].n_data == beginning(evaluator, *windows[1][0]).n_data
    fitted = [fit(beginning(evaluator, *each), truth, rig_unknowns(REFERENCE)).ratio for each in TELLING_WINDOWS]
    number = TELLING_WINDOWS.index(windows[1][0])
    assert max(fitted[:number], default=0.0) < TELLING < fitted[number]


def test_the_records_are_lengthened_twofold_at_most():
    evaluator = evaluator_of(measured(Hypothesis(REFERENCE), multisine(8192, rms=10.0)))

    windows = _ever_longer(evaluator, *TELLING_WINDOWS[0])

    counts = [beginning(evaluator, *window).n_data for window in windows]
    assert windows[0] == TELLING_WINDOWS[0]
    assert windows[-1] == (1.0, 0.0)
    assert all(short < long <= 2.2 * short for short, long in pairwise(counts))


def test_a_shaking_floor_is_begun_at_the_line_that_the_whole_records_show():
    """Half a second, in which a mass that is missing too leaves most, does not know it, and fits from others stray."""
    floor, mass = BaseMotion(Place(), 71.34, 0.3), PointMass(Place(position=0.9), 0.3)
    truth = with_own_number(Hypothesis(REFERENCE).with_effects(floor, mass), "test", "base_phase", 0.7)
    evaluator = evaluator_of(measured(truth, multisine(10240, rms=3.0, periods=2)))
    given = Hypothesis(REFERENCE)
    base = calibrate(evaluator, given, unknowns_of(given, evaluator))
    view = View(evaluator, base, {"base_motion": BaseMotion})

    first = beside(view, base, SILENT)[0]

    assert view.told.lines.free[0] == pytest.approx(71.34, abs=0.02)
    assert first.effect.frequency == pytest.approx(71.34, abs=0.05)


def test_a_dashpot_that_the_rigs_damping_was_pulled_to_imitate_is_seen_where_it_sits():
    truth = moved(REFERENCE, 0.5, -1.0, 0.3, 0.8, -0.6, 0.4, -0.3, 0.7, -0.5).with_effects(DASHPOT)
    evaluator = evaluator_of(measured(truth, multisine(4096, rms=10.0)))
    base = calibrate(evaluator, Hypothesis(REFERENCE), unknowns_of(Hypothesis(REFERENCE), evaluator))
    kinds = {name: EFFECTS[name] for name in ("point_damping", "point_mass", "point_stiffness")}

    first = beside(View(evaluator, base, kinds), base, SILENT)[0]

    assert base.ratio > 2.0
    assert first.effect.kind == "point_damping"
    assert first.effect.place.position == pytest.approx(0.95, abs=0.08)
    assert first.share > 0.5
