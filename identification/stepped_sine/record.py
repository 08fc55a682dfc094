"""A stepped-sine test as a value: for each frequency the amplitude of the force and the response's first harmonic."""

from dataclasses import dataclass, field

from models.arrays import ComplexArray, FloatArray
from models.record import FrfRecord


@dataclass(frozen=True, eq=False)
class SteppedSine(FrfRecord):
    """FRFs of one test with the force under which each line was measured; its lines are in the order of the test.

    Attributes:
        force: (n,) amplitude, N.
    """

    force: FloatArray = field(kw_only=True)

    @property
    def responses(self) -> ComplexArray:
        """(n_sensors, n) first harmonics, SI, with the phase against the force."""
        return self.values * self.force
