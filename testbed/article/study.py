"""The whole study: the rig, its tests, three models of it, and what they are good for."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from identification.diagnose import MOST_EFFECTS
from identification.progress import Progress
from testbed.article.campaign import Order, campaign
from testbed.article.compared import Compared, compared
from testbed.article.probability import probability
from testbed.article.published import PrintedTest, published
from testbed.article.reading import tapped_modes
from testbed.article.rig import CALIBRATED_AT, Drive, Geometry, at_rest, calibrated, natural_freqs
from testbed.article.sines_run import all_sines
from testbed.article.slews_run import all_slews
from testbed.article.strikes import Strikes, strikes
from testbed.article.tables import JUDGE
from testbed.article.three_models import KEPT, ThreeModels, three_models
from testbed.article.uncertain import SAMPLES
from testbed.outputs import Json

DRIVES: tuple[Drive, ...] = ("table", "force")


@dataclass(frozen=True)
class Extent:
    """How much of the study is done.

    Attributes:
        clearances: m.
        judges: engines that carry out the table test; the force test is by the first.
        most_effects: that the diagnosis may add.
        samples: of every condition of the probabilistic study.
    """

    clearances: tuple[float, ...]
    judges: tuple[str, ...]
    most_effects: int
    samples: int


def whole_extent() -> Extent:
    """All of it."""
    return Extent(tuple(test.clearance for test in published()), (JUDGE, "exudyn"), MOST_EFFECTS, SAMPLES)


def quick_extent() -> Extent:
    """At the clearance of calibration, by one engine, and with a diagnosis that calibrates alone."""
    return Extent((CALIBRATED_AT,), (JUDGE,), 0, SAMPLES // 10)


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


@dataclass(frozen=True, eq=False)
class ArticleStudy:
    """Results.

    Attributes:
        extent: what was asked for.
        geometry: calibrated.
        rests: one a clearance.
        tests: one a clearance and drive.
        sines: one a clearance, as ``sines_run.all_sines`` gives them.
        models: by clearance, m.
        compared: one a clearance.
        probability: at the clearance of calibration.
        slews: one a clearance.
    """

    extent: Extent
    geometry: Geometry
    rests: tuple[AtRest, ...]
    tests: tuple[Strikes, ...]
    sines: tuple[Json, ...]
    models: Mapping[float, ThreeModels]
    compared: tuple[Compared, ...]
    probability: Json
    slews: tuple[Json, ...]

    @property
    def printed(self) -> tuple[PrintedTest, ...]:
        """The article's tests at these clearances."""
        return tuple(test for test in published() if test.clearance in self.extent.clearances)


def article_study(out: Path, progress: Progress, extent: Extent, jobs: int) -> ArticleStudy:
    """Calibrate the rig, test it on the virtual bench, make three models of it and judge them, then use them.

    Args:
        out: folder of the results, where long tests are kept as they are done.
        progress: told what is being done.
        extent: how much of it.
        jobs: processes and threads.

    Raises:
        DivergenceError: a motion left the finite numbers.
        InputError: a package of the probabilistic study is not installed.
    """
    progress("calibrating the assumed geometry to the frequencies at 0.5 mm")
    geometry, clearances = calibrated(), extent.clearances
    printed = {test.clearance: test for test in published()}
    forced = {clearance: Order(clearance, "force", extent.judges[0]) for clearance in clearances}
    tables = {clearance: [Order(clearance, "table", engine) for engine in extent.judges] for clearance in clearances}
    orders = [*forced.values(), *(order for row in tables.values() for order in row)]
    tests = campaign(geometry, orders, out, jobs, progress)
    models: dict[float, ThreeModels] = {}
    for clearance in sorted(clearances, key=lambda value: value != CALIBRATED_AT):
        progress(f"three models at {1e3 * clearance:g} mm")
        found = models[CALIBRATED_AT].found if models else None
        models[clearance] = three_models(
            geometry.rig(clearance, "force"),
            tests[forced[clearance]],
            found,
            extent.most_effects,
            out / KEPT / f"{1e3 * clearance:g}-mm",
            jobs,
            progress,
        )
    models = {clearance: models[clearance] for clearance in clearances}
    progress("judging the models by the table tests")
    judged = tuple(
        compared(geometry, clearance, models[clearance], {order.engine: tests[order] for order in tables[clearance]})
        for clearance in clearances
    )
    middle = next(found for found in judged if found.clearance == CALIBRATED_AT)
    given = geometry.rig(CALIBRATED_AT, "force")
    odds = probability(
        given,
        models[CALIBRATED_AT],
        tapped_modes(tests[forced[CALIBRATED_AT]].taps, given),
        middle.seen[JUDGE],
        out,
        jobs,
        progress,
        extent.samples,
    )
    slews = tuple(all_slews(geometry, models, extent.judges, out, jobs, progress))
    progress(f"striking the sleeves in {len(clearances) * len(DRIVES)} tests")
    return ArticleStudy(
        extent,
        geometry,
        tuple(_rest(geometry, clearance, printed[clearance].measured_freqs) for clearance in clearances),
        tuple(strikes(geometry, clearance, drive) for drive in DRIVES for clearance in clearances),
        tuple(all_sines(geometry, clearances, extent.judges, out, progress)),
        models,
        judged,
        odds,
        slews,
    )


def _rest(geometry: Geometry, clearance: float, measured: tuple[float, ...]) -> AtRest:
    rig = geometry.rig(clearance, "force")
    penetrations = at_rest(rig).rest.penetration
    return AtRest(clearance, tuple(natural_freqs(rig).tolist()), measured, tuple(penetrations.tolist()))
