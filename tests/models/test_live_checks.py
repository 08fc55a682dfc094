"""What a running model carries, what of it may change, and the words in which it refuses the rest."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from model_scenes import REFERENCE, driven, rig_with, sensed, sleeve
from test_drive import Tremor

from models.contact.hertz import Hertz
from models.contact.kelvin_voigt import KelvinVoigt
from models.contact.time_varying import TimeVarying
from models.effects import EFFECTS, Effect, Place
from models.errors import InputError
from models.live import LONGEST_BLOCK, LiveModel
from models.live_band import CHANNEL_REACH
from models.live_checks import damped
from models.plant import build_plant
from models.ports import Contact
from models.rig import Excitation

FS, PEAK = 2048.0, 100.0
SLEEVE_2 = Place(sleeve="sleeve 2", position=1.0)


def plant_with(*effects):
    return build_plant(REFERENCE, extra=effects)


def started(plant, **choices):
    return LiveModel.of(plant, FS, **{"peak": PEAK, **choices})


def refused(call, *args, **kwargs):
    with pytest.raises(InputError) as caught:
        call(*args, **kwargs)
    return caught.value.given, caught.value.expected, caught.value.mend


def test_a_sleeve_that_the_rig_has_not_is_named():
    assert refused(started(plant_with()).with_damping, {"sleeve 9": 1.0}) == (
        "sleeve 'sleeve 9'",
        "the rig has sleeve 1, sleeve 2",
        "use one of these names",
    )


@pytest.mark.parametrize("damping", [-1.0, float("nan")])
def test_a_damping_that_is_none_is_refused(damping):
    assert refused(started(plant_with()).with_damping, {"sleeve 1": damping}) == (
        f"sleeve 1: damping = {damping:g} N s/m",
        "a damping is 0 or more",
        "give the law a passive damping",
    )


def test_a_law_without_a_damping_of_its_own_is_refused():
    live = started(build_plant(rig_with(sleeve(1.0, law="hunt_crossley", damping=5.0))))
    given, expected, mend = refused(live.with_damping, {"at 1.0": 12.0})
    assert given == "at 1.0: law = 'hunt_crossley'"
    assert expected.startswith("a damping in N s/m is set where the law's force is an elastic one and this number")
    assert mend == "change the law's own numbers with LiveModel.changed"
    assert live.changed(build_plant(rig_with(sleeve(1.0, law="hunt_crossley", damping=9.0)))).time == 0.0


OTHERS = {
    "structure": lambda: build_plant(REFERENCE, [EFFECTS["point_mass"](Place(position=0.8), 0.1)]),
    "excitation": lambda: build_plant(REFERENCE.model_copy(update={"excitation": Excitation(position=0.9)})),
    "sensors": lambda: build_plant(sensed(REFERENCE, (1.2, "acceleration"))),
    "point laws": lambda: plant_with(EFFECTS["coulomb_friction"](SLEEVE_2, 2.0, 1e-2)),
    "sleeves": lambda: build_plant(REFERENCE.model_copy(update={"sleeves": REFERENCE.sleeves[:1]})),
}


@pytest.mark.parametrize("part", OTHERS)
def test_a_plant_with_other_modes_ports_or_sensors_is_refused(part):
    assert refused(started(plant_with()).changed, OTHERS[part]()) == (
        f"a plant with other {part}",
        "a running model keeps its modes, its ports and its rest; laws and contacts may take other numbers",
        "start a new model with LiveModel.of",
    )


def with_contacts(**changes):
    plant = plant_with()
    return replace(plant, contacts=tuple(replace(contact, **changes) for contact in plant.contacts))


def test_a_plant_that_rests_otherwise_is_refused():
    given, expected, mend = refused(started(plant_with()).changed, with_contacts(law=KelvinVoigt(2e5, 80.0)))
    assert given.startswith("a plant whose forces at rest differ by ")
    assert given.endswith(" N")
    assert (expected[:28], mend[:21]) == ("a running model keeps its mo", "start a new model wit")


def test_a_contact_that_is_open_at_rest_may_stiffen_as_far_as_the_steps_resolve_it():
    soft, stiff, hard = (build_plant(rig_with(sleeve(1.0, 0.01, stiffness=k))) for k in (1e5, 2e5, 2e7))
    live = started(soft)
    assert live.changed(stiff).model.plant == stiff
    assert refused(live.changed, hard) == (
        "a plant whose contacts need 24 steps per sample",
        "the running model takes 3",
        "start it with steps = 24",
    )
    assert started(soft, steps=24).changed(hard).steps_per_sample == 24


@pytest.mark.parametrize(
    ("rig", "given"),
    [
        (driven(REFERENCE, "base_velocity"), "excitation.quantity = 'base_velocity'"),
        (REFERENCE.model_copy(update={"excitation": None}), "a rig without excitation"),
    ],
)
def test_a_plant_that_no_force_drives_is_refused(rig, given):
    assert refused(started, build_plant(rig)) == (
        given,
        "a live model is driven by a force",
        "simulate the whole record",
    )


@pytest.mark.parametrize("named", [True, False])
def test_a_stiffness_that_drifts_is_refused(named):
    drift = plant_with(EFFECTS["stiffness_drift"](Place(), 1e-3))
    assert refused(started, drift if named else replace(drift, effects=())) == (
        "stiffness_drift" if named else "structure.stiffness_rate = 0.001 1/s",
        "a live model keeps its linear structure; laws and contacts may change in time",
        "leave it out or simulate the whole record",
    )


def test_a_plant_without_sensors_is_refused():
    given, *_ = refused(started, build_plant(sensed(REFERENCE)))
    assert given == "a rig without sensors"


@dataclass(frozen=True)
class Late(Effect):
    """A recorder that is late by a sample."""

    kind: ClassVar[str] = "late"
    family: ClassVar[str] = "measurement"
    source: ClassVar[str] = "a test"

    def change_channels(self, channels, measurement):
        return np.roll(channels, 1, axis=-1)


@pytest.mark.parametrize("effect", [Late(Place()), Tremor(Place())])
def test_an_effect_that_looks_beyond_a_block_is_named(effect):
    given, expected, mend = refused(started, plant_with(effect))
    assert given == effect.kind
    assert expected.startswith("a live model carries what acts sample by sample; no shaken base, delay")
    assert mend == "leave it out or simulate the whole record"


@pytest.mark.parametrize("choice", [{"peak": 0.0}, {"peak": float("inf")}, {"reach": 0}, {"reach": LONGEST_BLOCK + 1}])
def test_a_peak_and_a_reach_are_numbers_that_mean_something(choice):
    given, expected, _ = refused(started, plant_with(), **choice)
    about = {"peak": PEAK, "reach": CHANNEL_REACH, **choice}
    assert given == f"peak = {about['peak']:g} N, reach = {about['reach']} samples"
    assert expected == f"a load is more than 0, a reach from 1 to {LONGEST_BLOCK}"


@pytest.mark.parametrize(
    ("force", "given"),
    [
        (np.zeros((2, 3)), "a force of size (2, 3), of which 0 are not finite"),
        (np.zeros(0), "a force of size (0,), of which 0 are not finite"),
        (np.array([1.0, np.nan]), "a force of size (2,), of which 1 are not finite"),
    ],
)
def test_a_force_is_a_row_of_finite_numbers(force, given):
    assert refused(started(plant_with()).advance, force) == (
        given,
        "a block is a row of one or more finite numbers, N",
        "pass the samples that follow the last block's",
    )


@pytest.mark.parametrize("exponent", [1.5, 1.3])
def test_a_damping_keeps_the_elastic_part_or_is_refused(exponent):
    """A law with an exponent of its own cannot be rebuilt from a stiffness and a damping."""
    contact = Contact("sleeve 1", 0.45, Hertz(1e9, 80.0, exponent), 1e-4)
    if exponent == 1.5:
        assert damped(contact, 12.0).law == Hertz(1e9, 12.0, exponent)
    else:
        assert refused(damped, contact, 12.0)[0] == "sleeve 1: law = 'hertz'"


def test_a_table_takes_one_damping_that_stays():
    contact = Contact("sleeve 1", 0.45, TimeVarying(1e5, (0.0, 1.0), (80.0, 40.0)), 1e-4)
    assert damped(contact, 12.0).law == TimeVarying(1e5, (0.0,), (12.0,))
