"""The profile along the beam: where one force, free in time, explains most of what the calibrated model leaves.

First with the motion that free forces at the laws' places give; then, where the best place or channel is another, once
more with a force there while the motion is found, and with the rig's toleranced numbers that go with it (a calibration
without the force has bent them), or without listening to the channel. What this rests on: the
structure is the calibrated one but for its toleranced numbers; a law acts along the motion that the channels tell, by
whose uncertainty its force is uncertain too, as noise that knows nothing of the channels'; and a force at one place
bends the beam as its modes and the static shapes of the laws' places can.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import fft

from identification.evaluate import Evaluator
from identification.evidence import LEAST_EVIDENCE
from identification.hypothesis import Hypothesis, at_coordinates, rig_unknowns
from identification.locating.beside import BesideRun, runs_beside
from identification.locating.lines import Balance
from identification.locating.located import FreedChannel, Located, PlacedForce
from identification.locating.shape import shape_of
from identification.locating.weigh import Weighed, weigh
from identification.parallel import in_threads
from models.arrays import FloatArray
from models.rig import Beam

POSITIONS = 30
"""Of the profile, evenly along the beam, besides the laws' places."""

FINER = 4
"""Points between two positions about the best."""

AT_NOISE = 1.15
"""Residual over noise at which nothing is left to explain: the noise itself is known to about a tenth."""

FALL = 2.0
"""Of the logarithm of the evidence, at the ends of the interval."""


def locate(
    evaluator: Evaluator, hypothesis: Hypothesis, runs: Sequence[BesideRun] | None = None, seed: int = 0
) -> Located | None:
    """Where the force acts that the calibrated model lacks, and its shape.

    Args:
        evaluator: records, with the noise of each line.
        hypothesis: the calibrated model.
        runs: the records beside the model's own runs of them, if they are at hand.
        seed: of the draws of the motion.

    Returns:
        None without time records, on an oscillator, and where no two channels are in all records.

    Raises:
        DivergenceError: the model's motion left the finite numbers.
    """
    structure, timed = hypothesis.rig.structure, evaluator.timed
    every = dict.fromkeys(name for target in timed for name in target.record.sensors)
    names = tuple(name for name in every if all(name in target.record.sensors for target in timed))
    if not timed or not isinstance(structure, Beam) or len(names) < LEAST_CHANNELS:
        return None
    if any(target.record.sensors != names for target in timed):
        evaluator, runs = evaluator.with_targets([target.only(names) for target in timed]), None
    search = _Search(evaluator, hypothesis, seed, names)
    first = search.profile(runs if runs is not None else runs_beside(evaluator, hypothesis))
    if np.sqrt(first.weighed.nothing) <= AT_NOISE or first.best_evidence < LEAST_EVIDENCE:
        return _nothing(first)
    found = search.channel(first) if first.is_channel else search.place(first)
    suspicious = max(channel.explained for channel in first.channels) > SUSPICIOUS
    if not found.enough and (suspicious or first.is_channel):
        other = search.place(first) if first.is_channel else search.channel(first)
        found = other if other.left < BETTER * found.left else found
    return found


LEAST_CHANNELS = 2

SUSPICIOUS = 0.3
"""Share that a channel's signal explains at first, from which it is tried beside a force that is not enough."""

BETTER = 0.7
"""What another kind of explanation must leave, as a share, to be told instead of that with the better evidence."""


@dataclass(frozen=True, eq=False)
class _Profile:
    """What was weighed, and with what.

    Attributes:
        runs: the records.
        balances: their force balances.
        positions: (n_positions,) ascending.
        names: of the channels.
        weighed: positions first, then channels.
    """

    runs: tuple[BesideRun, ...]
    balances: tuple[Balance, ...]
    positions: FloatArray
    names: tuple[str, ...]
    weighed: Weighed

    @property
    def along(self) -> FloatArray:
        """(n_positions,) log evidence in units of what the best leaves."""
        scale = max(1.0, float(self.weighed.left[: len(self.positions)].min()))
        return np.asarray(self.weighed.evidence[: len(self.positions)] / scale)

    @property
    def best_evidence(self) -> float:
        """Of the best of all ways."""
        return float(self.weighed.evidence.max() / max(1.0, self.weighed.left.min()))

    @property
    def best(self) -> int:
        """The best position."""
        return int(np.argmax(self.along))

    @property
    def is_channel(self) -> bool:
        """Whether a channel's signal is the best of all ways."""
        return bool(np.argmax(self.weighed.evidence) >= len(self.positions))

    @property
    def explained(self) -> FloatArray:
        """(n_ways,) share of the misfit beyond the noise."""
        return _share(self.weighed.nothing, self.weighed.left)

    @property
    def channels(self) -> tuple[FreedChannel, ...]:
        """What each channel's own signal would explain."""
        n, left = len(self.positions), np.sqrt(self.weighed.left)
        rows = enumerate(self.names, start=n)
        return tuple(FreedChannel(name, float(self.explained[i]), float(left[i])) for i, name in rows)

    def peak(self) -> tuple[float, tuple[float, float]]:
        """The most likely position and its interval, by a parabola through the best three."""
        x, e, i = self.positions, self.along, self.best
        if 0 < i < len(x) - 1:
            bend, slope, _ = np.polyfit(x[i - 1 : i + 2] - x[i], e[i - 1 : i + 2] - e[i], 2)
            if bend < 0.0:
                top = float(np.clip(x[i] - slope / (2.0 * bend), x[i - 1], x[i + 1]))
                half = float(np.sqrt(FALL / -bend))
                if half < min(x[i + 1] - x[i], x[i] - x[i - 1]):
                    return top, (top - half, top + half)
        inside = np.flatnonzero(e > e[i] - FALL)
        low, high = max(int(inside[0]) - 1, 0), min(int(inside[-1]) + 1, len(x) - 1)
        return float(x[i]), (float(x[low]), float(x[high]))


class _Search:
    """Rounds of the profile."""

    def __init__(self, evaluator: Evaluator, hypothesis: Hypothesis, seed: int, names: tuple[str, ...]) -> None:
        structure = hypothesis.rig.structure
        assert isinstance(structure, Beam)
        self.evaluator, self.hypothesis, self.seed, self.names = evaluator, hypothesis, seed, names
        self.step = structure.length / POSITIONS
        self.unknowns = rig_unknowns(hypothesis.rig)
        self.grid = self.step * np.arange(1, POSITIONS + 1)

    def profile(self, runs: Sequence[BesideRun], *, channels: bool = True) -> _Profile:
        """Of all positions and channels, or of every other position alone."""
        balances = self.balances(runs)
        laws = {place for run in runs for place in run.places if place is not None}
        grid = self.grid if channels else self.grid[1::2]
        positions = np.array(sorted({*grid.tolist(), *laws}))
        weighed = self.weighed(balances, positions.tolist(), channels=channels)
        return _Profile(tuple(runs), balances, positions, self.names, weighed)

    def balances(self, runs: Sequence[BesideRun]) -> tuple[Balance, ...]:
        """Of each record, with draws of its own."""
        draws = np.random.default_rng(self.seed).spawn(len(runs))
        return tuple(in_threads(self.evaluator.jobs, Balance, runs, draws))

    def weighed(self, balances: Sequence[Balance], positions: Sequence[float], *, channels: bool = False) -> Weighed:
        """A force at each of some positions, m, and a signal on each channel where those are asked for."""
        lines = in_threads(self.evaluator.jobs, lambda balance: balance.lines(positions, channels=channels), balances)
        return weigh(lines, self.evaluator.jobs)

    def finer(self, profile: _Profile, about: float, step: float) -> _Profile:
        """Of positions about one alone."""
        laws = {place for run in profile.runs for place in run.places if place is not None}
        near = {x for x in laws if abs(x - about) <= step * FINER}
        grid = about + step * np.arange(-FINER, FINER + 1)
        inside = {
            float(x) for x in grid if 0.0 < x <= self.grid[-1] + 1e-9 and all(abs(x - y) > 0.3 * step for y in near)
        }
        positions = sorted({*near, *inside})
        return replace(profile, positions=np.array(positions), weighed=self.weighed(profile.balances, positions))

    def place(self, first: _Profile) -> Located:
        """The most likely place, found with a force there unless a law acts there anyway."""
        near = self.finer(first, float(first.positions[first.best]), self.step / FINER)
        profile, here = first, self._law_at(near)
        if not here or not _is_enough(first.weighed.nothing, float(np.sqrt(near.weighed.left[near.best]))):
            about = near.peak()[0]
            better = at_coordinates(self.hypothesis, self.unknowns, near.weighed.numbers[near.best])
            runs = runs_beside(self.evaluator, better, probe=None if here else about)
            profile = self.profile(runs, channels=False)
            near = self.finer(profile, about, 0.5 * self.step / FINER)
        last = self.finer(profile, near.peak()[0], self.step / FINER**2)
        return self._located(first, profile, last)

    def _law_at(self, near: _Profile) -> bool:
        best = float(near.positions[near.best])
        return any(place is not None and abs(place - best) < 1e-9 for run in near.runs for place in run.places)

    def _located(self, first: _Profile, profile: _Profile, last: _Profile) -> Located:
        place, interval = last.peak()
        i = last.best
        left = float(np.sqrt(last.weighed.left[i]))
        enough, share = _is_enough(first.weighed.nothing, left), float(_share(first.weighed.nothing, left**2))
        explained = _share(first.weighed.nothing, profile.weighed.left[: len(profile.positions)])
        alike = profile.positions[explained > share - (1.0 - OWN_SHARE)]
        ends = (*self._widened(last, place, interval), *alike.tolist())
        interval = min(ends), max(ends)
        low, high = (end + side * NEAR * self.step for end, side in zip(interval, (-1.0, 1.0), strict=True))
        contacts = (c for c in first.runs[0].plant.contacts if c.position is not None)
        inside = [(abs(c.position - place), c.sleeve) for c in contacts if c.position and low <= c.position <= high]
        sleeve = min(inside, default=(0.0, None))[1]
        forces = tuple(_force_in(run, last, k, i) for k, run in enumerate(profile.runs))
        centre = next((c.offset for c in first.runs[0].plant.contacts if c.sleeve == sleeve), None)
        found = Located(
            positions=profile.positions,
            explained=explained,
            channels=first.channels,
            nothing=float(np.sqrt(first.weighed.nothing)),
            left=left,
            place=place,
            interval=interval,
            sleeve=sleeve,
            sensor=None,
            share=share,
            enough=enough,
            words="",
            forces=forces,
            shape=shape_of(forces, centre),
        )
        return replace(found, words=_in_words(found))

    def _widened(self, last: _Profile, place: float, interval: tuple[float, float]) -> tuple[float, float]:
        """The interval with the places that the records, or the parts of one, tell each by itself."""
        lines = [balance.lines(last.positions.tolist(), channels=False) for balance in last.balances]
        parts = lines if len(lines) > 1 else lines[0].parted()
        peaks = in_threads(self.evaluator.jobs, lambda part: replace(last, weighed=weigh([part])).peak()[0], parts)
        spread = float(np.sqrt(np.mean((np.array(peaks) - place) ** 2)))
        return min(interval[0], place - spread), max(interval[1], place + spread)

    def channel(self, first: _Profile) -> Located:
        """What is left of the others when the most suspicious channel is not listened to."""
        n = len(first.positions)
        name = self.names[int(np.argmax(first.weighed.evidence[n:]))]
        others = self.balances(runs_beside(self.evaluator, self.hypothesis, unheard=name))
        nothing = self.weighed(others, self.grid[-1:].tolist()).nothing
        left = float(np.sqrt(nothing * len(self.names) / (len(self.names) - 1)))
        enough, share = _is_enough(first.weighed.nothing, left), float(_share(first.weighed.nothing, left**2))
        found = replace(_nothing(first), left=left, sensor=name, share=share, enough=enough)
        return replace(found, words=_in_words(found))


NEAR = 0.1
"""Share of the distance of two positions of the profile within which places are one."""


def _is_enough(nothing: float, left: float) -> bool:
    """The noise is reached, or what is left is what the method itself leaves of a true point force."""
    return left <= AT_NOISE or bool(_share(nothing, left**2) > OWN_SHARE)


OWN_SHARE = 0.98
"""Share of the misfit beyond the noise: linear tolerances and a few turns leave up to 2 % of a true force's. Places
that explain as much but for these 2 % are not told apart."""


def _share(nothing: float, left: FloatArray | float) -> FloatArray:
    """Share of the misfit beyond the noise that is gone."""
    gone = (nothing - np.maximum(left, 1.0)) / max(nothing - 1.0, np.finfo(float).tiny)
    return np.asarray(np.clip(gone, 0.0, 1.0))


def _nothing(first: _Profile) -> Located:
    ratio = float(np.sqrt(first.weighed.nothing))
    return Located(
        positions=first.positions,
        explained=first.explained[: len(first.positions)],
        channels=first.channels,
        nothing=ratio,
        left=ratio,
        place=None,
        interval=None,
        sleeve=None,
        sensor=None,
        share=0.0,
        enough=ratio <= AT_NOISE,
        words=_balanced(ratio, _missed_by(first.runs)),
        forces=(),
        shape=None,
    )


def _missed_by(runs: Sequence[BesideRun]) -> float:
    """What the model's own runs leave of the records, over the noise."""
    return float(np.sqrt(np.mean(np.concatenate([(np.abs(run.gap.T) ** 2 / run.variance).ravel() for run in runs]))))


def _balanced(ratio: float, misfit: float) -> str:
    """What is said where no place explains more than none: nothing is missing, or it is unseen, or not at one place.

    Args:
        ratio: what the balance of forces leaves, over its noise.
        misfit: what the model leaves of the records, over theirs.
    """
    if ratio > AT_NOISE:
        hardly = "with a force at one place hardly better"
        return f"no place is told: the forces balance to {ratio:.2f} times the noise, {hardly}"
    if misfit <= MISSED * AT_NOISE:
        return f"no force is missing: the forces balance to {ratio:.2f} times the noise"
    return (
        f"no place is told: the model misses the records by {misfit:.2g} times their noise, but the balance of forces, "
        "its toleranced numbers free and the motion known through the channels alone, holds to "
        f"{ratio:.2f} times its own noise: what is missing is hidden there, or neighbouring motions part"
    )


MISSED = 2.0
"""Times what is nothing to explain, from which a model misses records whatever their noise may be."""


def _force_in(run: BesideRun, last: _Profile, record: int, way: int) -> PlacedForce:
    place = min(run.places, key=lambda x: abs((x or 0.0) - last.positions[way]))
    port = run.port_of(place)
    spectrum = np.zeros(run.record.n_samples // 2 + 1, complex)
    lines = last.weighed.forces[record][:, way]
    spectrum[: len(lines)] = lines
    motion = run.recorded(np.stack([run.settled.q[port], run.settled.v[port]]))
    force = np.asarray(fft.irfft(spectrum, run.record.n_samples))
    return PlacedForce(run.record.name, run.record.fs, motion[0], motion[1], force, last.weighed.told[record][:, way])


LEAST_SHARE = 0.05
"""Of the misfit beyond the noise, below which a force at a place explains nothing of it."""


def _in_words(found: Located) -> str:
    over = f"{found.left:.2g} times the noise is left of {found.nothing:.2g}"
    if found.sensor is not None:
        verdict = "in the measurement" if found.enough else "not in the measurement alone"
        return f"{verdict}: without {found.sensor}, {over}"
    assert found.place is not None
    assert found.interval is not None
    at = f"{found.place:.4f} m from the clamp ({found.interval[0]:.4f} to {found.interval[1]:.4f} m)"
    at = f"{found.sleeve}, {at}" if found.sleeve else at
    if found.share < LEAST_SHARE:
        return (
            "no place explains it: free in time, one force at the likeliest, "
            f"{at}, leaves {found.left:.2g} times the noise where {found.nothing:.2g} were"
        )
    if found.enough:
        return f"one force at {at} explains {found.share:.0%} of the misfit beyond the noise: {over}"
    return (
        "not one point force: distributed, structural, at two places, or in the measurement; the nearest to it is "
        f"one force at {at}, which explains {found.share:.0%} of the misfit beyond the noise: {over}"
    )
