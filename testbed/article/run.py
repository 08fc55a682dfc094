"""The case study over files: ``article.json``, the rig files, a page and its figures in a folder."""

import shlex
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from identification.progress import Progress
from models.errors import InputError
from models.rig_file import write_rig
from testbed.article.page import article_json, page_of
from testbed.article.rig import CALIBRATED_AT, POINTS_AT
from testbed.article.study import DRIVES, ArticleStudy, article_study, quick_extent, whole_extent
from testbed.figures.article import frequencies_figure, sines_figure
from testbed.figures.article_models import clearances_figure, correlation_figure, damping_figure, frf_figure
from testbed.figures.article_uncertain import coincidence_figure, emulator_figure, shares_figure, slews_figure
from testbed.figures.save import save
from testbed.outputs import Json, json_text, staged

NAMED_POINTS = {"P3": "clearance 1", "P5": "clearance 2", "P1": "front", f"P{len(POINTS_AT)}": "end"}
"""The four points that the article draws first."""

PACKAGES = ("SALib", "emcee", "sklearn")


def run_article(out: Path, *, command: Sequence[str], progress: Progress, jobs: int, quick: bool = False) -> Json:
    """Run the study and write it.

    Args:
        out: folder of the results.
        command: as typed, for the page.
        progress: told what is being done.
        jobs: processes and threads.
        quick: at one clearance alone, with a diagnosis that calibrates alone.

    Returns:
        the content of ``article.json``.

    Raises:
        InputError: a folder that cannot be written, or a package that is not installed.
        DivergenceError: the motion left the finite numbers.
    """
    _check_packages()
    done = article_study(out, progress, quick_extent() if quick else whole_extent(), jobs)
    content = article_json(done)
    with staged(out) as stage:
        (stage / "article.json").write_text(json_text(content), encoding="utf-8")
        (stage / "README.md").write_text(page_of(done, content, shlex.join(command)), encoding="utf-8")
        for drive in DRIVES:
            write_rig(done.geometry.rig(CALIBRATED_AT, drive), stage / f"rig_{drive}.toml")
        _draw(done, stage / "figures")
    return content


def _check_packages() -> None:
    """Before anything long begins.

    Raises:
        InputError: a package of the probabilistic part is missing.
    """
    missing = [name for name in PACKAGES if find_spec(name) is None]
    if missing:
        raise InputError(
            f"{', '.join(missing)}: not installed",
            f"the probabilistic part of the study takes {', '.join(PACKAGES)}",
            "run make once, which installs them, or in the project's folder: pip install -e '.[probability]'",
        )


def _draw(done: ArticleStudy, folder: Path) -> None:
    others = {f"P{n}": f"point {n}" for n in range(1, len(POINTS_AT) + 1) if f"P{n}" not in NAMED_POINTS}
    save(frequencies_figure(done.rests), folder, "frequencies")
    save(sines_figure(done.sines), folder, "sines")
    save(damping_figure(done.geometry, done.models), folder, "damping")
    save(clearances_figure(done.compared, NAMED_POINTS), folder, "clearances")
    save(clearances_figure(done.compared, others), folder, "clearances_others")
    for found in done.compared:
        name = f"{1e3 * found.clearance:g}-mm"
        save(frf_figure(found, NAMED_POINTS), folder, f"frf_{name}")
        for what in ("csac", "csf"):
            save(correlation_figure(found, what), folder, f"{what}_{name}")
    save(coincidence_figure(done.probability), folder, "coincidence")
    save(shares_figure(done.probability), folder, "shares")
    save(emulator_figure(done.probability), folder, "emulator")
    for engine in done.extent.judges:
        save(slews_figure(done.slews, engine), folder, f"slews_{engine}")
