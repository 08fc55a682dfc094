"""What a study has to reach, beside what it reached."""

from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from testbed.cli.tables import shown


@dataclass(frozen=True)
class Bar:
    """One figure and its bound.

    Attributes:
        what: in words.
        reached: the figure; or what was found, in words.
        bound: at most this, or exactly these words.
        unit: of both.
    """

    what: str
    reached: float | str
    bound: float | str
    unit: str = ""

    @property
    def met(self) -> bool:
        """Whether the bound is kept."""
        if isinstance(self.reached, str) or isinstance(self.bound, str):
            return self.reached == self.bound
        return self.reached <= self.bound

    def json(self) -> dict[str, Any]:
        """As the files hold it."""
        return {**asdict(self), "met": self.met}


def bars_table(bars: Sequence[Bar]) -> Iterator[str]:
    """Markdown rows.

    Args:
        bars: of a study.
    """
    yield "| | reached | bound | kept |"
    yield "|---|---|---|---|"
    for bar in bars:
        unit = f" {bar.unit}" if bar.unit else ""
        most = "" if isinstance(bar.bound, str) else "at most "
        kept = "yes" if bar.met else "**no**"
        yield f"| {bar.what} | {shown(bar.reached)}{unit} | {most}{shown(bar.bound)}{unit} | {kept} |"
