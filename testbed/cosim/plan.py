"""What a co-simulation is set up with: which sleeve is followed, how the rig is tapped, and how it is watched."""

from dataclasses import dataclass, replace
from math import ceil, log2

import numpy as np

from identification.decay.free import SETTLING
from identification.decay.sleeve_damping import DampingTable
from identification.decay.stream import PIECES
from models.arrays import ComplexArray, FloatArray
from models.band_limit import STOP_EDGE
from models.effects.time_varying_damping import TimeVaryingDamping
from models.errors import InputError
from models.linear import linearised, natural_modes
from models.live_checks import check_live, damped
from models.modal import ModalModel, build_modal
from models.plant import Plant, build_plant
from models.ports import Contact
from models.rig import Rig
from testbed.cosim.taps import Taps, rehearse

MODES = 5
"""Lowest modes at rest that lie in the flat part of the recorder's band; those up to its edge are followed too."""

FLAT_EDGE = 0.35
"""Share of the sampling rate up to which the recorder's gain is flat."""

SAMPLES_A_PERIOD = 40.0
"""Of the lowest mode at least."""

TIME_CONSTANTS = 1.5
"""Of the most telling mode's amplitude in a window: what is left then tells little more."""

LEAST_PERIODS = 4.0
"""Of the lowest mode in a window."""

MOST_OF_RUN = 0.1
"""Share of the run that a window takes at most, unless that is shorter than the lowest mode's periods."""

HOPS = 8
"""In a window: between two exchanges."""

HAMMER_ZERO = 1.5
"""First zero of a half sine's spectrum times its width; it lies at the highest of these modes."""

ANY_BAND = 1.0
"""Hz: a model for the state at rest keeps its least number of modes."""

REHEARSED_TIMES = 1001
"""At which the damping that varies is looked at."""


@dataclass(frozen=True)
class Wish:
    """What was asked for; None is chosen.

    Attributes:
        seconds: of the run.
        sleeve: name.
        channels: names of those that are watched; all where there is none.
        window: s.
        start: damping that the twin starts with, N s/m; the rig's own where None.
        snr: rms of the channels over that of their noise, dB.
        seed: of the noise.
    """

    seconds: float = 20.0
    sleeve: str | None = None
    channels: tuple[str, ...] = ()
    window: float | None = None
    start: float | None = None
    snr: float = 40.0
    seed: int = 0


@dataclass(frozen=True, eq=False)
class Plan:
    """A co-simulation that is ready to run.

    Attributes:
        wish: what was asked for.
        truth: the rig as its file describes it.
        rest_force: of the sleeve on it, N.
        twin: what the model starts from: a constant damping at the sleeve.
        sleeve: name.
        watched: (n_watched,) places of the channels among the rig's sensors.
        fs: sampling rate, Hz.
        hop: samples between two exchanges.
        window: s.
        taps: what drives both.
        noise: (n_sensors,) standard deviation on each channel, in its unit.
        table: modes over the sleeve's damping.
        poles: (n_modes,) at the twin's damping, 1/s.
    """

    wish: Wish
    truth: Plant
    rest_force: float
    twin: Plant
    sleeve: str
    watched: tuple[int, ...]
    fs: float
    hop: int
    window: float
    taps: Taps
    noise: FloatArray
    table: DampingTable
    poles: ComplexArray

    @property
    def n_samples(self) -> int:
        """Of the run, a whole number of hops."""
        return max(round(self.wish.seconds * self.fs / self.hop), 1) * self.hop

    def true_damping(self, times: FloatArray) -> FloatArray:
        """(n,) damping of the sleeve at (n,) times, N s/m."""
        return damping_over(_contact(self.truth, self.sleeve), times)


def damping_over(contact: Contact, times: FloatArray) -> FloatArray:
    """(n,) tangent damping of a closed contact at (n,) times, N s/m, at a small penetration."""
    p, v, law = 1e-6, 1e-6, contact.law
    pairs = [(law.normal_force(t, p, v, 0.0, law.values), law.normal_force(t, p, -v, 0.0, law.values)) for t in times]
    return np.array([(more - less) / (2.0 * v) for more, less in pairs])


def plan_of(rig: Rig, wish: Wish) -> Plan:
    """Choose what was not asked for, and rehearse the taps.

    Args:
        rig: as its file describes it.
        wish: what was asked for.

    Raises:
        InputError: a rig without force, sensors or a sleeve that touches at rest, names that it has not, a law whose
            damping is not in N s/m, or a window that is too short.
    """
    truth = build_plant(rig)
    sleeve = _sleeve(truth, wish.sleeve)
    twin = _twin(rig, sleeve, wish.start)
    fs = _rate(twin)
    check_live(truth, fs)
    linear = linearised(build_modal(twin, STOP_EDGE * fs))
    table = DampingTable.of(linear, sleeve, STOP_EDGE * fs)
    poles = table.poles[np.searchsorted(table.dampings, table.own)]
    freqs, rates = np.abs(poles) / (2.0 * np.pi), -poles.real
    least = LEAST_PERIODS / freqs[0]
    telling = int(np.argmax(-table.slopes[np.searchsorted(table.dampings, table.own)].real))
    window = wish.window or max(min(TIME_CONSTANTS / rates[telling], MOST_OF_RUN * wish.seconds), least)
    hop = PIECES * max(round(window * fs / HOPS / PIECES), 1)
    width = HAMMER_ZERO / freqs[min(MODES, len(freqs)) - 1]
    taps = Taps(window + width + (2 * SETTLING + hop) / fs, width, 1.0)
    rehearsal = rehearse(_lightest(truth, sleeve, wish.seconds), taps, fs)
    return Plan(
        wish=wish,
        truth=truth,
        rest_force=_carried(linear.model)[sleeve],
        twin=twin,
        sleeve=sleeve,
        watched=_watched(truth, wish.channels),
        fs=fs,
        hop=hop,
        window=window,
        taps=replace(taps, peak=rehearsal.peak),
        noise=rehearsal.rms * 10.0 ** (-wish.snr / 20.0),
        table=table,
        poles=poles,
    )


def _sleeve(plant: Plant, asked: str | None) -> str:
    """The sleeve to follow: as asked for, else the one whose damping varies, else the one that carries most."""
    model = build_modal(plant, ANY_BAND)
    carried = _carried(model)
    closed = {tangent.owner for tangent in linearised(model).tangents if tangent.stiffness > 0.0} & set(carried)
    if not closed:
        raise InputError(
            f"a rig with {len(carried)} sleeves, of which none touches at rest",
            "small motion tells the damping of a sleeve that is closed at rest",
            "place a sleeve where the rig rests on it (testbed modes shows the gaps)",
        )
    if asked is not None and asked not in closed:
        what = "it is open at rest" if asked in carried else "the rig has no such sleeve"
        raise InputError(
            f"--sleeve {asked!r}: {what}", f"{', '.join(sorted(closed))} can be followed", "name one of these"
        )
    varies = [effect.place.sleeve for effect in plant.effects if isinstance(effect, TimeVaryingDamping)]
    return asked or max(closed, key=lambda name: (name in varies, carried[name]))


def _twin(rig: Rig, sleeve: str, start: float | None) -> Plant:
    """The rig with a constant damping at the sleeve."""
    others = tuple(e for e in rig.effects if (e.kind, e.sleeve) != (TimeVaryingDamping.kind, sleeve))
    plant = build_plant(rig.model_copy(update={"effects": others}))
    contact = _contact(plant, sleeve)
    own = float(damping_over(contact, np.zeros(1))[0])
    try:
        followed = damped(contact, own if start is None else start)
    except InputError as error:
        raise InputError(
            f"{sleeve}: law = {contact.law.name!r}",
            "the damping that is followed is a number in N s/m",
            'give the sleeve law = "kelvin_voigt" or "hertz"',
        ) from error
    return replace(plant, contacts=tuple(followed if c is contact else c for c in plant.contacts))


def _lightest(plant: Plant, sleeve: str, seconds: float) -> Plant:
    """The rig with the smallest damping that the sleeve has in the run."""
    contact = _contact(plant, sleeve)
    least = float(damping_over(contact, np.linspace(0.0, seconds, REHEARSED_TIMES)).min())
    return replace(plant, contacts=tuple(damped(c, least) if c is contact else c for c in plant.contacts))


def _rate(plant: Plant) -> float:
    """Sampling rate, a power of two in Hz, whose flat band holds the lowest modes."""
    model = build_modal(plant, ANY_BAND)
    found = natural_modes(linearised(model), (), float(model.omega.max())).natural_freqs[:MODES]
    return float(2 ** ceil(log2(max(found[-1] / FLAT_EDGE, SAMPLES_A_PERIOD * found[0]))))


def _watched(plant: Plant, asked: tuple[str, ...]) -> tuple[int, ...]:
    names = [sensor.name for sensor in plant.sensors]
    for name in asked:
        if name not in names:
            raise InputError(f"--channel {name!r}", f"the rig has {', '.join(names)}", "name one of these")
    return tuple(i for i, name in enumerate(names) if not asked or name in asked)


def _carried(model: ModalModel) -> dict[str, float]:
    """What each sleeve carries at rest, N."""
    forces = np.abs(model.rest.contact_forces).tolist()
    return dict(zip([contact.sleeve for contact in model.plant.contacts], forces, strict=True))


def _contact(plant: Plant, sleeve: str) -> Contact:
    return next(contact for contact in plant.contacts if contact.sleeve == sleeve)
