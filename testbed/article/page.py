"""``article.json`` and the page beside it."""

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from testbed.article.rig import CALIBRATED_AT, CLAMP_GROUP, DENSITY, DIAMETER, SLEEVES_AT, YOUNGS_MODULUS
from testbed.article.sines import ENGINES
from testbed.article.strikes import EXCITED, LEVELS
from testbed.article.study import ArticleStudy

Json = dict[str, Any]

MILLI = 1e3

WHAT = """\
The article (Actuators 14 (2025) 58) measured a cantilever that rests in two sleeves at six clearances. Its data are not
public, so its study is built again in the virtual laboratory. This page holds the rig and its motion under sines;
models, updating and probability are not built yet.
"""

WHY = """\
As long as both sleeves carry the rod, its natural frequencies do not depend on the clearance: the contact is a linear
spring, and a gap on the far side is not felt by small motion. From 1 mm on the rod sags less than the first sleeve lets
it and lies in the second alone: all frequencies fall, the second most. The article says in words that frequencies fall
with clearance, while its tables let the third and fourth rise. A wider gap alone does that in neither state; what the
article changed between its tests are contact rings, whose own stiffness need not have stayed the same.
"""

STRUCK = f"""\
Random-phase multisines from {EXCITED[0]:g} to {EXCITED[1]:g} Hz, of {LEVELS["table"]:g} m/s^2 rms of the table or
{LEVELS["force"]:g} N rms of the shaker, by the modal model. A sleeve that carries the rod is struck when the rod comes
back to it.
"""

SINES = """\
All periodic motions of the modal model under the shaker's sine, by harmonic balance with continuation; dotted ones are
unstable, and dashed is where a phase-locked test would settle. While the rod stays on its walls the resonance keeps
its place. From the level at which a wall is left it bends to lower frequencies, and back once both sleeves are struck
in every period; the wider the clearance, the further. Circles are motions stepped from rest to steady state by three
engines, chosen as the most distorted ones that a curve has alone at their frequency.
"""

COMPARED = """\
First harmonics at all eight points: harmonic balance against the modal model begun on the curve, and against each
engine begun at rest. Where it stays on the curve and all three engines come to the same other motion, that one attracts
the rod from rest beside the curve's.\
"""

SIMILARITY = """\
An arm and this rig have the same motion in units of their own length and of `sqrt(rho A L^4 / (E I))` if these numbers
are the same: contact stiffness `k L^3 / (E I)`, rotational stiffness of the clamp `k L / (E I)`, mass of the tip over
that of the beam, damping ratios, places as shares of the length; and, since a gap makes the motion depend on its size,
the clearance over the sag `rho A g L^4 / (8 E I)` of the beam alone and the exciting force over its weight. An arm in
orbit has no sag: there the clearance over the amplitude of the motion takes its place.
"""


def article_json(study: ArticleStudy) -> Json:
    """The content of ``article.json``.

    Args:
        study: finished.
    """
    geometry = study.geometry
    return {
        "geometry": {**asdict(geometry), "rate": geometry.rate, "sag": geometry.sag},
        "at_rest": [{**vars(rest), "errors": rest.errors} for rest in study.rests],
        "tests": [vars(test) for test in study.tests],
        "sines": study.sines,
    }


def page_of(study: ArticleStudy, command: str) -> str:
    """The page, in Markdown.

    Args:
        study: finished.
        command: that makes it again.
    """
    lines = [
        "# The article's case study",
        "",
        f"Made by `{command}`.",
        "",
        WHAT,
        "## The rig",
        "",
        *_geometry(study),
        "",
        SIMILARITY,
        "## What the clearance does at rest",
        "",
        "![Natural frequencies against clearance](figures/frequencies.png)",
        "",
        *_rests(study),
        "",
        WHY,
        "## Both sleeves are struck",
        "",
        STRUCK,
        *_tests(study),
        "",
        "## Under sines",
        "",
        SINES,
        "![Tip under sines at three levels](figures/sines.png)",
        "",
        *_sines(study),
        "",
        *_speed(study),
        "",
    ]
    return "\n".join(lines)


def _geometry(study: ArticleStudy) -> Iterator[str]:
    geometry = study.geometry
    first, second = geometry.contact_groups
    yield "| | | |"
    yield "|---|---|---|"
    yield f"| section, material | assumed | {1e3 * DIAMETER:g} mm, {YOUNGS_MODULUS / 1e9:g} GPa, {DENSITY:g} kg/m^3 |"
    yield f"| sleeves, as shares of the length | assumed | {SLEEVES_AT[0]:g} and {SLEEVES_AT[1]:g} |"
    yield f"| clamp, k L / (E I) | assumed | {CLAMP_GROUP:g} |"
    yield f"| length | calibrated | {geometry.length:.4f} m, E I / (rho A L^4) = {geometry.rate:.2f} 1/s^2 |"
    yield f"| contacts, k L^3 / (E I) | calibrated | {first:.2f} and {second:.2f} |"
    yield f"| tip mass over the rod's | calibrated | {geometry.tip_share:.4f} |"
    yield f"| sag of the beam alone | follows | {MILLI * geometry.sag:.2f} mm |"


def _rests(study: ArticleStudy) -> Iterator[str]:
    yield f"Calibrated at {MILLI * CALIBRATED_AT:g} mm; in brackets the difference to what the article measured."
    yield ""
    yield "| clearance [mm] | f1 [Hz] | f2 | f3 | f4 | depth in sleeve 1 [mm] | in sleeve 2 |"
    yield "|---|---|---|---|---|---|---|"
    for rest in study.rests:
        freqs = " | ".join(
            f"{f:.2f} ({100.0 * error:+.2f} %)" for f, error in zip(rest.natural_freqs, rest.errors, strict=True)
        )
        depths = " | ".join(f"{MILLI * depth:+.3f}" for depth in rest.penetrations)
        yield f"| {MILLI * rest.clearance:g} | {freqs} | {depths} |"


def _tests(study: ArticleStudy) -> Iterator[str]:
    yield "| clearance [mm] | test | strikes per second, sleeve 1 | sleeve 2 | time closed | | largest force [N] | |"
    yield "|---|---|---|---|---|---|---|---|"
    for test in study.tests:
        cells = [
            *(f"{rate:.1f}" for rate in test.per_second),
            *(f"{share:.0%}" for share in test.closed_share),
            *(f"{force:.0f}" for force in test.largest_force),
        ]
        yield f"| {MILLI * test.clearance:g} | {test.drive} | {' | '.join(cells)} |"


def _sines(study: ArticleStudy) -> Iterator[str]:
    yield COMPARED
    yield ""
    heads = "clearance [mm] | force [N] | largest [m/s^2] | at [Hz] | unstable | compared at [Hz] | distortion"
    yield f"| {heads} | begun on it | modal | MuJoCo | Exudyn |"
    yield "|---|---|---|---|---|---|---|---|---|---|---|"
    for row in study.sines:
        for level in row["levels"]:
            curve, check = level["curves"][0], level["check"]
            top = max(range(len(curve["peak"])), key=curve["peak"].__getitem__)
            unstable = 1.0 - sum(curve["stable"]) / len(curve["stable"])
            cells = [f"{MILLI * row['clearance']:g}", f"{level['amplitude']:g}", f"{curve['peak'][top]:.3g}"]
            cells += [f"{curve['frequency'][top]:.3f}", f"{unstable:.0%}"]
            if check is None:
                cells += ["none is alone and settles within half a minute", "", "", "", "", ""]
            else:
                errors = (check["errors"][engine] for engine in ENGINES)
                cells += [
                    f"{check['freq']:.3f}",
                    f"{check['distortion']:.0%}",
                    f"{check['stays']:.2%}",
                    *(f"{error:.2%}" for error in errors),
                ]
            yield f"| {' | '.join(cells)} |"


def _speed(study: ArticleStudy) -> Iterator[str]:
    levels = [level for row in study.sines for level in row["levels"]]
    points = sum(len(curve["frequency"]) for level in levels for curve in level["curves"])
    each = sum(level["seconds"] for level in levels) / points
    checks = [level["check"] for level in levels if level["check"] is not None]
    if not checks:
        return
    times = {engine: sum(check["seconds"][engine] for check in checks) / len(checks) / each for engine in ENGINES}
    yield (
        f"A point of a curve with its stability takes {1e3 * each:.1f} ms; stepping {_mean(checks):.1f} s of motion to "
        f"a steady state takes {times['modal']:.0f} times as long by our compiled stepper, {times['mujoco']:.0f} times "
        f"by MuJoCo and {times['exudyn']:.0f} times by Exudyn, and shows no unstable motion."
    )


def _mean(checks: list[Json]) -> float:
    return float(sum(check["until_steady"] for check in checks) / len(checks))
