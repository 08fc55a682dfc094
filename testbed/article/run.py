"""The case study over files: ``article.json``, the rig file, a page and its figures in a folder."""

import shlex
from collections.abc import Sequence
from pathlib import Path

from identification.progress import Progress
from models.rig_file import write_rig
from testbed.article.page import Json, article_json, page_of
from testbed.article.rig import CALIBRATED_AT
from testbed.article.study import DRIVES, article_study
from testbed.figures.article import frequencies_figure, sines_figure
from testbed.figures.save import save
from testbed.outputs import json_text, staged


def run_article(out: Path, *, command: Sequence[str], progress: Progress, quick: bool = False) -> Json:
    """Run the study and write it.

    Args:
        out: folder of the results.
        command: as typed, for the page.
        progress: told what is being done.
        quick: at one clearance alone.

    Returns:
        the content of ``article.json``.

    Raises:
        InputError: a folder that cannot be written.
        DivergenceError: the motion left the finite numbers.
    """
    study = article_study(out, progress, quick=quick)
    content = article_json(study)
    with staged(out) as stage:
        (stage / "article.json").write_text(json_text(content), encoding="utf-8")
        (stage / "README.md").write_text(page_of(study, shlex.join(command)), encoding="utf-8")
        for drive in DRIVES:
            write_rig(study.geometry.rig(CALIBRATED_AT, drive), stage / f"rig_{drive}.toml")
        save(frequencies_figure(study.rests), stage / "figures", "frequencies")
        save(sines_figure(study.sines), stage / "figures", "sines")
    return content
