"""All sines of the study, each kept when it is done: a run that was stopped goes on where it was."""

from collections.abc import Sequence
from pathlib import Path

from identification.progress import Progress
from testbed.article.rig import Geometry
from testbed.article.sines import AMPLITUDES, CHOICES, curve_json, sines, sines_json, spine
from testbed.outputs import Json, digest_of, kept

KEPT = "sines"


def all_sines(
    geometry: Geometry, clearances: Sequence[float], judges: Sequence[str], out: Path, progress: Progress
) -> list[Json]:
    """Per clearance the curves at every amplitude and the backbone.

    Args:
        geometry: of the rig.
        clearances: of both sleeves, m.
        judges: simulators that step the rig in time, beside the modal model.
        out: folder of the results, where each test is kept and looked for.
        progress: told what is being done.

    Returns:
        mappings with ``clearance``, ``backbone`` and ``levels``.

    Raises:
        DivergenceError: no periodic motion was found where a curve begins.
    """
    engines = ("modal", *judges)
    return [
        {
            "clearance": clearance,
            "levels": [_level(geometry, clearance, amplitude, engines, out, progress) for amplitude in AMPLITUDES],
            "backbone": curve_json(spine(geometry, clearance)),
        }
        for clearance in clearances
    ]


def _level(
    geometry: Geometry, clearance: float, amplitude: float, engines: Sequence[str], out: Path, progress: Progress
) -> Json:
    """One amplitude at one clearance, as it was kept or as it is now."""

    def made() -> Json:
        progress(f"sines of {amplitude:g} N at {1e3 * clearance:g} mm: the curve, then one motion stepped in time")
        return sines_json(sines(geometry, clearance, amplitude, engines))

    path, rig = out / KEPT / f"{1e3 * clearance:g}-mm-{amplitude:g}-N.json", geometry.rig(clearance, "force")
    found = kept(path, digest_of(rig, amplitude, engines, CHOICES), made)
    return {name: value for name, value in found.items() if name != "made_of"}
