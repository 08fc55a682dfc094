"""How close a model comes to the tests that it was not made with: modes, and the FRF's errors at eight points."""

from dataclasses import dataclass, replace

import numpy as np

from identification.metrics import channel_csac, channel_csf, csac, csf, frac, mac, mre, nrmse, rmse
from models.arrays import FloatArray
from models.plant import Plant
from models.record import Record
from models.rig import Rig
from models.simulate import simulate
from testbed.article.bench import BenchTest
from testbed.article.reading import Frfs, TappedModes, frfs_of, tapped_modes

FOURTH = (170.0, 200.0)
"""Hz, about the fourth mode."""

FRF_UP_TO = 200.0
"""Hz, to which the article's figures and errors reach: a little above the fourth mode."""


@dataclass(frozen=True, eq=False)
class Measured:
    """What is read of a test, once for all models.

    Attributes:
        rig: as its owner describes it.
        test: the records.
        modes: from the taps.
        frfs: from the multisine, up to ``FRF_UP_TO``.
    """

    rig: Rig
    test: BenchTest
    modes: TappedModes
    frfs: Frfs


@dataclass(frozen=True, eq=False)
class Judged:
    """One model on one test.

    Attributes:
        natural_freqs: (4,) of the model, Hz, read like those of the test.
        freq_errors: (4,) relative to the test.
        mac: (4,).
        damping_ratios: (4,) means over the test.
        mre, rmse, frac, csf, csac: (n_sensors,) of the FRF; rmse in the FRF's unit.
        mre_fourth: mean over the sensors of the relative error of the FRF in ``FOURTH``.
        nrmse: of the time histories of the multisine.
        frfs: of the model.
        csac_over, csf_over: (n_lines,) over all points, by frequency.
    """

    natural_freqs: FloatArray
    freq_errors: FloatArray
    mac: FloatArray
    damping_ratios: FloatArray
    mre: FloatArray
    rmse: FloatArray
    frac: FloatArray
    csf: FloatArray
    csac: FloatArray
    mre_fourth: float
    nrmse: float
    frfs: Frfs
    csac_over: FloatArray
    csf_over: FloatArray


def measured(rig: Rig, test: BenchTest) -> Measured:
    """Read a test.

    Args:
        rig: as its owner describes it.
        test: the records.

    Raises:
        DivergenceError: the modes do not stand out after every tap.
    """
    return Measured(rig, test, tapped_modes(test.taps, rig), _seen(frfs_of(test.struck)))


def judged(plant: Plant, seen: Measured) -> Judged:
    """Predict a test and compare.

    Args:
        plant: the model.
        seen: the test.

    Raises:
        DivergenceError: the motion left the finite numbers.
    """
    taps, struck = (_predicted(plant, record) for record in (seen.test.taps, seen.test.struck))
    modes, frfs = tapped_modes(taps, seen.rig), _seen(frfs_of(seen.test.struck, struck.responses))
    pair = frfs.h1, seen.frfs.h1
    fourth = (frfs.frequency >= FOURTH[0]) & (frfs.frequency <= FOURTH[1])
    return Judged(
        natural_freqs=modes.mean_freqs,
        freq_errors=modes.mean_freqs / seen.modes.mean_freqs - 1.0,
        mac=np.diag(mac(modes.mean_shapes, seen.modes.mean_shapes)),
        damping_ratios=np.asarray(modes.damping_ratios.mean(axis=0)),
        mre=mre(*pair),
        rmse=rmse(*pair),
        frac=frac(*pair),
        csf=channel_csf(*pair),
        csac=channel_csac(*pair),
        mre_fourth=float(mre(frfs.h1[:, fourth], seen.frfs.h1[:, fourth]).mean()),
        nrmse=nrmse(struck.responses, seen.test.struck.responses),
        frfs=frfs,
        csac_over=csac(*pair),
        csf_over=csf(*pair),
    )


def _predicted(plant: Plant, record: Record) -> Record:
    return replace(record, responses=simulate(plant, record).channels)


def _seen(frfs: Frfs) -> Frfs:
    lines = frfs.frequency <= FRF_UP_TO
    return Frfs(frfs.frequency[lines], frfs.h1[:, lines])
