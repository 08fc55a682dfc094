"""What every effect of the library keeps, whichever it is; an effect that is added is tested here unasked."""

import importlib
import inspect
from dataclasses import replace
from math import inf
from pathlib import Path

import numpy as np
import pytest
from effect_scenes import BEAM, CONTACT, RIGS, as_compiled, places_of, scene_at, trials_of

import models.effects
from models.effects import EFFECTS, Effect, Place, build_effect, entry_of
from models.plant import build_plant
from models.rest import law_force
from models.rig import Rig

HOOKS = {
    "point force": {"point_laws", "change_contact"},
    "structure": {"change_structure"},
    "time": {"point_laws", "change_contact", "change_structure"},
    "measurement": {"change_excitation", "change_sensors", "change_channels", "base_acceleration"},
}
NOT_EFFECTS = {"__init__", "build", "protocol"}
SCALED_BY_MOTION = 1e-9  # rounding, magnified by the film near its wall

every_effect = pytest.mark.parametrize("cls", EFFECTS.values(), ids=EFFECTS)


def laws_of(effect: Effect, scene):
    contact = scene.contact and effect.change_contact(scene.contact)
    return effect.point_laws(contact, scene.structure)


def test_the_registry_holds_every_file_of_the_folder():
    files = {file.stem for file in Path(models.effects.__file__).parent.glob("*.py")} - NOT_EFFECTS
    assert set(EFFECTS) == files


@pytest.mark.parametrize("kind", EFFECTS)
def test_kind_key_and_file_have_one_name(kind):
    cls = EFFECTS[kind]
    assert cls.kind == kind
    assert cls is getattr(importlib.import_module(f"models.effects.{kind}"), kind.title().replace("_", ""))


@every_effect
def test_exactly_one_hook_of_the_family_is_overridden(cls):
    all_hooks = set().union(*HOOKS.values())
    own = {name for name in all_hooks if getattr(cls, name) is not getattr(Effect, name)}
    assert len(own) == 1
    assert own <= HOOKS[cls.family]


@every_effect
def test_it_says_what_it_is_and_where_that_is_written(cls):
    assert len(cls.source) > 20
    assert any(year in cls.source for year in map(str, range(1900, 2030)))
    assert inspect.getdoc(cls) != inspect.getdoc(Effect)
    assert set(cls.structures) <= {"beam", "oscillator"}
    assert set(cls.places) <= {"sleeve", "position", "sensor", "sensor pair"}
    assert "oscillator" not in cls.structures or "sleeve" not in cls.places or "position" in cls.places


@every_effect
def test_every_parameter_has_symbol_unit_bounds_and_prior(cls):
    assert cls.parameters() or "sensor pair" in cls.places
    for about in cls.parameters().values():
        assert about.symbol
        assert about.unit
        assert about.lower < about.upper
        assert about.lower > -inf
        assert about.scale == "linear" or about.lower >= 0.0
        assert 0.0 < about.spread < inf


@every_effect
def test_trials_are_few_distinct_and_within_bounds(cls):
    for structure in cls.structures:
        for place in places_of(cls, structure):
            trials = list(cls.trials(scene_at(place, structure)))
            assert 1 <= len(trials) <= 20
            assert len(set(trials)) == len(trials)
    for scene, effect in trials_of(cls):
        assert effect.place == scene.place
        for name, about in cls.parameters().items():
            values = np.atleast_1d(getattr(effect, name))
            assert np.all((about.lower <= values) & (values <= about.upper))
            assert about.scale == "linear" or np.all(values > 0.0)


@every_effect
def test_trials_lie_on_both_sides_of_nothing_where_the_effect_can(cls):
    """The survey takes no size to act in proportion: a gain above 1 is not seen from trials below it."""
    for structure in cls.structures:
        for place in places_of(cls, structure):
            trials = list(cls.trials(scene_at(place, structure)))
            for name, about in cls.parameters().items():
                if about.neutral is not None and about.lower < about.neutral < about.upper:
                    values = [getattr(trial, name) for trial in trials]
                    assert min(values) < about.neutral < max(values)


@every_effect
def test_trials_follow_the_scene(cls):
    """Twice the motion, force and clearance: the trial laws give twice the force, the trial gaps are twice as wide."""
    for structure in cls.structures:
        for place in places_of(cls, structure):
            small, large = scene_at(place, structure), scene_at(place, structure, amplitude=2.0)
            for one, other in zip(cls.trials(small), cls.trials(large), strict=True):
                for law, twice in zip(laws_of(one, small), laws_of(other, large), strict=True):
                    force = law.force(0.0, 1e-4, 0.02, 0.5, law.parameters)
                    assert twice.force(0.0, 2e-4, 0.04, 0.5, twice.parameters) == pytest.approx(
                        2 * force, rel=SCALED_BY_MOTION
                    )
                if place.sleeve:
                    gap, wide = one.change_contact(small.contact), other.change_contact(large.contact)
                    assert (wide.clearance, wide.offset) == pytest.approx((2 * gap.clearance, 2 * gap.offset))


@pytest.mark.parametrize("cls", [cls for cls in EFFECTS.values() if "sleeve" in cls.places], ids=lambda cls: cls.kind)
def test_trials_exist_where_the_given_model_never_touches(cls):
    """A sleeve without penetration, without damping or without clearance leaves no scale at 0."""
    (place,) = [place for place in places_of(cls, "beam") if place.sleeve]
    undamped = replace(CONTACT, law=replace(CONTACT.law, damping=0.0))
    for changes in ({"penetration": 0.0}, {"contact": undamped}, {"contact": replace(CONTACT, clearance=0.0)}):
        for effect in cls.trials(scene_at(place, **changes)):
            assert np.all(np.isfinite(effect.fitted_values()))
            assert np.all(effect.fitted_values() != 0.0)


@every_effect
def test_a_table_gives_the_effect_back(cls):
    for scene, effect in trials_of(cls):
        rig = RIGS["beam" if scene.structure.is_beam else "oscillator"]
        entry = entry_of(effect)
        assert build_effect(entry, rig, EFFECTS) == effect
        assert build_plant(Rig(**{**dict(rig), "effects": (entry,)})).effects == (effect,)


@every_effect
def test_fitted_values_go_out_and_in(cls):
    for _, effect in trials_of(cls):
        values = effect.fitted_values()
        names = [name for name, _ in effect.fitted_parameters()]
        assert len(values) == len(names)
        assert effect.with_fitted(values) == effect
        moved = effect.with_fitted(1.01 * values)
        np.testing.assert_allclose(moved.fitted_values(), 1.01 * values)
        assert moved.place == effect.place
        fixed = [name for name, about in cls.parameters().items() if not about.fitted]
        assert all(getattr(moved, name) == getattr(effect, name) for name in fixed)


@every_effect
def test_label_and_words_fit_a_report(cls):
    for _, effect in trials_of(cls):
        assert effect.label().startswith(cls.kind)
        assert str(effect.place) in effect.label()
        words = effect.in_words()
        assert "\n" not in words
        if not cls.parameters():
            assert all(name in words for name in (effect.place.sensor, effect.place.other))
            continue
        assert any(character.isdigit() for character in words)
        assert words != effect.with_fitted(1.5 * effect.fitted_values()).in_words()


@every_effect
def test_compiled_laws_are_the_python_laws(cls):
    rng = np.random.default_rng(1)
    for scene, effect in trials_of(cls):
        laws = [(law.force, law.parameters) for law in laws_of(effect, scene)]
        laws += [(law.rate, law.parameters) for law in laws_of(effect, scene) if law.rate is not None]
        if scene.contact is not None:
            contact = effect.change_contact(scene.contact)
            laws.append((contact.law.normal_force, contact.law.values))
        for law, parameters in laws:
            for motion in rng.uniform((-1.0, -4e-4, -0.1, -1.0), (5.0, 4e-4, 0.1, 1.0), (20, 4)):
                # Another order of rounding and another pow.
                assert as_compiled(law, motion, parameters) == pytest.approx(law(*motion, parameters), rel=1e-12)


@every_effect
def test_a_law_at_rest_on_the_straight_axis_carries_nothing(cls):
    for scene, effect in trials_of(cls):
        assert all(law_force(law, 0.0) == 0.0 for law in laws_of(effect, scene))


@every_effect
def test_a_plant_carries_the_effect_where_it_sits(cls):
    for scene, effect in trials_of(cls):
        if not scene.structure.is_beam:
            continue
        plant = build_plant(BEAM, extra=(effect,))
        assert plant.effects == (effect,)
        for law in plant.laws:
            assert law.port.position == effect.place.position or law.port.spread
            assert 0.0 < law.port.position <= BEAM.structure.length
            assert law.owner == effect.label()


@every_effect
def test_a_law_sits_at_its_sleeve_even_if_the_place_has_no_position(cls):
    for scene, effect in trials_of(cls):
        if effect.place.sleeve is not None:
            nameless = replace(effect, place=replace(effect.place, position=None))
            assert laws_of(nameless, scene) == laws_of(effect, scene)


@every_effect
@pytest.mark.parametrize(("key", "share"), [("clearance", 1.3), ("stiffness", 0.7), ("damping", 1.1)])
def test_what_says_a_number_of_its_sleeve_says_that_number(cls, key, share):
    value = share * (CONTACT.clearance if key == "clearance" else getattr(CONTACT.law, key))
    said = cls.from_sleeve_number(Place(sleeve="sleeve 1", position=0.5), CONTACT, key, value)
    assert said is None or said.as_sleeve_numbers(CONTACT) == pytest.approx({key: value})


def test_a_gap_and_a_spring_of_a_sleeve_are_said_by_effects():
    said = {
        key: {kind for kind, cls in EFFECTS.items() if cls.from_sleeve_number(Place(sleeve="1"), CONTACT, key, 1e-3)}
        for key in ("clearance", "stiffness", "damping")
    }
    assert said == {"clearance": {"clearance"}, "stiffness": {"contact_stiffness"}, "damping": set()}
