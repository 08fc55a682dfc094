"""``testbed film``: a moving picture of a test."""

from pathlib import Path
from typing import Annotated

import typer

from testbed.cli.options import AsJson, Out, RigFile, Without, out_folder
from testbed.cli.progress import progress
from testbed.cli.simulate import With

EXAMPLE = "Example: testbed film rig.toml sweep.uff --with mujoco --from 1.2 --to 1.5"


def film(
    rig: RigFile,
    of: Annotated[Path, typer.Argument(metavar="RECORD|EXPERIMENT", help="What drives the rig.", show_default=False)],
    *,
    using: With = "modal",
    first: Annotated[
        float | None, typer.Option("--from", min=0.0, metavar="S", help="Start; about the hardest push unless given.")
    ] = None,
    last: Annotated[
        float | None,
        typer.Option("--to", min=0.0, metavar="S", help="End; six periods after the start unless given."),
    ] = None,
    magnified: Annotated[
        float | None, typer.Option("--magnify", min=0.01, metavar="N", help="Of deflections in the GLB.")
    ] = None,
    without: Without = None,
    out: Out = None,
    as_json: AsJson = False,
) -> None:
    """Film the rig's model as the rig was driven: an animated GIF, and a GLB that any glTF viewer turns and plays."""
    folder = out_folder(out, of, "film.json")
    with progress() as tell:
        from testbed.film.run import Order
        from testbed.film.run import film as filmed

        content = filmed(Order(rig, of, using, first, last, magnified, without or ()), folder, tell)
    from testbed.cli.tables import print_json, say

    if as_json:
        print_json(content)
        return
    say(f"shows {content['shows']}")
    say(
        f"{content['first']:.4f} s to {content['last']:.4f} s, {content['slowed']:.3g} times slower than it happened; "
        f"deflections and gaps {content['magnified']:g} times as large in the GLB"
    )
    say(f"written: {', '.join(f'{folder}/{name}' for name in content['files'])} and film.json")
