"""The free decays of one record: which stretches nothing drives, and which channels are looked at."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from identification.decay.free import NEVER_QUIET, free_stretches, quiet_and_loudest
from identification.decay.mode_search import LEAST_PERIODS
from identification.signals.peaks import LEAST_SAMPLES
from models.arrays import FloatArray
from models.errors import InputError
from models.rig import Rig
from testbed.channel_checks import check_excitation
from testbed.channels import Channels, channels_of_file, channels_with_rig

LEAST_SHARE = 0.05
"""Of a record that a stretch without a force is to fill."""

VELOCITIES = ("velocity", "angular_velocity")


@dataclass(frozen=True, eq=False)
class Decays:
    """What is identified.

    Attributes:
        channels: of the record, those asked for.
        signals: (n_channels, N) of each decay, in SI units.
        starts: s of each in the record.
        findings: what was decided and why.
    """

    channels: Channels
    signals: tuple[FloatArray, ...]
    starts: tuple[float, ...]
    findings: tuple[str, ...]

    @property
    def kick_signs(self) -> FloatArray:
        """(n_channels,) -1 for velocities, 1 for the others: see ``kick_of``."""
        return np.array([-1.0 if quantity in VELOCITIES else 1.0 for quantity in self.channels.quantities])


def decays_of(
    path: Path,
    rig: Rig | None,
    names: Sequence[str],
    *,
    excitation: str | None = None,
    without: Sequence[str] = (),
    begin: float | None = None,
    end: float | None = None,
) -> Decays:
    """Read a record and find its free decays, or take the stretch that is asked for.

    Args:
        path: the record.
        rig: whose sensors its channels are, or None.
        names: channels to look at; all of them where none is named.
        excitation: name of the excitation's channel.
        without: channels to leave out.
        begin: of the stretch, s from the record's first sample; found where no end is given either.
        end: of the stretch, s.

    Raises:
        InputError: a file that cannot be used, a channel or stretch that is not there, or a force that never rests.
    """
    if rig is not None:
        check_excitation(excitation, rig)
    channels = channels_of_file(path, excitation, without) if rig is None else channels_with_rig(path, rig, without)
    if names:
        channels = channels.only(names)
    n, fs = channels.responses.shape[1], channels.fs
    if begin is not None or end is not None:
        first, last = begin or 0.0, n / fs if end is None else end
        if not 0.0 <= first < last <= n / fs + 0.5 / fs:
            raise InputError(
                f"{path.name}: a stretch from {first:g} to {last:g} s",
                f"it begins before it ends and lies in the record, from 0 to {n / fs:g} s",
                "change --from or --to",
            )
        if round(last * fs) - round(first * fs) < LEAST_SAMPLES:
            raise _too_short(f"{path.name}: a stretch from {first:g} to {last:g} s", last - first, fs)
        return _decays(channels, [(round(first * fs), round(last * fs))], ("the stretch was named",))
    if n < LEAST_SAMPLES:
        raise _too_short(path.name, n / fs, fs)
    stretches = free_stretches(channels.excitation, channels.responses, fs, max(LEAST_SHARE * n, LEAST_SAMPLES) / fs)
    if not stretches:
        raise _never_free(path.name, channels.excitation)
    words = [f"{a / fs:.4g} to {b / fs:.4g} s" for a, b in stretches]
    return _decays(channels, stretches, (f"{len(stretches)} free decay(s): {', '.join(words)}",))


def _never_free(name: str, excitation: FloatArray | None) -> InputError:
    """Why no free decay was found: a force that never ends, or whose own noise hides where it does."""
    heard, hidden = "", ""
    if excitation is not None and (levels := quiet_and_loudest(excitation))[0] > NEVER_QUIET * levels[1]:
        heard = f": {levels[0]:.3g} rms where it is quietest, {levels[1]:.3g} where it is loudest"
        hidden = (
            f"; if it was a blow, noise on the force is what hides its end (a blow is told that stands "
            f"{1.0 / NEVER_QUIET:g} times out of it): name the time after it with --from, or strike harder"
        )
    return InputError(
        f"{name}: the excitation acts throughout{heard}",
        "frequency and damping of the rig itself show while it moves freely, for "
        f"{LEAST_SAMPLES} samples and {LEAST_SHARE:.0%} of the record at least",
        f"name a record with a free decay, or a stretch of this one with --from and --to{hidden}",
    )


def _too_short(where: str, seconds: float, fs: float) -> InputError:
    return InputError(
        f"{where}: {seconds:.4g} s, {round(seconds * fs)} samples",
        f"a decay is followed over {LEAST_SAMPLES} samples or more, {LEAST_SAMPLES / fs:.4g} s at {fs:g} Hz, and over "
        f"{LEAST_PERIODS:g} periods of its lowest mode",
        "take a longer stretch with --from and --to, record for longer, or at a higher rate",
    )


def _decays(channels: Channels, stretches: Sequence[tuple[int, int]], findings: tuple[str, ...]) -> Decays:
    signals = tuple(channels.responses[:, a:b] for a, b in stretches)
    starts = tuple(a / channels.fs for a, _ in stretches)
    return Decays(channels, signals, starts, (*channels.findings, *findings))
