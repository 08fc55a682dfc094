"""An identification over files: ``identification.json``, figures and, for a sleeve, the updated rig in a folder."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from identification.decay.attempt import Settings
from identification.decay.cause import Cause
from identification.decay.damping_terms import shares_of, three_terms
from identification.decay.identify import Decay, Identification, ModeInDecay, identify
from identification.decay.smoother import Interval
from identification.progress import Progress
from models.errors import InputError, in_file
from models.rig import Rig
from testbed.figures.identify import mode_figure, names_of, sleeve_figure, spectrum_figure
from testbed.figures.save import save
from testbed.history import UPDATED
from testbed.identify.record import Decays, decays_of
from testbed.identify.scalogram import scalogram_of
from testbed.identify.sleeve import SleeveDamping, check_sleeve, sleeve_damping, sleeve_findings, write_updated
from testbed.identify.words import findings_of
from testbed.outputs import Json, json_text, staged
from testbed.quantities import unit_of
from testbed.whole_rig import whole_rig

MECHANISMS = 3
"""Of damping, which as many modes at least tell apart."""

RIDGE_SAMPLES = 1000
"""Of the ridge in the JSON at most, evenly spaced."""


@dataclass(frozen=True)
class Order:
    """What is asked for.

    Attributes:
        record: file.
        rig: file, or None.
        channels: names; all where none is named.
        excitation: name of its channel.
        without: channels to leave out.
        begin: of the decay, s, or None.
        end: of the decay, s, or None.
        mass: equivalent mass of the first mode, kg, for its c(t); None where it is not asked for.
        sleeve: whose damping changes; None where the rig is not to be updated.
    """

    record: Path
    rig: Path | None
    channels: tuple[str, ...]
    excitation: str | None
    without: tuple[str, ...]
    begin: float | None
    end: float | None
    mass: float | None
    sleeve: str | None


def run_identification(order: Order, settings: Settings, out: Path, *, progress: Progress) -> Json:
    """Identify a record's decays and write the result.

    Args:
        order: what is asked for.
        settings: how.
        out: folder of the results.
        progress: told what is being done.

    Returns:
        the content of ``identification.json``.

    Raises:
        InputError: a record without a decay that can be used, or a folder that cannot be written.
    """
    if order.sleeve is not None and order.rig is None:
        raise InputError(
            f"--sleeve {order.sleeve!r} without a rig",
            "a sleeve's damping follows from a mode's through the rig's model",
            "name the rig with --rig",
        )
    rig = None if order.rig is None else whole_rig(order.rig)
    _check(order, rig)
    decays = decays_of(
        order.record,
        rig,
        order.channels,
        excitation=order.excitation,
        without=order.without,
        begin=order.begin,
        end=order.end,
    )
    with in_file(decays.channels.name):
        found = identify(decays.signals, decays.starts, decays.channels.fs, decays.kick_signs, settings, progress)
    content = identification_json(found, decays, settings, order.mass)
    with staged(out) as stage:
        if rig is not None and order.sleeve is not None and order.rig is not None:
            damping = sleeve_damping(found, rig, order.sleeve)
            write_updated(order.rig, rig, damping, stage / UPDATED)
            content["sleeve"] = _sleeve_json(damping, order.sleeve)
            content["findings"] += sleeve_findings(damping, found, order.sleeve)
            save(sleeve_figure(damping, order.sleeve), stage / "figures", "sleeve")
        (stage / "identification.json").write_text(json_text(content), encoding="utf-8")
        progress("drawing")
        _draw(found, decays, stage)
    return content


def _check(order: Order, rig: Rig | None) -> None:
    """Refuse, before a record is read, a sleeve that the rig does not have or that is open, and a mass that is none."""
    if rig is not None and order.sleeve is not None:
        sleeves = [sleeve.name for sleeve in rig.sleeves]
        if order.sleeve not in sleeves:
            has = f"the rig's sleeves are {', '.join(sleeves) or 'none'}"
            raise InputError(f"--sleeve {order.sleeve!r}", has, "name one of these")
        check_sleeve(rig, order.sleeve)
    if order.mass is not None and order.mass <= 0.0:
        raise InputError(f"--mass {order.mass:g}", "an equivalent mass is more than 0 kg", "leave it out if unknown")


def identification_json(found: Identification, decays: Decays, settings: Settings, mass: float | None) -> Json:
    """The content of ``identification.json``.

    Args:
        found: finished.
        decays: what was identified.
        settings: how.
        mass: equivalent mass of the first mode, kg, or None.
    """
    first = found.decays[0]
    omega = 2.0 * np.pi * np.array([mode.natural_freq for mode in first.modes])
    ratios = np.array([mode.damping_ratio for mode in first.modes])
    told = len(ratios) >= MECHANISMS and bool((ratios > 0.0).all())
    shares = shares_of(omega, ratios) if told else None
    content: Json = {
        "record": decays.channels.name,
        "channels": list(decays.channels.sensors),
        "denoising": settings.denoising,
        "seed": settings.seed,
        "cuts": found.cuts,
        "removed": [{"rms": one.removed_rms, "what": list(one.what)} for one in found.denoised],
        "decays": [_decay_json(decay, found, decays) for decay in found.decays],
        "damping_mechanism": None
        if shares is None
        else {
            "mass_proportional": shares.coefficients[0],
            "stiffness_proportional": shares.coefficients[1],
            "loss_factor": shares.coefficients[2],
            "misfit": shares.misfit,
        },
        "findings": [*decays.findings, *findings_of(found)],
    }
    if mass is not None:
        content["damping"] = _dashpot_json(first.modes[0], mass)
    return content


def _decay_json(decay: Decay, found: Identification, decays: Decays) -> Json:
    return {
        "from": decay.start,
        "to": decay.start + decay.signals.shape[1] / decay.fs,
        "modes": [
            {
                "natural_freq": mode.natural_freq,
                "natural_freq_std": mode.natural_freq_std,
                "damping_ratio": mode.damping_ratio,
                "damping_ratio_std": mode.damping_ratio_std,
                "shape": {
                    name: {"real": value.real, "imag": value.imag}
                    for name, value in zip(decays.channels.sensors, mode.shape, strict=True)
                },
                "frequency": _interval_json(mode.frequency),
                "damping": _interval_json(mode.damping),
                "jumps": [
                    {"time": jump.time, "std": jump.std, "probability": jump.probability}
                    for jump in mode.smoothed.decay.jumps
                ],
                "ridge": _ridge_json(mode),
                "damping_depends_on": _cause_json(found.damping_causes[m]),
                "frequency_depends_on": _cause_json(found.frequency_causes[m]),
            }
            for m, mode in enumerate(decay.modes)
        ],
    }


def _interval_json(course: Interval) -> Json:
    return {"time": course.times, "value": course.value, "low": course.low, "high": course.high}


def _ridge_json(mode: ModeInDecay) -> Json:
    skeleton = mode.skeleton
    every = slice(None, None, max(len(skeleton.time) // RIDGE_SAMPLES, 1))
    return {
        "window": skeleton.window,
        "time": skeleton.time[every],
        "amplitude": skeleton.amplitude[every],
        "frequency": mode.ridge_freq[every],
        "damping_ratio": skeleton.damping_ratio[every],
    }


def _cause_json(cause: Cause) -> Json:
    law = None if cause.law is None else {"of": cause.law.of, "power": cause.law.power}
    return {"verdict": cause.verdict, "probabilities": cause.probabilities, "law": law}


def _dashpot_json(mode: ModeInDecay, mass: float) -> Json:
    """c(t) of an oscillator of that mass, N s/m, by the three weighted terms."""
    course = mode.damping
    omega = 2.0 * np.pi * mode.frequency.at(course.times)
    stiffness = mass * float(np.mean(omega)) ** 2
    value, low, high = (
        three_terms(ratio, omega, mass, stiffness).dashpot for ratio in (course.value, course.low, course.high)
    )
    return {"unit": "N s/m", "time": course.times, "value": value, "low": low, "high": high}


def _sleeve_json(damping: SleeveDamping, sleeve: str) -> Json:
    return {
        "name": sleeve,
        "unit": "N s/m",
        "time": damping.times,
        "value": damping.value,
        "low": damping.low,
        "high": damping.high,
        "most_telling_mode": damping.most_telling,
        "contradicted": damping.contradicted,
        "effect": {"times": damping.effect.times, "values": damping.effect.values},
    }


def _draw(found: Identification, decays: Decays, stage: Path) -> None:
    folder, unit = stage / "figures", unit_of(decays.channels.quantities[0])
    save(spectrum_figure(found, found.decays[0], decays.channels.name, unit), folder, "modes")
    for d, m, name in names_of(len(found.decays), len(found.decays[0].modes)):
        decay = found.decays[d]
        mode = decay.modes[m]
        shown = scalogram_of(mode, decay.fs)
        which = f"decay {d + 1} from {decay.start:.3g} s, " if len(found.decays) > 1 else ""
        title = f"{decays.channels.name}: {which}mode {m + 1}, {mode.natural_freq:.4g} Hz"
        save(mode_figure(mode, shown, title, unit), folder, name)
