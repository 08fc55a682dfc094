"""What a spectrum asks of a record's channels, told before one is computed."""

from models.errors import InputError
from models.record import is_dead
from models.rig import Rig
from testbed.channels import Channels

FEWEST_SAMPLES = 256
"""Eight parts of 32 samples, whose spectra have 16 lines."""


def check_length(name: str, n_samples: int) -> None:
    """Whether a record is long enough for a spectrum.

    Args:
        name: of the record.
        n_samples: of each channel.

    Raises:
        InputError: it is not.
    """
    if n_samples < FEWEST_SAMPLES:
        raise InputError(
            f"{name}: {n_samples} samples",
            f"spectra are averaged over parts of a record, which takes {FEWEST_SAMPLES} samples or more",
            "record for longer",
        )


def check_driven(channels: Channels) -> None:
    """Whether an excitation that was measured moves.

    Args:
        channels: of a record.

    Raises:
        InputError: it is constant.
    """
    if channels.excitation is not None and is_dead(channels.excitation):
        raise InputError(
            f"{channels.name}: the measured excitation, a {channels.excitation_quantity}, is "
            f"{channels.excitation[0]:g} throughout",
            "responses are held against what drives the rig",
            "check its sensor and cable, or leave the channel out with --without",
        )


def check_excitation(name: str | None, rig: Rig) -> None:
    """Whether ``--excitation``, if it is given beside a rig, names the rig's own.

    Args:
        name: of the channel, or its node.
        rig: whose excitation it is.

    Raises:
        InputError: it is another one.
    """
    own = rig.excitation
    if name is not None and (own is None or name not in (own.name, str(own.node))):
        raise InputError(
            f"--excitation {name} beside --rig",
            f"the rig's excitation is {own.name if own is not None else 'none'}, its sensors are "
            f"{', '.join(sensor.name for sensor in rig.sensors)}",
            "leave --excitation out, correct [excitation] in the rig file, or leave --rig out",
        )
