"""One effect of each kind with everything its picture shows."""

from dataclasses import dataclass

from models.effects import Effect
from testbed.effects_page.bench import Bench
from testbed.effects_page.example import example_of
from testbed.effects_page.inside import inside_panels
from testbed.effects_page.panels import Panel, frequency_panels, place_panel, sensor_shown, time_panel


@dataclass(frozen=True, eq=False)
class Showing:
    """A finished picture, not yet drawn.

    Attributes:
        effect: that is shown.
        panels: in rows of three: frequency at both levels and place, then what the effect is inside, and time.
    """

    effect: Effect
    panels: tuple[Panel, ...]

    @property
    def title(self) -> str:
        """Kind, place and the effect in words: ``point_mass at 0.880 m: ...``."""
        return f"{self.effect.label()}: {self.effect.in_words()}"


def showing_of(kind: type[Effect], bench: Bench) -> Showing:
    """What the picture of a kind shows.

    Args:
        kind: of the library.
        bench: with the rig without it.

    Raises:
        DivergenceError: there is no trial value under which the motion stays finite.
    """
    effect = example_of(kind, bench)
    answers = bench.answers_with(effect)
    sensor = sensor_shown(bench, answers)
    panels = (
        *frequency_panels(bench, answers, sensor),
        place_panel(bench, answers, bench.position_of(effect.place)),
        *inside_panels(bench, effect, answers, sensor),
        time_panel(bench, answers),
    )
    return Showing(effect, panels)
