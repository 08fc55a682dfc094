"""``contact_laws.json`` and the page beside it: what restitution is set, what comes of it, who differs from whom."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass

from testbed.contact_laws import ball_study, beam_study
from testbed.contact_laws.ball_study import SPEEDS, BallRow
from testbed.contact_laws.beam_study import FRF_SET, HOLDS, BeamRow, FrfRow
from testbed.contact_laws.laws import STUDY_LAWS
from testbed.crosscheck.measures import LEVEL
from testbed.outputs import Json

BOUND = 0.01
"""Largest difference between simulators that counts as agreement."""


@dataclass(frozen=True)
class Study:
    """All that was computed.

    Attributes:
        balls, beams, frfs: rows of each part.
    """

    balls: Sequence[BallRow]
    beams: Sequence[BeamRow]
    frfs: Sequence[FrfRow]

    @property
    def ball_differences(self) -> dict[str, float]:
        """Between the simulators by law, of a ball."""
        return ball_study.disagreement(self.balls)

    @property
    def beam_differences(self) -> dict[str, float]:
        """Between the simulators by law, of the beam."""
        return beam_study.disagreement(self.beams)

    @property
    def agrees(self) -> bool:
        """Whether the simulators agree on every law."""
        return max(*self.ball_differences.values(), *self.beam_differences.values()) <= BOUND


def study_json(study: Study) -> Json:
    """The content of ``contact_laws.json``.

    Args:
        study: finished.
    """
    return {
        "agrees": study.agrees,
        "bound": BOUND,
        "laws": {key: {"name": law.name, "source": law.source, "valid": law.valid} for key, law in STUDY_LAWS.items()},
        "ball_differences": study.ball_differences,
        "beam_differences": study.beam_differences,
        "balls": [asdict(row) for row in study.balls],
        "beams": [asdict(row) for row in study.beams],
        "frfs": [asdict(row) for row in study.frfs],
    }


WHY = """\
## What to make of it

- The rules of Hunt and Crossley, of Herbert and McWhannell, of Lee and Wang and of Lankarani and Nikravesh take the
  loss to be slight. At e = 0.1 they give back about half of the speed or more.
- Gonthier's and Flores' rules come close at all e; exact is only the root of d (1 + e) = ln((1 + d) / (1 - d e)).
- All laws of the form k p^n (1 + a dp/dt) lose a larger share the faster the strike, spring and dashpot always the same
  share, grease in the gap the same speed. So three speeds tell them apart, one does not.
- The force of spring and dashpot jumps as contact begins. A ball feels it as the largest force of all; a beam gives way
  locally at once, the force falls with the square root of time, and its peak is a matter of the steps. It is compared
  in the mean over a sample of a record.
- In a beam a set restitution is no longer obtained: many modes are struck, and the same spot is struck again before it
  has swung back. What counts is the energy taken.
"""


def page_of(study: Study, command: str) -> str:
    """The page, in Markdown.

    Args:
        study: finished.
        command: that makes it again.
    """
    verdict = "agree on every law within" if study.agrees else "do not agree on every law within"
    lines = [
        "# Contact laws: what is set and what comes of it",
        "",
        "A ball and then the beam of a rig strike stops with every law, in the modal model, MuJoCo and Exudyn. They",
        f"{verdict} {BOUND:.0%}. Made by `{command}`.",
        "",
        "## A ball",
        "",
        "![Restitution obtained over restitution set](figures/restitution.png)",
        "",
        *_ball_table(study),
        "",
        "![Force over penetration](figures/loops.png)",
        "",
        "## The beam",
        "",
        f"Held up at its free end by {', '.join(f'{hold:g}' for hold in HOLDS)} N and let go.",
        "",
        "![Energy taken and largest force](figures/beam.png)",
        "",
        *_beam_table(study),
        "",
        WHY,
    ]
    return "\n".join(lines)


def _ball_table(study: Study) -> Iterator[str]:
    speeds = " | ".join(f"e at {speed:g} m/s" for speed in SPEEDS)
    yield f"| law | valid for | e set at {SPEEDS[1]:g} m/s | {speeds} | peak force | time in contact | energy lost |"
    yield "|---|---|---|" + "---|" * (len(SPEEDS) + 3)
    modal = [row for row in study.balls if row.simulator == "modal"]
    for row in (row for row in modal if row.speed == SPEEDS[1]):
        same = [other for other in modal if (other.law, other.set) == (row.law, row.set)]
        law = STUDY_LAWS[row.law]
        obtained = " | ".join(f"{other.obtained:.3f}" for other in same)
        yield (
            f"| {law.name} | {law.valid} | {row.set:g} | {obtained} | {row.peak:.2f} | {row.duration:.2f} "
            f"| {max(row.lost, 0.0):.1%} |"
        )
    yield ""
    yield "Peak force and time in contact at the middle speed, in units of a lossless strike. The largest difference of"
    yield "restitution from its closed form, in any simulator at any speed, and of anything between the simulators:"
    yield ""
    yield "| law | source | restitution from the closed form | between simulators |"
    yield "|---|---|---|---|"
    for key, difference in study.ball_differences.items():
        off = max(abs(row.obtained - row.expected) for row in study.balls if row.law == key)
        yield f"| {STUDY_LAWS[key].name} | {STUDY_LAWS[key].source} | {off:.1e} | {difference:.2%} |"


def _beam_table(study: Study) -> Iterator[str]:
    heads = ("law", "energy taken at the least e", "at the largest e", "simulators differ by", "FRF changes by", "FRAC")
    yield f"| {' | '.join(heads)} |"
    yield "|" + "---|" * len(heads)
    for frf in study.frfs:
        rows = [row for row in study.beams if (row.law, row.simulator, row.hold) == (frf.law, "modal", HOLDS[1])]
        taken = [f"{row.taken / row.stored:.1%}" for row in (rows[0], rows[-1])]
        yield (
            f"| {STUDY_LAWS[frf.law].name} | {taken[0]} | {taken[1]} | {study.beam_differences[frf.law]:.2%} "
            f"| {frf.mre:.0%} | {frf.frac:.3f} |"
        )
    yield ""
    yield f"FRFs are those of the modal model under {LEVEL:g} N rms, all laws set for {FRF_SET:g}: mean relative change"
    yield "of the magnitudes against those with spring and dashpot, and the least FRAC of a sensor. Energy is counted"
    yield "with what the sleeves' springs hold at the end, less what they held while the beam was held up."
