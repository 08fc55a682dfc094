"""The rig as data: what fits together, what its toleranced numbers are, and how a fit changes them."""

import itertools
import timeit
from typing import get_args

import pytest
from pydantic import ValidationError

from models.rig import Beam, EffectEntry, Excitation, Oscillator, Rig, Sensor, Sleeve, next_named
from models.rig_parts import Term, term

BEAM = Beam(
    kind="beam",
    length=1.5,
    diameter=0.02,
    youngs_modulus=2e11,
    density=7850.0,
    rayleigh_damping=(1.2, 6e-6),
)
OSCILLATOR = Oscillator(kind="oscillator", mass=3.0, stiffness=1200.0, damping=0.7)
SLEEVES = (
    Sleeve(name="inner", position=0.5, clearance=1e-4, stiffness=1e5, damping=80.0),
    Sleeve(name="outer", position=1.0, clearance=0.0, stiffness=2e5),
)
TOLERANCES = {"youngs_modulus": 0.01, "rayleigh_damping": 0.05, "sleeves.clearance": 0.03, "sleeves.damping": 0.1}
RIG = Rig(structure=BEAM, sleeves=SLEEVES, tolerances=TOLERANCES)


def test_the_clamp_and_the_tip_are_places_on_the_beam():
    sensors = (Sensor(name="clamp", position=0.0), Sensor(name="tip", position=1.5))
    rig = Rig(structure=BEAM, excitation=Excitation(position=1.5), sensors=sensors)
    assert rig.sensor("tip").position == BEAM.length


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"sleeves": (SLEEVES[0], SLEEVES[0])}, 'sleeves[1].name = "inner", as sleeves[0].name'),
        (
            {"sleeves": (SLEEVES[1].model_copy(update={"position": 1.6}),)},
            "sleeves[0].position = 1.6 m; a position lies",
        ),
        ({"excitation": Excitation()}, "excitation.position is missing; a force on a beam acts at a position"),
        ({"excitation": Excitation(quantity="base_velocity", position=1.0)}, "a driven base moves clamp and sleeves"),
        ({"sensors": (Sensor(name="P1"),)}, "sensors[0].position is missing; a sensor on a beam has a position"),
        ({"sensors": (Sensor(name="P1", position=2),)}, "sensors[0].position = 2.0 m; a position lies within the beam"),
        ({"tolerances": {"gravity": 0.1}}, 'tolerances has the unknown key "gravity"'),
        ({"tolerances": {"sleeves.position": 0.1}}, 'tolerances has the unknown key "sleeves.position"'),
        (
            {"effects": (EffectEntry(kind="wear", sleeve="middle"),)},
            'effects[0].sleeve = "middle"; an effect\'s sleeve',
        ),
        ({"effects": (EffectEntry(kind="point_mass", position=1.6),)}, "effects[0].position = 1.6 m; a position lies"),
        ({"structure": OSCILLATOR, "tolerances": {}}, 'sleeves[0] is "inner", on an oscillator; an oscillator has no'),
    ],
)
def test_parts_that_do_not_fit_are_refused(changes, message):
    with pytest.raises(ValidationError) as caught:
        Rig(**{"structure": BEAM, "sleeves": SLEEVES, **changes})
    assert message in str(caught.value)


@pytest.mark.parametrize(
    "part",
    [
        {"excitation": Excitation(position=1.0)},
        {"sensors": (Sensor(name="P1", position=0.0),)},
        {"effects": (EffectEntry(kind="point_mass", position=1.0),)},
    ],
)
def test_nothing_on_an_oscillator_has_a_position(part):
    with pytest.raises(ValidationError, match="an oscillator has no length to measure a position along"):
        Rig(structure=OSCILLATOR, **part)


@pytest.mark.parametrize("quantity", ["base_acceleration", "base_velocity", "base_displacement"])
def test_a_driven_base_needs_no_position_on_either_structure(quantity):
    for structure in (BEAM, OSCILLATOR):
        assert Rig(structure=structure, excitation=Excitation(quantity=quantity)).excitation.position is None


@pytest.mark.parametrize("sensitivity", ["100 mV/g", "10.2 mV/(m/s^2)", "2.25e-3 V/N", "4pC/N", ".5 V/(rad/s)"])
def test_a_sensitivity_is_a_number_and_a_unit_per_unit(sensitivity):
    assert Sensor(name="P1", sensitivity=sensitivity).sensitivity == sensitivity


@pytest.mark.parametrize("sensitivity", ["mV/g", "100", "100 mV", "100 /g", "-100 mV/g", "", "100 mV per g"])
def test_other_sensitivities_are_refused(sensitivity):
    with pytest.raises(ValidationError):
        Sensor(name="P1", sensitivity=sensitivity)


def test_every_key_has_words_for_its_owner():
    for part in (Beam, Oscillator, Sleeve, Excitation, Sensor, EffectEntry, Rig):
        for key in part.model_fields:
            assert all([term(part, key).noun, term(part, key).rule, term(part, key).mend])
    assert [term(Beam, "rayleigh_damping", i).unit for i in range(2)] == ["1/s", "s"]


def test_every_number_that_can_be_uncertain_has_a_unit():
    for part, key in itertools.chain(*([(p, k) for k in p.uncertain] for p in (Beam, Oscillator, Sleeve))):
        elements = get_args(part.model_fields[key].annotation)
        words: list[Term] = [term(part, key, i) for i in range(len(elements))] or [term(part, key)]
        assert all(word.unit for word in words)


def test_parameters_are_the_toleranced_numbers_one_by_one():
    rows = [(p.path, p.label, p.unit, p.value) for p in RIG.parameters()]
    assert rows == [
        ("youngs_modulus", "Young's modulus", "Pa", 2e11),
        ("rayleigh_damping[0]", "Rayleigh damping eta1", "1/s", 1.2),
        ("rayleigh_damping[1]", "Rayleigh damping eta2", "s", 6e-6),
        ("sleeves[0].clearance", "clearance of inner", "m", 1e-4),
        ("sleeves[0].damping", "damping of inner", "N s/m", 80.0),
    ]


def test_the_std_is_the_tolerance_times_the_value():
    assert {p.path: p.std / p.value for p in RIG.parameters()} == pytest.approx(
        {
            "youngs_modulus": 0.01,
            "rayleigh_damping[0]": 0.05,
            "rayleigh_damping[1]": 0.05,
            "sleeves[0].clearance": 0.03,
            "sleeves[0].damping": 0.1,
        },
        rel=1e-14,  # two roundings
    )


def test_an_oscillator_has_parameters_and_one_without_tolerances_has_none():
    rig = Rig(structure=OSCILLATOR, tolerances={"stiffness": 0.1})
    assert [(p.path, p.label, p.unit, p.std) for p in rig.parameters()] == [("stiffness", "stiffness", "N/m", 120.0)]
    assert Rig(structure=OSCILLATOR).parameters() == ()


def test_with_values_replaces_what_is_named_and_nothing_else():
    changes = {"youngs_modulus": 1.9e11, "rayleigh_damping[1]": 5e-6, "sleeves[1].clearance": 3e-4, "gravity": 0}
    expected = RIG.model_dump()
    expected["structure"] |= {"youngs_modulus": 1.9e11, "rayleigh_damping": (1.2, 5e-6), "gravity": 0.0}
    expected["sleeves"][1]["clearance"] = 3e-4
    before = RIG.model_dump()
    assert RIG.with_values(changes).model_dump() == expected
    assert RIG.model_dump() == before


def test_both_elements_of_a_list_can_be_replaced_at_once():
    changed = RIG.with_values({"rayleigh_damping[0]": 2.0, "rayleigh_damping[1]": 1e-6})
    assert changed.structure.rayleigh_damping == (2.0, 1e-6)


def test_with_its_own_values_a_rig_is_the_same():
    assert RIG.with_values({p.path: p.value for p in RIG.parameters()}) == RIG
    assert RIG.with_values({}) == RIG


@pytest.mark.parametrize(
    "path",
    [
        "mass",
        "kind",
        "uncertain[0]",
        "youngs_modulus[0]",
        "rayleigh_damping",
        "rayleigh_damping[2]",
        "sleeves[2].clearance",
        "sleeves[0].name",
        "sleeves[-1].clearance",
        "sleeves.clearance",
        "structure.length",
        "",
    ],
)
def test_an_unknown_path_is_a_key_error_that_names_it(path):
    with pytest.raises(KeyError) as caught:
        RIG.with_values({path: 1.0})
    assert caught.value.args == (path,)


def test_with_values_is_fast_enough_for_the_inner_loop_of_a_fit():
    values = {p.path: p.value for p in RIG.parameters()}
    seconds = min(timeit.repeat(lambda: RIG.with_values(values), number=200, repeat=5)) / 200
    assert seconds < 150e-6  # below 50 us on an idle machine; the rest is room for a busy one


def test_an_effect_keeps_its_settings_unchangeable_and_apart_from_its_place():
    effect = EffectEntry(kind="time_varying_damping", sleeve="inner", times=[0, 1], values=[5.0, 2.0])
    assert effect.place == {"sleeve": "inner"}
    assert effect.settings == {"times": (0, 1), "values": (5.0, 2.0)}


def test_beside_a_sensor_the_position_is_a_setting():
    effect = EffectEntry(kind="sensor_position", sensor="P1", position=0.4)
    assert effect.place == {"sensor": "P1"}
    assert effect.settings == {"position": 0.4}
    assert EffectEntry(kind="point_mass", position=0.4, mass=0.1).settings == {"mass": 0.1}


def test_parts_are_found_by_name():
    assert RIG.sleeve("outer") is SLEEVES[1]
    assert next_named(SLEEVES, "inner") is SLEEVES[0]
    with pytest.raises(KeyError, match="P9"):
        RIG.sensor("P9")
