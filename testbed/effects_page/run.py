"""The page of the library with a picture for each kind, in a folder."""

from collections.abc import Sequence
from functools import cache, partial
from pathlib import Path

from identification.progress import Progress
from models.effects import EFFECTS
from models.effects.protocol import StructureKind
from testbed.effects_page.bench import Bench, bench_of
from testbed.effects_page.page import FIGURES, page_of
from testbed.effects_page.showing import showing_of
from testbed.figures.effects_page import effect_figure, save_small
from testbed.outputs import staged
from testbed.processes import as_done

PAGE = "effects.md"


def run_effects(kinds: Sequence[str], out: Path, *, jobs: int, progress: Progress) -> None:
    """Draw the pictures of some kinds and write the page of all.

    Args:
        kinds: whose pictures are drawn.
        out: folder of the page.
        jobs: processes.
        progress: told what is being done.

    Raises:
        InputError: a folder that cannot be written.
        DivergenceError: a kind without a trial value under which the motion stays finite.
    """
    with staged(out) as stage:
        (stage / PAGE).write_text(page_of(), encoding="utf-8")
        for number, (_, label) in enumerate(as_done(partial(_draw, stage), kinds, jobs), start=1):
            progress(f"{number} of {len(kinds)}: {label}")


def _draw(stage: Path, kind: str) -> str:
    cls = EFFECTS[kind]
    shown = showing_of(cls, _bench(cls.structures[0]))
    save_small(effect_figure(shown), stage / FIGURES / f"{kind}.png")
    return shown.effect.label()


@cache
def _bench(structure: StructureKind) -> Bench:
    """One of each a process."""
    return bench_of(structure)
