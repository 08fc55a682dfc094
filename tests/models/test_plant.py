"""The rig with its effects in place: in which order they act, and what they act on."""

from dataclasses import dataclass
from typing import ClassVar

import pytest
from model_scenes import REFERENCE, rig_with, sleeve

from models.contact.kelvin_voigt import KelvinVoigt
from models.effects import EFFECTS, Effect, Place
from models.errors import InputError
from models.plant import build_plant, contact_of
from models.rig import EffectEntry

AT_1 = Place(sleeve="at 1.0", position=1.0)


def test_a_rig_without_effects_is_taken_as_it_is():
    plant = build_plant(REFERENCE)
    assert [c.sleeve for c in plant.contacts] == ["sleeve 1", "sleeve 2"]
    assert [c.position for c in plant.contacts] == [0.45, 1.0]
    assert {(c.clearance, c.offset, c.clearance_rate, c.law) for c in plant.contacts} == {
        (1.5e-4, 0.0, 0.0, KelvinVoigt(1e5, 80.0))
    }
    assert (plant.laws, plant.effects) == ((), ())
    assert plant.excitation == REFERENCE.excitation
    assert plant.sensors == REFERENCE.sensors


def test_effects_of_the_rig_file_come_before_the_ones_added():
    rig = rig_with(sleeve(1.0)).model_copy(
        update={"effects": (EffectEntry(kind="clearance", sleeve="at 1.0", clearance=2e-4),)}
    )
    later = EFFECTS["clearance"](AT_1, clearance=3e-4)
    assert build_plant(rig).contacts[0].clearance == 2e-4
    plant = build_plant(rig, extra=[later])
    assert plant.contacts[0].clearance == 3e-4
    assert [effect.clearance for effect in plant.effects] == [2e-4, 3e-4]


def test_a_law_sees_the_contact_with_all_changes():
    film = EFFECTS["squeeze_film"](AT_1, damping=5.0)
    wider = EFFECTS["clearance"](AT_1, clearance=4e-4)
    plant = build_plant(rig_with(sleeve(1.0)), extra=[film, wider])
    assert plant.laws[0].parameters == (5.0, 4e-4, 0.0)
    assert plant.laws[0].owner == "squeeze_film at at 1.0"


def test_an_effect_at_one_sleeve_leaves_the_other_alone():
    stiffer = EFFECTS["contact_stiffness"](AT_1, ratio=2.0)
    plant = build_plant(rig_with(sleeve(0.5), sleeve(1.0)), extra=[stiffer])
    assert [c.law.stiffness for c in plant.contacts] == [1e5, 2e5]


def test_an_unknown_contact_law_is_refused_with_those_there_are():
    with pytest.raises(InputError) as caught:
        contact_of(sleeve(1.0, law="hertz_mindlin"))
    assert caught.value.given == "at 1.0: law = 'hertz_mindlin'"
    assert "kelvin_voigt" in caught.value.expected
    assert caught.value.mend == "choose one of them"


def test_a_registry_of_ones_own_is_asked():
    @dataclass(frozen=True)
    class Ballast(Effect):
        kind: ClassVar[str] = "ballast"
        family: ClassVar[str] = "structure"
        source: ClassVar[str] = "a test"

        def change_structure(self, structure):
            return structure.with_mass(structure.length, 1.0)

    rig = REFERENCE.model_copy(update={"effects": (EffectEntry(kind="ballast"),)})
    assert build_plant(rig, registry={"ballast": Ballast}).structure.masses == ((1.469, 1.0),)
    with pytest.raises(InputError, match="ballast"):
        build_plant(rig)
