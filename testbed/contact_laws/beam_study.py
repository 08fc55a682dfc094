"""A beam that is let go above its sleeves and strikes them, with every law in them, in every simulator."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import uniform_filter1d

from identification.frf import estimate_frf
from identification.metrics import frac, mre
from identification.progress import Progress
from models.arrays import ComplexArray
from models.contact.kelvin_voigt import KelvinVoigt
from models.plant import Plant, build_plant
from models.rig import Rig
from models.simulators import SIMULATORS, simulator
from models.simulators.protocol import Hold, Motion, Resolution, Trial
from testbed.contact_laws.agreement import largest_by_law
from testbed.contact_laws.laws import STUDY_LAWS, Meeting, StudyLaw
from testbed.crosscheck.measures import BAND, FS, LEVEL, multisine

RESTITUTIONS = (0.1, 0.3, 0.5, 0.7, 0.9, 0.95)
HOLDS = (20.0, 50.0, 100.0)
"""N upwards at the free end, until the beam is let go; restitutions are set for how it strikes from the middle one."""

SECONDS = 0.04
"""Watched after it is let go: the first strikes on each sleeve, before neighbouring motions part."""

FINE = {"modal": Resolution(24, 64), "mujoco": Resolution(32, 64), "exudyn": Resolution(28, 64)}
"""Short steps, since the force on a dashpot that is struck jumps and then falls with the square root of time, as a beam
gives way locally at once."""

FRF_SET, FRF_SECONDS = 0.5, 8.0
"""Restitution at which FRFs are compared, and the length of the test, s."""


@dataclass(frozen=True)
class BeamRow:
    """One law, restitution and height in one simulator.

    Attributes:
        law: key of ``STUDY_LAWS``.
        set: restitution that the law's numbers were chosen for.
        hold: N, from which the beam was let go.
        simulator: which.
        peak: largest force in a sleeve, N, in the mean over a sample of the record.
        impulse: of all sleeves, N s.
        duration: s, during which a sleeve is touched, summed over the sleeves.
        taken: energy, J, that laws took or that their springs hold at the end.
        stored: energy, J, that the held beam had above its lowest.
    """

    law: str
    set: float
    hold: float
    simulator: str
    peak: float
    impulse: float
    duration: float
    taken: float
    stored: float


@dataclass(frozen=True)
class FrfRow:
    """How a law changes the FRFs of the beam that strikes its sleeves, against spring and dashpot set alike.

    Attributes:
        law: key of ``STUDY_LAWS``.
        mre: mean relative difference of the magnitudes over all sensors and lines.
        frac: least FRAC of a sensor.
    """

    law: str
    mre: float
    frac: float


def meetings_of(plant: Plant) -> tuple[Meeting, ...]:
    """What meets in each sleeve, with the speed of the first strike without losses from the middle height.

    The mass that a restitution is set for is a quarter of the beam's, that of its first mode as seen from the free end.

    Args:
        plant: the beam.
    """
    bare = replace(plant, contacts=tuple(replace(c, law=KelvinVoigt(c.law.stiffness, 0.0)) for c in plant.contacts))
    motion = let_go(bare, HOLDS[1], "modal")
    mass = 0.25 * plant.structure.line_mass * plant.structure.length
    return tuple(
        Meeting(mass, contact.law.stiffness, 1.0, contact.clearance, _speed(motion, k), contact.position)
        for k, contact in enumerate(plant.contacts)
    )


def _speed(motion: Motion, sleeve: int) -> float:
    """Speed, m/s, of the first strike in a sleeve that was open, or the largest there is without one."""
    speed = np.abs(np.gradient(motion.places[sleeve])) * motion.fs
    closing = np.flatnonzero((motion.gaps[sleeve][:-1] > 0.0) & (motion.gaps[sleeve][1:] <= 0.0))
    return float(speed[closing[0]] if len(closing) else speed.max())


def with_law(plant: Plant, law: StudyLaw, restitution: float, meetings: Sequence[Meeting]) -> Plant:
    """The beam with a law of the study in all its sleeves.

    Args:
        plant: the beam.
        law: of the study.
        restitution: that it is set for.
        meetings: of the sleeves.
    """
    stops = [law.stop(restitution, meeting) for meeting in meetings]
    contacts = tuple(replace(c, law=stop.law) for c, stop in zip(plant.contacts, stops, strict=True))
    return replace(plant, contacts=contacts, laws=(*plant.laws, *(film for stop in stops for film in stop.films)))


def let_go(plant: Plant, hold: float, name: str) -> Motion:
    """The beam held up at its free end and let go.

    Args:
        plant: the beam.
        hold: N.
        name: of the simulator.
    """
    trial = Trial(FS, np.zeros(round(SECONDS * FS)), hold=Hold(plant.structure.length, hold))
    return simulator(name).run(plant, trial, FINE[name])


def beam_study(rig: Rig, progress: Progress, simulators: Sequence[str] = tuple(SIMULATORS)) -> list[BeamRow]:
    """Every law at every restitution and height.

    Args:
        rig: a beam with sleeves.
        progress: told what is being done.
        simulators: which.
    """
    plant = build_plant(rig)
    meetings = meetings_of(plant)
    rows = []
    for key, law in STUDY_LAWS.items():
        progress(f"the beam against {law.name} in {', '.join(simulators)}")
        for restitution in (1.0,) if law.lossless else RESTITUTIONS:
            tried = with_law(plant, law, restitution, meetings)
            rows += [
                _row(key, restitution, hold, name, let_go(tried, hold, name)) for hold in HOLDS for name in simulators
            ]
    return rows


def _row(law: str, restitution: float, hold: float, name: str, motion: Motion) -> BeamRow:
    size, energy = motion.pushes, motion.energy
    sample = uniform_filter1d(size, round(motion.fs / FS), axis=1)
    return BeamRow(
        law,
        restitution,
        hold,
        name,
        float(sample.max()),
        float(size.sum() / motion.fs),
        float(np.count_nonzero(size) / motion.fs),
        float(energy.taken[-1]),
        float(np.ptp(energy.stored)),
    )


def disagreement(rows: Sequence[BeamRow]) -> dict[str, float]:
    """Largest difference between the simulators by law, of force, impulse and energy, relative to the modal model's.

    Args:
        rows: of all simulators.
    """

    def shares(row: BeamRow, modal: BeamRow) -> Iterator[float]:
        yield abs(row.peak / modal.peak - 1.0)
        yield abs(row.impulse / modal.impulse - 1.0)
        yield abs(row.taken - modal.taken) / modal.stored

    return largest_by_law(rows, lambda row: row.hold, shares)


def frf_study(rig: Rig, progress: Progress) -> list[FrfRow]:
    """The FRFs of the modal model with every law, against spring and dashpot.

    Args:
        rig: a beam with sleeves that is driven by a force.
        progress: told what is being done.
    """
    progress(f"FRFs under {LEVEL:g} N rms with every law set for {FRF_SET:g}")
    plant = build_plant(rig)
    meetings = meetings_of(plant)
    frfs: Mapping[str, ComplexArray] = {
        key: _frf(with_law(plant, law, FRF_SET, meetings)) for key, law in STUDY_LAWS.items()
    }
    known = frfs["kelvin_voigt"]
    return [FrfRow(key, float(mre(own, known).mean()), float(frac(own, known).min())) for key, own in frfs.items()]


def _frf(plant: Plant) -> ComplexArray:
    force = multisine(LEVEL, FRF_SECONDS)
    motion = simulator("modal").run(plant, Trial(FS, force), Resolution())
    estimate = estimate_frf(force, motion.channels, FS, resolution=1.0)
    inside = (estimate.frequency >= BAND[0]) & (estimate.frequency <= BAND[1])
    return estimate.h1[:, inside]
