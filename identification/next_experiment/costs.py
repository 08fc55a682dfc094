"""What a test costs and how far it may go, as the person at the rig would say."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Costs:
    """Minutes before a record runs, typical of a shaker, accelerometers and a hammer on a laboratory's table.

    Attributes:
        setting: another level, band or signal at the amplifier.
        hammer: taking the hammer and trying a blow.
        hold: hanging a weight on a thread and burning the thread.
        sensor: gluing one more sensor on and naming its channel.
        shaker: moving the shaker and aligning it.
    """

    setting: float = 1.0
    hammer: float = 2.0
    hold: float = 4.0
    sensor: float = 5.0
    shaker: float = 15.0


@dataclass(frozen=True)
class Limits:
    """How far a test may go beyond what the rig has seen.

    Attributes:
        force: largest excitation, times the largest so far.
        reading: largest reading of any sensor that the rivals predict, times its largest so far.
        warned: reading from which the proposal says so.
    """

    force: float = 4.0
    reading: float = 6.0
    warned: float = 1.5


COSTS, LIMITS = Costs(), Limits()
