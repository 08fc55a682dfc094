"""Two effects that one could replace, by itself or of another kind, and two that are needed."""

from dataclasses import replace

import pytest
from trial_records import beam_session, fit_of, found_with

from identification import alone, anew
from identification.alone import one_alone
from identification.evidence import Ranked
from models.effects import EFFECTS, Place
from models.effects.absorber import Absorber
from models.effects.axial_load import AxialLoad
from models.effects.local_damage import LocalDamage
from models.effects.point_mass import PointMass
from models.effects.point_stiffness import PointStiffness
from models.effects.sensor_gain import SensorGain

MASS, GAIN = PointMass(Place(position=0.86), mass=0.1), SensorGain(Place(sensor="P4"), gain=0.8)
DAMAGE = LocalDamage(Place(position=0.64), loss=0.2, width=0.1)
LIGHT, LOAD = PointMass(Place(position=0.7), mass=0.05), AxialLoad(Place(), force=-20.0)
SWINGING = Absorber(Place(position=0.7), mass=0.05, frequency=30.0, damping_ratio=0.02)
ASTRAY = PointStiffness(Place(position=0.4), stiffness=9000.0)


def test_another_kind_replaces_two_that_imitated_it():
    session = beam_session(DAMAGE)
    found = found_with(session, LIGHT, LOAD)
    assert found.ratio > 1.3

    less = one_alone(session, found_with(session), found)

    (damage,) = less.fit.hypothesis.effects
    assert damage.kind == "local_damage"
    assert damage.place.position == pytest.approx(0.64, abs=0.03)
    assert less.fit.ratio == pytest.approx(1.0, abs=0.1)
    assert less.rounds[0][0].effect.kind == "local_damage"
    assert "replaced by local_damage at" in less.label
    assert "explains the records as well" in session.decisions[-1]


@pytest.mark.parametrize("pair", [(MASS, ASTRAY), (ASTRAY, MASS)], ids=["first", "second"])
def test_one_of_two_stands_by_itself_with_its_rivals(pair):
    session = beam_session(MASS)
    session.registry = {kind: EFFECTS[kind] for kind in ("point_stiffness", "axial_load")}  # these find no mass
    found = found_with(session, *pair)

    less = one_alone(session, found_with(session), found)

    (mass,) = less.fit.hypothesis.effects
    assert mass.kind == "point_mass"
    assert mass.mass == pytest.approx(0.1, rel=0.05)
    assert len({row.effect.kind for row in less.rounds[0]}) > 1


@pytest.mark.parametrize(
    ("rival", "worse", "stays"), [(LIGHT, 1.0, False), (LIGHT, 1.12, True), (SWINGING, 1.0, True)], ids=str
)
def test_another_kind_has_to_come_as_near_with_no_more_numbers(monkeypatch, rival, worse, stays):
    session = beam_session(MASS, GAIN)
    found = found_with(session, MASS, GAIN)
    there = fit_of(rival, worse**2 * found.chi2, n_data=found.n_data)
    monkeypatch.setattr(alone, "_each_of_them", lambda *_: [])
    monkeypatch.setattr(alone, "judged_anew", lambda *_: [Ranked.of(there)])

    assert (one_alone(session, found, found) is None) == stays


def test_what_was_never_fitted_to_all_replaces_nothing(monkeypatch):
    session = beam_session(MASS, GAIN)
    found = found_with(session, MASS, GAIN)
    near = fit_of(LIGHT, found.chi2, n_data=found.n_data)
    sketch = replace(Ranked.of(fit_of(ASTRAY, 0.01 * found.chi2, n_data=100)), refitted=False)
    monkeypatch.setattr(alone, "_each_of_them", lambda *_: [])
    for rows, kind in (([sketch], None), ([sketch, Ranked.of(near)], "point_mass")):
        monkeypatch.setattr(alone, "judged_anew", lambda *_, rows=rows: rows)
        less = one_alone(session, found, found)
        assert (less and less.fit.hypothesis.effects[-1].kind) == kind


def test_others_are_not_fitted_where_no_first_fit_comes_near(monkeypatch):
    session = beam_session(MASS, GAIN)
    found = found_with(session, MASS, GAIN)
    session.registry = {kind: EFFECTS[kind] for kind in ("point_stiffness", "axial_load")}
    monkeypatch.setattr(anew, "finals", lambda *_: pytest.fail("fitted"))

    assert one_alone(session, found_with(session), found) is None


@pytest.mark.study
def test_two_that_are_needed_stay():
    session = beam_session(MASS, GAIN)

    assert one_alone(session, found_with(session), found_with(session, MASS, GAIN)) is None
    assert session.decisions == []


def test_a_single_one_is_not_asked():
    session = beam_session(MASS)
    found = found_with(session, MASS, iterations=0)

    assert one_alone(session, found, found) is None
