"""The rig with its effects in place: what is simulated, before any matrix is formed."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Self

from models.contact import CONTACT_LAWS
from models.effects import EFFECTS, Effect, build_effect
from models.errors import InputError
from models.ports import Contact, PointLaw
from models.rig import Excitation, Rig, Sensor, Sleeve
from models.structure import Structure


@dataclass(frozen=True)
class Plant:
    """A structure, the contacts and point laws on it, what drives it and what reads it.

    Attributes:
        structure: linear part without the sleeves.
        contacts: one a sleeve.
        laws: point laws of the effects.
        excitation: what the record's excitation channel is.
        sensors: where the sensors really are.
        effects: all effects in the order of the rig file, for the measurement chain.
    """

    structure: Structure
    contacts: tuple[Contact, ...]
    laws: tuple[PointLaw, ...]
    excitation: Excitation | None
    sensors: tuple[Sensor, ...]
    effects: tuple[Effect, ...]

    def driven_at(self, position: float | None) -> Self:
        """With its excitation at another place along the beam; as it is where none is given, or nothing drives it."""
        if position is None or self.excitation is None:
            return self
        return replace(self, excitation=self.excitation.model_copy(update={"position": position}))

    def later(self, seconds: float) -> Self:
        """As a record meets it that begins so much later: what changes through a record has changed by then."""
        contacts = tuple(contact.later(seconds) for contact in self.contacts)
        return replace(self, structure=self.structure.later(seconds), contacts=contacts)


def build_plant(rig: Rig, extra: Iterable[Effect] = (), registry: Mapping[str, type[Effect]] = EFFECTS) -> Plant:
    """The rig with the effects of its own file, then ``extra``, in place.

    Args:
        rig: the description.
        extra: effects besides those of the rig file.
        registry: kind -> class, for the rig file's effects.

    Raises:
        InputError: an effect or a contact law that does not fit the rig.
    """
    whole = (*(build_effect(entry, rig, registry) for entry in rig.effects), *extra)
    effects = tuple(part for effect in whole for part in effect.parts())
    structure, sensors = Structure.of(rig.structure), rig.sensors
    for effect in effects:
        structure = effect.change_structure(structure)
    for effect in effects:
        sensors = effect.change_sensors(sensors, structure)
    contacts = {sleeve.name: contact_of(sleeve) for sleeve in rig.sleeves}
    for effect in effects:
        if effect.place.sleeve is not None:
            contacts[effect.place.sleeve] = effect.change_contact(contacts[effect.place.sleeve])
    laws = tuple(
        law for effect in effects for law in effect.point_laws(contacts.get(effect.place.sleeve or ""), structure)
    )
    return Plant(structure, tuple(contacts.values()), laws, rig.excitation, sensors, effects)


def contact_of(sleeve: Sleeve) -> Contact:
    """The contact that the rig file gives this sleeve.

    Raises:
        InputError: a law that the library does not have.
    """
    law = CONTACT_LAWS.get(sleeve.law)
    if law is None:
        raise InputError(
            f"{sleeve.name}: law = {sleeve.law!r}", f"the laws are {', '.join(CONTACT_LAWS)}", "choose one of them"
        )
    return Contact(sleeve.name, sleeve.position, law.from_sleeve(sleeve.stiffness, sleeve.damping), sleeve.clearance)
