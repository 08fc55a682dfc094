"""Contact laws at a sleeve: the normal force from penetration and its rate. One file a law, one line here."""

from models.contact.hertz import Hertz
from models.contact.hunt_crossley import HuntCrossley
from models.contact.kelvin_voigt import KelvinVoigt
from models.contact.protocol import ContactLaw

CONTACT_LAWS: dict[str, type[ContactLaw]] = {
    "kelvin_voigt": KelvinVoigt,
    "hunt_crossley": HuntCrossley,
    "hertz": Hertz,
}
