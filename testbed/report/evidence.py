"""What speaks for a verdict: the rivals in two sentences, and the one picture that shows it."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from scipy.signal import welch

from identification.locating.located import Located
from identification.result import Diagnosis, RecordScore, Stage
from models.arrays import ComplexArray, FloatArray
from models.band_limit import SCORE_EDGE
from models.effects import Effect
from models.rig import Rig
from testbed.figures.report_evidence import Left, plot_left_by_frequency, plot_left_over_time, plot_ratios
from testbed.figures.report_style import COLOURS
from testbed.quantities import unit_of
from testbed.report.fall import where_it_falls
from testbed.report.figures import WIDTH
from testbed.report.picture import Picture, picture
from testbed.report.words import error_of, number, percent, stage_kind

DECISIVE = 5.0
"""Difference of log evidence from which a rival is out."""


def because(diagnosis: Diagnosis) -> str:
    """Why the verdict names what it names, against the best that it does not name; empty where nothing was weighed."""
    if not diagnosis.candidates:
        return ""
    if diagnosis.verdict != "missing_effect":
        best = diagnosis.candidates[0]
        return (
            f"Of {len(diagnosis.candidates)} suspects the best, {best.effect.label()}, would miss "
            f"{error_of(best)} of the records it was weighed on."
        )
    first = diagnosis.added[0]
    chosen = next((each for each in diagnosis.candidates if _same(each.effect, first.effect)), None)
    shown = (_shows(first.effect), _shown_here(first.effect, diagnosis.located), where_it_falls(diagnosis))
    shows = " ".join(sentence for sentence in shown if sentence)
    if chosen is None:
        return shows
    alike = next((group for group in diagnosis.indistinguishable if any(_same(e, first.effect) for e in group)), ())
    rivals = [c for c in diagnosis.candidates if c is not chosen and not any(_same(c.effect, e) for e in alike)]
    if not rivals:
        return shows
    rival = max(rivals, key=lambda each: (each.refitted, each.log_evidence))  # the beginning alone says less
    behind = chosen.log_evidence - rival.log_evidence
    how = "decisively" if behind > DECISIVE else "not decisively"
    others = f" beside {beside(diagnosis)}" if diagnosis.candidates_beside else ""
    return (
        f"{shows} With {first.effect.label()}{others} the model misses {percent(chosen.nrmse)} of the records it was "
        f"weighed on; the next best, {rival.effect.label()}, misses {error_of(rival)} and stands "
        f"{number(float(f'{behind:.2g}'))} behind in log evidence, {how}."
    )


def beside(diagnosis: Diagnosis) -> str:
    """What the candidates were judged beside last, besides the calibrated rig; empty for nothing."""
    return " and ".join(effect.label() for effect in diagnosis.candidates_beside)


def _same(one: Effect, other: Effect) -> bool:
    return one.label() == other.label()


def _shows(effect: Effect) -> str:
    """Where an effect of this kind shows in any data."""
    about = effect.signature
    return f"What gives {effect.kind} away in general: in frequency, {about.frequency}; by place, {about.place}."


def _shown_here(effect: Effect, located: Located | None) -> str:
    """Whether the place that the records tell without assuming a law is the effect's."""
    position = effect.place.position
    if position is None or located is None or located.interval is None or not located.where:
        return "Whether these records show its place was not judged; what speaks for it here is the error."
    low, high = located.interval
    where = f"the missing force at {low:.4g} to {high:.4g} m"
    if located.holds(position):
        return f"Of that these records show the place: without assuming a law they put {where}."
    return f"These records do not show it by place: without assuming a law they put {where}."


def evidence_picture(diagnosis: Diagnosis, rig: Rig, place: Picture | None) -> Picture | None:
    """The picture that shows why: of a channel, a line, a course in time, or a place.

    Args:
        diagnosis: finished.
        rig: as its owner describes it.
        place: of the missing force, where it was located; for a named effect only where it sits there.

    Returns:
        None where no time record was learnt from, or where the place alone could show it and was not found.
    """
    if not diagnosis.final.score.records:
        return None
    if diagnosis.verdict == "unexplained":
        return place
    if diagnosis.verdict == "complete":
        return left_picture(diagnosis, rig)
    effect = diagnosis.added[0].effect
    if effect.family == "measurement" and not effect.record_parameters:
        return channel_picture(diagnosis, effect)
    position, located = effect.place.position, diagnosis.located
    if position is None or effect.family == "time" or (located is not None and not located.holds(position)):
        return left_picture(diagnosis, rig)
    return place


def left_picture(diagnosis: Diagnosis, rig: Rig) -> Picture:
    """What the models leave of the channel that tells most, by frequency and over time, beside its noise."""
    before = diagnosis.calibrated if diagnosis.final.hypothesis.effects else diagnosis.stages[0]
    record, channel = _telling(before, diagnosis.final)
    stages = [before] if before is diagnosis.final else [before, diagnosis.final]
    rows = [stage.score.of(record) for stage in stages]
    fs, sensor = rows[0].record.fs, rows[0].record.sensors[channel]
    noise = float(rows[-1].noise.sensors[channel])
    unit = unit_of(rig.sensor(sensor).quantity)
    spectra: list[Left] = []
    courses: list[Left] = []
    for stage, row in zip(stages, rows, strict=True):
        left = row.record.responses[channel] - row.predicted[channel]
        frequency, power = welch(left, fs, nperseg=min(len(left) // SEGMENTS + 1, round(WELCH_SECONDS * fs)))
        judged = frequency <= SCORE_EDGE * fs
        width = max(1, len(left) // WINDOWS)
        parts = left[: len(left) // width * width].reshape(-1, width)
        look = stage.label, COLOURS[stage_kind(diagnosis, stage)]
        spectra.append(Left(*look, np.sqrt(power[judged])))
        courses.append(Left(*look, np.sqrt(np.mean(parts**2, axis=1))))
    figure = Figure(figsize=(WIDTH, 2.9), layout="constrained")
    by_frequency, over_time = figure.subplots(1, 2, width_ratios=(1.6, 1.0))
    plot_left_by_frequency(by_frequency, frequency[judged], spectra, noise * np.sqrt(2.0 / fs), unit)
    plot_left_over_time(over_time, (np.arange(float(len(parts))) + 0.5) * width / fs, courses, noise, unit)
    figure.legend(*by_frequency.get_legend_handles_labels(), loc="outside upper center", ncols=len(stages) + 1)
    words = f"What the models leave of {sensor} in {record}"
    return picture(
        figure, words, f"{words}, the channel that tells most: by frequency, and over time. Dashed: the sensor's "
        "noise; the excitation's own, which the model carries, comes on top where the rig resonates."
    )  # fmt: skip


WELCH_SECONDS, SEGMENTS, WINDOWS = 4.0, 4, 24
"""Longest segments of a spectrum, which tell lines 0.5 Hz apart, how many there are at least, and windows over time."""


def channel_picture(diagnosis: Diagnosis, effect: Effect) -> Picture:
    """Each channel over the calibrated model, in bands of frequency: a wrong size, sign, delay or place shows at once.

    Args:
        diagnosis: finished.
        effect: of the measurement.
    """
    own = [name for name in (effect.place.sensor, effect.place.other) if name is not None]
    scores = [row for row in diagnosis.calibrated.score.records if set(own) <= set(row.record.sensors)]
    row = max(scores or diagnosis.calibrated.score.records, key=lambda each: float(np.std(each.record.responses)))
    frequency, ratios = channel_ratios(row)
    names = row.record.sensors
    suspected = np.array([not own or name in own for name in names])
    figure = Figure(figsize=(WIDTH, 2.9), layout="constrained")
    magnitude, phase = figure.subplots(1, 2)
    plot_ratios((magnitude, phase), frequency, ratios, suspected, names)
    figure.legend(*magnitude.get_legend_handles_labels(), loc="outside upper center", ncols=8)
    of = " and ".join(own) if own else "every channel"
    grey = "" if suspected.all() else " Grey: the other channels, which the same model meets."
    return picture(
        figure, f"Measured over calibrated model, {of}",
        f"{row.record.name}: {of} over the calibrated model, in bands of frequency that hold signal.{grey}",
    )  # fmt: skip


def channel_ratios(row: RecordScore) -> tuple[FloatArray, ComplexArray]:
    """Transfer from the model's channels to the measured ones, by least squares in bands of frequency.

    Args:
        row: one record against one model.

    Returns:
        (n_bands,) middles, Hz, and (n_channels, n_bands) ratios, NaN where a channel holds next to nothing.
    """
    n = row.record.n_samples
    frequency = np.fft.rfftfreq(n, 1.0 / row.record.fs)
    window = np.hanning(n)
    measured, model = np.fft.rfft(window * row.record.responses), np.fft.rfft(window * row.predicted)
    power, common = np.abs(model) ** 2, np.conj(model) * measured
    heard = power.sum(axis=0) > 0.0
    top = frequency[heard][np.searchsorted(np.cumsum(power.sum(axis=0)[heard]), MOST_OF_IT * power.sum())]
    edges = np.searchsorted(frequency, np.linspace(0.0, top, BANDS + 1))
    starts = np.unique(edges[:-1])
    stop = max(int(edges[-1]), int(starts[-1]) + 1)
    sums = np.add.reduceat(power[:, :stop], starts, axis=1)
    least = QUIET * power[:, :stop].sum(axis=1, keepdims=True) / len(starts)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = np.add.reduceat(common[:, :stop], starts, axis=1) / sums
    ends = np.append(starts[1:], stop) - 1
    return 0.5 * (frequency[starts] + frequency[ends]), np.where(sums > least, ratios, np.nan)


BANDS, MOST_OF_IT, QUIET = 40, 0.999, 1e-3
"""Bands up to the frequency below which so much of the model's power lies; share of a mean band's power that counts."""


def _telling(before: Stage, after: Stage) -> tuple[str, int]:
    """Record and channel in which the fall of the error is most times the noise, or the error where nothing falls."""
    falls: Mapping[str, FloatArray] = {
        row.record.name: _in_noise(row) - (0.0 if before is after else _in_noise(after.score.of(row.record.name)))
        for row in before.score.records
    }
    name = max(falls, key=lambda each: float(falls[each].max()))
    return name, int(np.argmax(falls[name]))


def _in_noise(row: RecordScore) -> FloatArray:
    """(n_sensors,) power of the error in units of the noise's."""
    return np.asarray((row.channel_nrmse / np.maximum(row.channel_noise_nrmse, np.finfo(float).tiny)) ** 2)
