"""All sines of the study, each kept when it is done: a run that was stopped goes on where it was."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from identification.progress import Progress
from testbed.article.rig import Geometry
from testbed.article.sines import AMPLITUDES, curve_json, sines, sines_json, spine
from testbed.outputs import json_text, keep_json

Json = dict[str, Any]

KEPT = "sines"


def all_sines(geometry: Geometry, clearances: Sequence[float], out: Path, progress: Progress) -> list[Json]:
    """Per clearance the curves at every amplitude and the backbone.

    Args:
        geometry: of the rig.
        clearances: of both sleeves, m.
        out: folder of the results, where each test is kept and looked for.
        progress: told what is being done.

    Returns:
        mappings with ``clearance``, ``backbone`` and ``levels``.

    Raises:
        DivergenceError: no periodic motion was found where a curve begins.
    """
    rows = []
    for clearance in clearances:
        levels = []
        for amplitude in AMPLITUDES:
            path = out / KEPT / f"{1e3 * clearance:g}-mm-{amplitude:g}-N.json"
            kept = _kept(path, geometry)
            if kept is None:
                progress(
                    f"sines of {amplitude:g} N at {1e3 * clearance:g} mm: the curve, then one motion by three engines"
                )
                kept = {"geometry": asdict(geometry), **sines_json(sines(geometry, clearance, amplitude))}
                keep_json(path, kept)
            levels.append(_plain(kept))
        along = _plain(curve_json(spine(geometry, clearance)))
        rows.append({"clearance": clearance, "backbone": along, "levels": levels})
    return rows


def _kept(path: Path, geometry: Geometry) -> Json | None:
    """A test that was kept for the same rig."""
    if not path.is_file():
        return None
    content: Json = json.loads(path.read_text(encoding="utf-8"))
    return content if content.get("geometry") == _plain(asdict(geometry)) else None


def _plain(content: Json) -> Json:
    """As it comes back from a file, so that a test reads alike whether it was kept or just made."""
    plain: Json = json.loads(json_text(content))
    return plain
