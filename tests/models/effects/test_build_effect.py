"""What the owner of a bad ``[[effects]]`` table reads: what was given, what was expected, how to mend it."""

import pytest
from effect_scenes import BEAM, OSCILLATOR

from models.effects import EFFECTS, Place, build_effect
from models.errors import InputError
from models.rig import EffectEntry, Rig

FRICTION = {"friction_force": 1.0, "slip_velocity": 1e-3}
FILM = {"kind": "squeeze_film", "sleeve": "outer"}

WRONG_ON_A_BEAM = [
    ({"kind": "squeze_film", "sleeve": "outer"}, 'new effect.kind = "squeze_film"',
     f'the nearest of the library\'s {len(EFFECTS)} kinds is "squeeze_film"',
     "write that one, or see all with testbed effects"),
    ({"kind": "xyz"}, 'new effect.kind = "xyz"', "the library has absorber, axial_", "choose one of them"),
    ({"kind": "sensor_position", "sensor": "tip", "position": 1.6}, "new effect.position = 1.6 m",
     "the beam ends at 1.5 m", "give a position between the clamp and the free end"),
    ({"kind": "squeeze_film", "damping": 1.0}, "new effect: squeeze_film with no place",
     "squeeze_film takes one sleeve", "give sleeve"),
    ({"kind": "squeeze_film", "position": 0.5, "damping": 1.0}, "new effect: squeeze_film with position = 0.5",
     "squeeze_film takes one sleeve", "give sleeve"),
    ({"kind": "cubic_stiffness", "sleeve": "outer", "position": 0.5, "stiffness": 1.0},
     'new effect: cubic_stiffness with sleeve = "outer" and position = 0.5',
     "cubic_stiffness takes either sleeve or position", "give sleeve or position"),
    ({"kind": "youngs_modulus", "position": 0.5, "ratio": 1.1}, "new effect: youngs_modulus with position = 0.5",
     "youngs_modulus takes no place", "remove position"),
    ({"kind": "squeeze_film", "sleeve": "inner", "damping": 1.0}, 'new effect.sleeve = "inner"',
     'the rig\'s sleeves are "outer"', "name one of them"),
    ({"kind": "sensor_gain", "sensor": "P9", "gain": 1.0}, 'new effect.sensor = "P9"',
     'the rig\'s sensors are "tip", "mid"', "name one of them"),
    ({"kind": "sensor_gain", "sensor": "tip", "position": 0.3, "gain": 1.0}, "new effect.position = 0.3",
     "sensor_gain has gain", "remove position"),
    ({"kind": "sensor_swap", "sensor": "tip"}, 'new effect: sensor_swap with sensor = "tip"',
     "sensor_swap takes one sensor and other", "give sensor and other"),
    ({"kind": "sensor_swap", "sensor": "tip", "other": "P9"}, 'new effect.other = "P9"',
     'the rig\'s sensors are "tip", "mid"', "name one of them"),
    ({"kind": "sensor_swap", "sensor": "tip", "other": "tip"}, 'new effect: sensor = other = "tip"',
     "a pair is two sensors", "name the second one under other"),
    ({"kind": "sensor_swap", "sensor": "tip", "other": "mid", "gain": 1.0}, "new effect.gain = 1.0",
     "sensor_swap has no numbers", "remove gain"),
    ({"kind": "sensor_gain", "sensor": "tip", "other": "mid", "gain": 1.0},
     'new effect: sensor_gain with sensor = "tip" and other = "mid"', "sensor_gain takes one sensor", "give sensor"),
    ({"kind": "point_mass", "position": 1.6, "mass": 1.0}, "new effect.position = 1.6 m", "the beam ends at 1.5 m",
     "give a position between the clamp and the free end"),
    ({**FILM, "dampin": 1.0}, "new effect.dampin = 1.0", "squeeze_film has damping", 'did you mean "damping"?'),
    ({**FILM, "damping": 1.0, "colour": "red"}, 'new effect.colour = "red"', "squeeze_film has damping",
     "remove colour"),
    (FILM, "new effect: squeeze_film without damping", "it needs damping", "add damping, in N s/m"),
    ({**FILM, "damping": -3.0}, "new effect.damping = -3.0",
     "squeeze_film's damping is one number, of at least 0 N s/m", "correct the value"),
    ({**FILM, "damping": "much"}, 'new effect.damping = "much"', "one number", "correct the value"),
    ({**FILM, "damping": True}, "new effect.damping = True", "one number", "correct the value"),
    ({**FILM, "damping": [1.0, 2.0]}, "new effect.damping = [1.0, 2.0]", "one number", "correct the value"),
    ({"kind": "bouc_wen", "position": 0.5, "force": 1.0, "yield_displacement": 1e-4, "exponent": 9.0},
     "new effect.exponent = 9.0", "bouc_wen's exponent is one number, between 1 and 4", "correct the value"),
    ({"kind": "coulomb_friction", "position": 0.5, "against": "wall", **FRICTION}, 'new effect.against = "wall"',
     "it is one of base, ground", "choose one of them"),
    ({"kind": "time_varying_damping", "sleeve": "outer", "times": 1.0, "values": 2.0}, "new effect.times = 1.0",
     "time_varying_damping's times is a list of numbers, each of at least 0 s", "correct the value"),
    ({"kind": "time_varying_damping", "sleeve": "outer", "times": [0.0, 1.0], "values": [2.0]},
     "time_varying_damping at outer: 2 times and 1 values", "a table has one value for each of its times",
     "give both lists the same length"),
    ({"kind": "time_varying_damping", "sleeve": "outer", "times": [1.0, 0.0], "values": [2.0, 3.0]},
     "time_varying_damping at outer: times = [1.0, 0.0]", "the times of a table grow",
     "sort the times, each with its value"),
]  # fmt: skip

WRONG_ON_AN_OSCILLATOR = [
    ({"kind": "squeeze_film", "damping": 1.0}, 'new effect.kind = "squeeze_film" on structure.kind = "oscillator"',
     "squeeze_film acts on beams only", "remove this effect or change the structure"),
    ({"kind": "point_mass", "position": 0.5, "mass": 1.0}, "new effect: point_mass with position = 0.5",
     "on an oscillator point_mass takes no place", "remove position"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("rig", "table", "given", "expected", "mend"),
    [(BEAM, *case) for case in WRONG_ON_A_BEAM] + [(OSCILLATOR, *case) for case in WRONG_ON_AN_OSCILLATOR],
)
def test_a_wrong_table_is_told_in_three_parts(rig, table, given, expected, mend):
    with pytest.raises(InputError) as caught:
        build_effect(EffectEntry(**table), rig, EFFECTS)
    assert caught.value.given.startswith(given)
    assert expected in caught.value.expected
    assert caught.value.mend == mend


def test_a_table_of_the_rig_file_is_named_by_its_index():
    entries = (EffectEntry(**FILM, damping=1.0), EffectEntry(**FILM, damping=-1.0))
    rig = Rig(**{**dict(BEAM), "effects": entries})
    with pytest.raises(InputError, match=r"^effects\[1\]\.damping = -1\.0; "):
        build_effect(entries[1], rig, EFFECTS)


def test_a_sleeve_gives_its_position_and_whole_numbers_are_numbers():
    effect = build_effect(EffectEntry(**FILM, damping=3), BEAM, EFFECTS)
    assert effect.place == Place(sleeve="outer", position=1.0)
    assert (effect.damping, type(effect.damping)) == (3.0, float)


def test_a_variant_is_chosen_by_its_key_and_the_first_is_the_default():
    built = [
        build_effect(EffectEntry(kind="coulomb_friction", **FRICTION, **choice), OSCILLATOR, EFFECTS)
        for choice in ({}, {"against": "base"}, {"against": "ground"})
    ]
    assert [effect.against for effect in built] == ["base", "base", "ground"]


def test_another_registry_has_other_kinds():
    entry = EffectEntry(kind="point_mass", position=0.5, mass=1.0)
    with pytest.raises(InputError, match="the library has squeeze_film;"):
        build_effect(entry, BEAM, {"squeeze_film": EFFECTS["squeeze_film"]})
