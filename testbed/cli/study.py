"""``testbed study``: studies that fill a folder of results."""

import sys

import typer

from testbed.cli.options import AsJson, Out, RigFile, out_folder
from testbed.cli.progress import progress

EXAMPLE = "Example: testbed study contact-laws rig.toml --out results/contact_laws"
MISSED = 1

study = typer.Typer(help="Studies that fill a folder of results.", no_args_is_help=True, epilog=EXAMPLE)


@study.callback()
def _studies() -> None:
    """Studies that fill a folder of results."""


@study.command("contact-laws", epilog=EXAMPLE)
def contact_laws(rig: RigFile, *, out: Out = None, as_json: AsJson = False) -> None:
    """A ball and the beam against every contact law in three simulators; status 1 if they differ by more than 1 %."""
    folder = out_folder(out, rig)
    with progress() as tell:
        from testbed.contact_laws.run import run_contact_laws

        content = run_contact_laws(rig, folder, command=["testbed", *sys.argv[1:]], progress=tell)
    from testbed.cli.tables import print_json, print_table, say

    if as_json:
        print_json(content)
    else:
        rows = [
            (content["laws"][key]["name"], f"{ball:.2%}", f"{content['beam_differences'][key]:.2%}")
            for key, ball in content["ball_differences"].items()
        ]
        print_table(("law", "simulators differ, ball", "simulators differ, beam"), rows)
        say(f"written: {folder}/README.md, contact_laws.json and figures")
    if not content["agrees"]:
        raise typer.Exit(MISSED)
