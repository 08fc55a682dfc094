"""``report.html``: the diagnosis as one page without links to anything outside itself."""

from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from identification.outcome import UNTRIED, UNTRIED_BEYOND, UNTRIED_MISSED
from identification.result import Diagnosis
from models.rig import Rig
from testbed.figures.report_style import report_style
from testbed.proposal import HEADS, excitation_rows, option_rows
from testbed.report.budget_rows import budget_table
from testbed.report.evidence import DECISIVE, because, beside, evidence_picture
from testbed.report.figures import (
    error_steps,
    force_pictures,
    frf_pictures,
    map_pictures,
    pulls_picture,
    shown_records,
)
from testbed.report.place_figure import place_picture
from testbed.report.provenance import Provenance
from testbed.report.rows import (
    CANDIDATES,
    candidate_rows,
    channel_rows,
    default_rows,
    effect_rows,
    group_rows,
    mode_tables,
    record_rows,
    rig_pulls,
    stage_rows,
)
from testbed.report.words import chance, headline, second_line

FILE = "report.html"
FIRST, FIRST_PICTURE = "error_steps", "error.svg"
"""The first picture, of the error falling, and the file in which it stands beside the report."""

TITLES = {"missing_effect": "Missing effect found", "complete": "Model complete", "unexplained": "Unexplained"}


def write_report(diagnosis: Diagnosis, rig: Rig, out_dir: Path, provenance: Provenance) -> Path:
    """Write the report of a diagnosis.

    Args:
        diagnosis: finished.
        rig: as its owner describes it.
        out_dir: folder of ``report.html`` and ``error.svg``, made if it does not exist.
        provenance: where the numbers come from.

    Returns:
        the file.

    Raises:
        OSError: the folder cannot be written.
    """
    environment = Environment(
        loader=PackageLoader("testbed.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    with report_style():
        content = _content(diagnosis, rig, provenance)
        page = environment.get_template("report.html.j2").render(content)
    out_dir.mkdir(parents=True, exist_ok=True)
    (out_dir / FIRST_PICTURE).write_bytes(content[FIRST].data)
    path = out_dir / FILE
    path.write_text(page, encoding="utf-8")
    return path


def _content(diagnosis: Diagnosis, rig: Rig, provenance: Provenance) -> dict[str, Any]:
    pulls = rig_pulls(diagnosis.rig_estimates, rig)
    candidates = candidate_rows(diagnosis)
    shown, learned = shown_records(diagnosis), diagnosis.final.score.records
    frfs, forces = frf_pictures(diagnosis, rig), force_pictures(diagnosis, rig)
    place = place_picture(diagnosis, rig)
    return {
        "verdict": diagnosis.verdict,
        "verdict_title": TITLES[diagnosis.verdict],
        "headline": headline(diagnosis),
        "second_line": second_line(diagnosis),
        "error_steps": error_steps(diagnosis),
        "stages": stage_rows(diagnosis),
        "has_holdout": bool(diagnosis.holdout),
        "effects": effect_rows(diagnosis),
        "pulls": pulls.rows,
        "pulls_picture": pulls_picture(pulls) if pulls.rows else None,
        "candidates": candidates[:CANDIDATES],
        "more_candidates": candidates[CANDIDATES:],
        "decisive": f"{DECISIVE:g}",
        "untried": chance(UNTRIED),
        "untried_beyond": chance(UNTRIED_BEYOND),
        "untried_missed": chance(UNTRIED_MISSED),
        "groups": group_rows(diagnosis),
        "because": because(diagnosis),
        "beside": beside(diagnosis),
        "evidence": evidence_picture(diagnosis, rig, place) or next(iter((*forces, *frfs)), None),
        "frfs": frfs,
        "maps": map_pictures(diagnosis, rig),
        "place": place,
        "located": diagnosis.located,
        "forces": forces,
        "records": record_rows(diagnosis, rig),
        "budget": budget_table(diagnosis, rig),
        "channels": channel_rows(diagnosis),
        "modes": mode_tables(diagnosis),
        "not_shown": [row.record.name for row in learned if row.record.name not in shown],
        "next_experiment": diagnosis.next_experiment,
        "options": option_rows(diagnosis.next_experiment),
        "option_heads": HEADS,
        "excitation": excitation_rows(diagnosis.next_experiment),
        "decisions": diagnosis.decisions,
        "calibration": [finding.words for finding in diagnosis.calibration],
        "findings": diagnosis.findings,
        "provenance": provenance,
        "defaults": default_rows(diagnosis, rig),
    }
