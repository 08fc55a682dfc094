"""``crosscheck.json`` and the page beside it: where the simulators agree, where not, and why."""

from testbed.crosscheck.study import CrossCheck
from testbed.outputs import Json

WHY = """\
## Why they differ

- **Segments.** A chain of rigid segments carries waves with an error of the fourth power of a segment's length; the
  first two hinges are placed so that the clamp does not spoil it (docs/theory.md, section 7).
- **Elements.** The frequencies of the cable's cubic elements converge with the fourth power of their length too. They
  are thin rods, without rotary inertia, like the modal model.
- **Geometry.** MuJoCo and Exudyn bend by finite angles; the sag and the force at rest show by how much that counts.
- **Rotary inertia** of the sections is left out in all three here; the chain can count it by itself.
- **Steps.** The modal step is of second order or better with impacts, Exudyn's of second order; they soften
  what its elements stiffen: the two errors meet, and refining one alone makes it worse. MuJoCo's error is small from
  the largest step on at which it is stable, and falls slowly from there.
- **Contact.** All three call one definition of the law at the depth and speed that they computed, so its stiffness is
  the set one by construction; what can differ is the force at rest.
- **Impacts** make neighbouring motions part. Where a disturbance of one part in a billion grows beyond a thousandfold,
  waveforms are compared up to then only; the time stands in the table.
"""


def crosscheck_json(found: CrossCheck) -> Json:
    """The content of ``crosscheck.json``.

    Args:
        found: finished.
    """
    return {
        "holds": found.holds,
        "seed": found.seed,
        "measures": [{**vars(measure), "holds": measure.holds} for measure in found.measures],
        "convergence": [vars(row) for row in found.convergence],
        "predictable_seconds": found.horizons,
    }


def page_of(found: CrossCheck, command: str) -> str:
    """The page, in Markdown.

    Args:
        found: finished.
        command: that makes it again.
    """
    missed = [m for m in found.measures if not m.holds]
    verdict = "Every bound is kept." if not missed else f"{len(missed)} of {len(found.measures)} bounds are missed."
    lines = [
        "# Cross-check of the simulators",
        "",
        "The modal model against the others on the same tests, under 30 N rms from 3 to 250 Hz with phases of seed",
        f"{found.seed}. {verdict} Made by `{command}`.",
        "",
        "![Each difference as a share of its bound](figures/bounds.png)",
        "",
        "| rig | quantity | against | difference | bound | |",
        "|---|---|---|---|---|---|",
        *(
            f"| {m.rig} | {m.quantity} | {m.simulator} | {m.value:.4g} {m.unit} | {m.bound:g} {m.unit} | "
            f"{'holds' if m.holds else '**missed**'} |"
            for m in found.measures
        ),
        "",
        "![Forces in the sleeves in all simulators](figures/sleeves.png)",
        "",
        WHY,
        "![How errors fall](figures/convergence.png)",
        "",
    ]
    return "\n".join(lines)
