"""A virtual test by any simulator: what is done to the rig, and what comes back."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import degrees
from typing import ClassVar

import numpy as np

from models.arrays import FloatArray
from models.errors import InputError
from models.plant import Plant


@dataclass(frozen=True)
class Hold:
    """A static force that deflects the rig until the first sample, when it is let go.

    Attributes:
        position: m from the clamp.
        force: N, positive upwards.
    """

    position: float
    force: float


@dataclass(frozen=True, eq=False)
class Trial:
    """What is done to a rig.

    Attributes:
        fs: rate of the record, Hz.
        excitation: (N,) true excitation in the SI unit of the rig's excitation, band-limited between the samples.
        position: where the force acts, m from the clamp, if it is not where the rig says.
        angle: of the force about the beam's axis, rad, from upwards to the right as seen from the free end.
        hold: what deflects the rig before the first sample, or None.
        free: the record's own parameters of effects that have some (a phase), by name.
    """

    fs: float
    excitation: FloatArray
    position: float | None = None
    angle: float = 0.0
    hold: Hold | None = None
    free: Mapping[str, float] = field(default_factory=dict)

    @property
    def n_samples(self) -> int:
        """Samples in each channel."""
        return len(self.excitation)


@dataclass(frozen=True)
class Resolution:
    """How finely a simulator resolves the rig; None lets it choose, and it says what it chose and why.

    Attributes:
        n_parts: dynamic modes, segments or elements.
        steps_per_sample: steps of the integrator per sample of the record.
        rotary_inertia: whether the sections' own rotary inertia is counted, where the simulator can.
        native_contact: whether the engine's own contact acts in the sleeves instead of our laws, where it has one; a
            control for studies of contact.
        spatial: whether the beam bends across the rig's plane too, in sleeves that are round.
    """

    n_parts: int | None = None
    steps_per_sample: int | None = None
    rotary_inertia: bool = False
    native_contact: bool = False
    spatial: bool = False


@dataclass(frozen=True, eq=False)
class EnergyBalance:
    """Energy at each sample, from the first one on, J.

    Attributes:
        stored: (N,) in motion, bending and height.
        supplied: (N,) work of the excitation.
        damped: (N,) taken by the structure's own damping.
        taken: (N,) taken by point laws and contacts; what their springs hold is part of it.
    """

    stored: FloatArray
    supplied: FloatArray
    damped: FloatArray
    taken: FloatArray

    @property
    def fault(self) -> float:
        """Largest energy that nobody accounts for, as a share of all that was stored at first and supplied since."""
        left = self.stored - self.stored[0] + self.damped + self.taken - self.supplied
        moved = np.abs(np.diff(self.supplied)).sum() + np.abs(np.diff(self.taken)).sum()
        return float(np.abs(left).max() / max(moved, float(np.finfo(float).tiny)))


@dataclass(frozen=True, eq=False)
class Across:
    """What happens in the sleeves at right angles to the rig's plane, positive to the right as seen from the free end.

    Attributes:
        places: (n_contacts, M) m.
        forces: (n_contacts, M) N on the beam.
    """

    places: FloatArray
    forces: FloatArray


@dataclass(frozen=True, eq=False)
class Motion:
    """What a simulator answers.

    Attributes:
        channels: (n_sensors, N) in the order of the plant's sensors, SI, as recorded without noise.
        fs: rate of forces and gaps, the simulator's own steps, Hz.
        contact_forces: (n_contacts, M) N on the beam, positive upwards, in the rig's plane.
        places: (n_contacts, M) m, of the beam in each sleeve, from its unloaded axis.
        gaps: (n_contacts, M) m of room between beam and sleeve; negative where it is pressed in.
        energy: where it went.
        choices: what was chosen and why, one line each.
        across: the sleeves' other direction; None where the beam moves in the plane.
    """

    channels: FloatArray
    fs: float
    contact_forces: FloatArray
    places: FloatArray
    gaps: FloatArray
    energy: EnergyBalance
    choices: tuple[str, ...] = ()
    across: Across | None = None

    @property
    def pushes(self) -> FloatArray:
        """(n_contacts, M) N, the sizes of the contacts' forces, whichever way they act."""
        return np.asarray(np.hypot(self.contact_forces, 0.0 if self.across is None else self.across.forces))


def beam_limits(plant: Plant, resolution: Resolution) -> tuple[str, ...]:
    """What neither the chain nor the cable carries of a plant, in words."""
    structure = plant.structure
    asked = {
        "an oscillator (structure.kind), which needs no flexible beam": not structure.is_beam,
        "an axial load": structure.axial_force != 0.0,
        "a local loss of stiffness": bool(structure.hinges),
        "one loss factor for all modes": structure.loss_factor is not None,
        "stiffness_drift, a bending stiffness that changes in time": structure.stiffness_rate != 0.0,
        "a law on curvature": any(law.port.derivative > 1 for law in plant.laws),
        "an absorber in space": resolution.spatial and bool(structure.absorbers),
        **{f"{law.owner}, a law that knows the rig's plane only, in space": resolution.spatial for law in plant.laws},
    }
    return tuple(words for words, present in asked.items() if present)


def of_the_chain(resolution: Resolution) -> tuple[str, ...]:
    """What is asked for that the chain of segments alone has, in words."""
    asked = {"rotary inertia": resolution.rotary_inertia, "native contact": resolution.native_contact}
    return tuple(words for words, present in asked.items() if present)


def _is_pushed(plant: Plant) -> bool:
    return plant.excitation is not None and plant.excitation.quantity == "force"


class Simulator(ABC):
    """A way to move a rig; ``models.simulators.SIMULATORS`` holds one of each."""

    name: ClassVar[str]
    source: ClassVar[str]

    @abstractmethod
    def cannot_carry(self, plant: Plant, resolution: Resolution) -> tuple[str, ...]:
        """What is asked for and this simulator has not, in words; empty where it carries all of it."""

    def _mend(self, missing: str, resolution: Resolution) -> str:
        if not (resolution.spatial and "space" in missing):
            return "leave it out or take another simulator (--with)"
        return "leave --spatial out, or " + ("take mujoco or exudyn (--with)" if self.name == "modal" else "the law")

    @abstractmethod
    def natural_freqs(self, plant: Plant, n: int, resolution: Resolution) -> FloatArray:
        """(n,) of small undamped motion about rest on the sleeves, Hz."""

    @abstractmethod
    def carry_out(self, plant: Plant, trial: Trial, resolution: Resolution) -> Motion:
        """One test from rest, or from what a hold deflects.

        Raises:
            DivergenceError: the engine lost the motion; the message says what to change.
            InputError: no state at rest is found.
        """

    def run(self, plant: Plant, trial: Trial, resolution: Resolution = Resolution()) -> Motion:
        """One test, after a look at what the plant asks for.

        Args:
            plant: the rig with its effects.
            trial: what is done to it.
            resolution: how finely.

        Raises:
            InputError: the plant has something that this simulator cannot carry, or no state at rest.
            DivergenceError: the engine lost the motion.
        """
        self.check(plant, resolution, trial.angle)
        return self.carry_out(plant, trial, resolution)

    def check(self, plant: Plant, resolution: Resolution, angle: float = 0.0) -> None:
        """Refuse what this simulator cannot carry, by name.

        Args:
            plant: the rig with its effects.
            resolution: what is asked for.
            angle: of the trial's force, rad.

        Raises:
            InputError: the first thing.
        """
        if angle and not (resolution.spatial and _is_pushed(plant)):
            raise InputError(
                f"excitation.angle = {degrees(angle):g} degrees",
                "a force out of the rig's plane bends a beam that may leave it; a base moves in the plane",
                "ask for motion in space (--spatial), or leave the angle out",
            )
        missing = self.cannot_carry(plant, resolution)
        if missing:
            raise InputError(
                f"{self.name}: {missing[0]}",
                f"the simulator {self.name} carries every point force, contact and change of the measurement, not this",
                self._mend(missing[0], resolution),
            )
