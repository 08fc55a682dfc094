"""What to measure next, as values: the report and the files are made from these alone."""

from collections.abc import Mapping
from dataclasses import dataclass

from identification.next_experiment.planned import PlannedTest
from models.effects import Effect
from models.rig import Rig


@dataclass(frozen=True, eq=False)
class Option:
    """One affordable test and what it promises.

    Attributes:
        test: what is done.
        expected_probability: of the right rival afterwards.
        separation: of the two rivals that it parts least, in standard deviations of the noise and of the model's own
            error (``evidence.unit_of``).
        reach: largest reading that is expected, times the largest so far.
        followed: seconds of the record that neighbouring motions stay together.
        confirmed: whether fits have confirmed what it promises; else that is an upper bound.
    """

    test: PlannedTest
    expected_probability: float
    separation: float
    reach: float
    followed: float
    confirmed: bool = False


@dataclass(frozen=True, eq=False)
class Proposal:
    """The next experiment.

    Attributes:
        do: in words.
        why: in words.
        test: what is done, or None where nothing at hand helps or no level is known.
        options: affordable tests, the best first; empty where no group is to be told apart.
        present_probability: that the right rival has on average now; None without a group.
        rivals: the group.
        rig: with the sensor that the test adds, or None.
        noise: of each sensor and of the ``excitation``, SI, as in the records so far.
    """

    do: str
    why: str
    test: PlannedTest | None = None
    options: tuple[Option, ...] = ()
    present_probability: float | None = None
    rivals: tuple[Effect, ...] = ()
    rig: Rig | None = None
    noise: Mapping[str, float] | None = None

    @property
    def best(self) -> Option | None:
        """The option that is proposed."""
        return self.options[0] if self.options else None
