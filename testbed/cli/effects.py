"""``testbed effects``: the library of effects, and its page with a picture for each kind."""

from pathlib import Path
from typing import Annotated

import typer

from testbed.cli.options import AsJson, Jobs, out_folder
from testbed.cli.progress import progress

EXAMPLE = "Example: testbed effects squeeze_film --out results/effects"

Kinds = Annotated[
    list[str] | None,
    typer.Argument(metavar="[KIND]...", help="Kinds of effects; all unless given.", show_default=False),
]
Folder = Annotated[
    str | None,
    typer.Option("--out", metavar="DIR", help="Draw pictures of the kinds and write the page of the library here."),
]


def effects(kinds: Kinds = None, *, out: Folder = None, jobs: Jobs = 2, as_json: AsJson = False) -> None:
    """The library of effects: places, parameters and where each shows; with --out the page effects.md and pictures."""
    from testbed.effects_page.library import chosen, library_json

    names = chosen(kinds or [])
    if out is not None:
        folder = out_folder(out, Path("effects"), "effects.md", "figures/effects/")
        with progress() as tell:
            from testbed.effects_page.run import run_effects

            run_effects(names, folder, jobs=jobs, progress=tell)
    from testbed.cli.tables import print_effects, print_json, say

    content = library_json(names)
    if as_json:
        print_json(content)
    elif out is None:
        print_effects(content)
    else:
        say(f"written: {out}/effects.md and figures/effects")
