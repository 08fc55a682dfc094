"""A comparison as ``compare.json``."""

from identification.metrics import BAND_LINES, channel_csac, channel_csf, frac, mre, nrmse, overall_nrmse
from identification.result import RecordScore
from models.arrays import FloatArray
from models.rig import quantities_of
from testbed.compare import Comparison, FrfPair, ModePair
from testbed.outputs import Json


def comparison_json(comparison: Comparison) -> Json:
    """The content of ``compare.json``.

    The overall figures are those of the time records, or of the FRFs where there is no time record; what a record does
    not tell (the noise of FRFs, the FRFs of a free decay) is null. Findings are those of the comparison.

    Args:
        comparison: finished.
    """
    pairs = {pair.record: pair for pair in comparison.frfs}
    timed = comparison.score.records if comparison.score is not None else ()
    names = {row.record.name for row in timed}
    linear = [_frf_row(pair, comparison) for pair in comparison.frfs if pair.record not in names]
    return {
        "nrmse": comparison.score.nrmse if comparison.score is not None else _overall(linear),
        "noise_nrmse": comparison.score.noise_nrmse if comparison.score is not None else None,
        "records": [
            *(_time_row(row, pairs.get(row.record.name)) for row in timed),
            *linear,
            *(_modes_row(pair) for pair in comparison.modes),
        ],
        "findings": list(comparison.findings),
    }


def _overall(rows: list[Json]) -> float | None:
    return overall_nrmse([row["nrmse"] for row in rows]) if rows else None


def _time_row(row: RecordScore, pair: FrfPair | None) -> Json:
    figures = _frf_figures(pair) if pair is not None else [_NO_FIGURES] * len(row.record.sensors)
    columns = zip(row.record.sensors, row.channel_nrmse, row.channel_noise_nrmse, figures, strict=True)
    channels = [{"sensor": name, "nrmse": error, "noise_nrmse": noise, **more} for name, error, noise, more in columns]
    return {"record": row.record.name, "nrmse": row.nrmse, "noise_nrmse": row.noise_nrmse, "channels": channels}


def _frf_row(pair: FrfPair, comparison: Comparison) -> Json:
    errors = [nrmse(*rows) for rows in zip(pair.predicted, pair.measured, strict=True)]
    columns = zip(pair.sensors, errors, _frf_figures(pair), strict=True)
    channels = [{"sensor": name, "nrmse": error, "noise_nrmse": None, **more} for name, error, more in columns]
    whole = nrmse(pair.predicted, pair.measured, quantities_of(comparison.sensors, pair.sensors))
    return {"record": pair.record, "nrmse": whole, "noise_nrmse": None, "channels": channels}


_NO_FIGURES: Json = {"mre": None, "frac": None, "csac": None, "csf": None}


def _frf_figures(pair: FrfPair) -> list[Json]:
    """The correlation figures of each sensor's FRF; the band of CSAC and CSF narrows where there are few lines."""
    n_lines = len(pair.frequency)
    if n_lines < 2:
        return [_NO_FIGURES] * len(pair.sensors)
    band, columns = min(BAND_LINES, n_lines), (pair.predicted, pair.measured)
    figures: dict[str, FloatArray] = {
        "mre": mre(*columns),
        "frac": frac(*columns),
        "csac": channel_csac(*columns, n_band=band),
        "csf": channel_csf(*columns, n_band=band),
    }
    return [{name: float(values[i]) for name, values in figures.items()} for i in range(len(pair.sensors))]


def _modes_row(pair: ModePair) -> Json:
    measured_damping = pair.measured_damping if pair.measured_damping is not None else [None] * len(pair.mac)
    columns = zip(pair.measured_freqs, pair.model_freqs, measured_damping, pair.model_damping, pair.mac, strict=True)
    keys = ("measured_freq", "model_freq", "measured_damping_ratio", "model_damping_ratio", "mac")
    modes = [dict(zip(keys, column, strict=True)) for column in columns]
    return {"record": pair.record, "nrmse": None, "noise_nrmse": None, "channels": [], "modes": modes}
