"""``testbed study``: studies that fill a folder of results."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from testbed.cli.options import AsJson, Jobs, Out, RigFile, out_folder
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


@study.command("identifier", epilog="Example: testbed study identifier --out results/identifier")
def identifier(
    *,
    out: Out = None,
    seeds: Annotated[int, typer.Option("--seeds", min=2, help="Records behind each mean.")] = 20,
    jobs: Jobs = 2,
    as_json: AsJson = False,
) -> None:
    """The identifier against the article's verification and the Cramer-Rao bound; status 1 if a bar is missed."""
    folder = out_folder(out, Path("identifier"))
    with progress() as tell:
        from testbed.identifier_study.run import run_identifier_study

        command = ["testbed", *sys.argv[1:]]
        content = run_identifier_study(folder, seeds=seeds, jobs=jobs, command=command, progress=tell)
    from testbed.cli.tables import print_json, print_table, say

    if as_json:
        print_json(content)
    else:
        heads = ("case", "dB", "ridge past jumps", "smoother", "bar", "floor, form known")
        rows = [
            (row["case"], row["snr_db"], *(f"{row[key]:.6f}" for key in ("past_jumps", "smoother", "bar", "floor")))
            for row in content["verification"]
        ]
        print_table(heads, rows, "rms error of c [N s/m]")
        say(f"written: {folder}/README.md, identifier.json and figures")
    if content["missed"]:
        raise typer.Exit(MISSED)
