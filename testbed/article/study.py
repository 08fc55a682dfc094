"""The study as far as it goes: the rig, what the clearance does at rest, and whether the tests strike both sleeves."""

from dataclasses import dataclass
from pathlib import Path

from identification.progress import Progress
from testbed.article.published import published
from testbed.article.rig import CALIBRATED_AT, Drive, Geometry, at_rest, calibrated, natural_freqs
from testbed.article.sines_run import Json, all_sines
from testbed.article.strikes import Strikes, strikes

DRIVES: tuple[Drive, ...] = ("table", "force")


@dataclass(frozen=True)
class AtRest:
    """The rig at rest at one clearance.

    Attributes:
        clearance: m.
        natural_freqs: Hz, of small motion.
        measured_freqs: Hz, as the article printed them.
        penetrations: of the rod into each sleeve, m; negative where it does not touch.
    """

    clearance: float
    natural_freqs: tuple[float, ...]
    measured_freqs: tuple[float, ...]
    penetrations: tuple[float, ...]

    @property
    def errors(self) -> tuple[float, ...]:
        """Relative, of each frequency."""
        return tuple(ours / theirs - 1.0 for ours, theirs in zip(self.natural_freqs, self.measured_freqs, strict=True))


@dataclass(frozen=True)
class ArticleStudy:
    """Results.

    Attributes:
        geometry: calibrated.
        rests: one a clearance.
        tests: one a clearance and drive.
        sines: one a clearance, as ``sines_run.all_sines`` gives them.
    """

    geometry: Geometry
    rests: tuple[AtRest, ...]
    tests: tuple[Strikes, ...]
    sines: tuple[Json, ...]


def article_study(out: Path, progress: Progress, *, quick: bool = False) -> ArticleStudy:
    """Calibrate the rig, let it rest at the six clearances, strike its sleeves, and drive it by sines.

    Args:
        out: folder of the results, where long tests are kept as they are done.
        progress: told what is being done.
        quick: at the clearance of calibration alone.

    Raises:
        DivergenceError: the motion left the finite numbers.
    """
    progress("calibrating the assumed geometry to the frequencies at 0.5 mm")
    geometry = calibrated()
    tests = [test for test in published() if not quick or test.clearance == CALIBRATED_AT]
    clearances = [test.clearance for test in tests]
    progress(f"striking the sleeves in {len(clearances) * len(DRIVES)} tests")
    return ArticleStudy(
        geometry,
        tuple(_rest(geometry, test.clearance, test.measured_freqs) for test in tests),
        tuple(strikes(geometry, clearance, drive) for drive in DRIVES for clearance in clearances),
        tuple(all_sines(geometry, clearances, out, progress)),
    )


def _rest(geometry: Geometry, clearance: float, measured: tuple[float, ...]) -> AtRest:
    rig = geometry.rig(clearance, "force")
    penetrations = at_rest(rig).rest.penetration
    return AtRest(clearance, tuple(natural_freqs(rig).tolist()), measured, tuple(penetrations.tolist()))
