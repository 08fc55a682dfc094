"""What was set out to be reached, and what was."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass

from scipy.stats import binomtest

from testbed.outputs import Json

ENOUGH, ENOUGH_NOTHING = 200, 50
"""Cases that the figures are to be of, and of them with nothing hidden."""


@dataclass(frozen=True)
class Bar:
    """One figure beside its bounds.

    Attributes:
        name: in words.
        value: reached; None where there are no cases to tell.
        bar: that has to be reached.
        aim: that is aimed at.
        cases: behind the value.
        least: whether the bar is a lower bound; else an upper one.
        upper: the other bound where there are two.
        is_share: whether the value is a share of the cases.
    """

    name: str
    value: float | None
    bar: float
    aim: float
    cases: int
    least: bool = True
    upper: float | None = None
    is_share: bool = False

    @property
    def interval(self) -> tuple[float, float] | None:
        """Of 95 %, of a share; None of any other value."""
        if self.value is None or not self.is_share:
            return None
        return interval_of(round(self.value * self.cases), self.cases)

    @property
    def met(self) -> bool | None:
        """None where there are no cases to tell."""
        if self.value is None:
            return None
        within = self.upper is None or self.value <= self.upper
        return within and (self.value >= self.bar if self.least else self.value <= self.bar)


def interval_of(hits: int, cases: int) -> tuple[float, float]:
    """(low, high) in which the share lies with 95 %, however few the cases are.

    Args:
        hits: cases that count.
        cases: all, at least 1.

    Source: C. J. Clopper and E. S. Pearson, Biometrika 26 (1934) 404.
    """
    low, high = binomtest(hits, cases).proportion_ci(0.95, "exact")
    return float(low), float(high)


def threads_of(seconds: Json) -> str:
    """On how many threads each diagnosis ran, in words.

    Args:
        seconds: of ``summary.json``.
    """
    counts = seconds["threads"] or [0]
    return f"{' or '.join(str(n) for n in counts)} {'thread' if counts == [1] else 'threads'} each"


def bars_of(figures: Json) -> list[Json]:
    """All bars as plain values.

    Args:
        figures: of ``summary.json``, by the names used here.
    """
    one, two = figures["one effect"], figures["two effects"]
    nothing, outside = figures["nothing hidden"], figures["outside the library"]
    held, numbers, seconds = figures["held_out"], figures["numbers"], figures["seconds"]
    bars: Sequence[Bar] = (
        Bar("right kind and place first, one effect", one["right_share"], 0.90, 0.97, one["cases"], is_share=True),
        Bar("right, or in a group of at most three", one["in_group_share"], 0.96, 0.99, one["cases"], is_share=True),
        Bar('"complete" with nothing hidden', nothing["right_share"], 0.96, 0.99, nothing["cases"], is_share=True),
        Bar('"unexplained" outside the library', outside["right_share"], 0.85, 0.95, outside["cases"], is_share=True),
        Bar("both of two effects found", two["right_share"], 0.75, 0.90, two["cases"], is_share=True),
        Bar("error held out after, over the true noise, median", held["median"], 1.1, 1.03, held["cases"], least=False),
        Bar("the same, 90th percentile", held["percentile_90"], 1.5, 1.2, held["cases"], least=False),
        Bar(
            "numbers inside their 95 % interval",
            numbers["inside_share"],
            0.90,
            0.95,
            numbers["count"],
            upper=0.98,
            is_share=True,
        ),
        Bar(
            f"seconds of a diagnosis, median, {threads_of(seconds)}",
            seconds["median"],
            60.0,
            20.0,
            seconds["cases"],
            least=False,
        ),
        Bar("cases", float(figures["cases"]), ENOUGH, ENOUGH, figures["cases"]),
        Bar("of them with nothing hidden", float(nothing["cases"]), ENOUGH_NOTHING, ENOUGH_NOTHING, nothing["cases"]),
    )
    return [asdict(bar) | {"interval": bar.interval, "met": bar.met} for bar in bars]
