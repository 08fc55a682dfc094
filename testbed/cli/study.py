"""``testbed study``: studies that fill a folder of results."""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from testbed.cli.options import AsJson, Jobs, Out, RigFile, Seed, out_folder
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
    folder = out_folder(out, rig, "README.md", "contact_laws.json", "figures/")
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
    folder = out_folder(out, Path("identifier"), "README.md", "identifier.json", "figures/")
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


DataFolder = Annotated[
    Path, typer.Argument(metavar="DATA_DIR", help="Folder with the published files.", show_default=False)
]


@study.command("silverbox", epilog="Example: testbed study silverbox data/silverbox --out results/silverbox")
def silverbox(folder: DataFolder, *, out: Out = None, seed: Seed = 0, jobs: Jobs = 2, as_json: AsJson = False) -> None:
    """The Silverbox circuit: what it hides, named and predicted; status 1 if a bar is missed."""
    written = out_folder(out, Path("silverbox"), "README.md", "silverbox.json", "figures/")
    with progress() as tell:
        from testbed.real_data.run import run_silverbox

        command = ["testbed", *sys.argv[1:]]
        content = run_silverbox(folder, written, seed=seed, jobs=jobs, command=command, progress=tell)
    _say_bars(content, written, "silverbox", as_json=as_json)


@study.command(
    "friction-frame", epilog="Example: testbed study friction-frame data/friction_frame --out results/friction_frame"
)
def friction_frame(
    folder: DataFolder, *, out: Out = None, seed: Seed = 0, jobs: Jobs = 2, as_json: AsJson = False
) -> None:
    """A frame that rubs, at three weights: friction against weight; status 1 if a bar is missed."""
    written = out_folder(out, Path("friction_frame"), "README.md", "friction_frame.json", "figures/")
    with progress() as tell:
        from testbed.real_data.run import run_friction_frame

        command = ["testbed", *sys.argv[1:]]
        content = run_friction_frame(folder, written, seed=seed, jobs=jobs, command=command, progress=tell)
    _say_bars(content, written, "friction_frame", as_json=as_json)


@study.command(
    "bolted-beam", epilog="Example: testbed study bolted-beam data/brake_reuss_beam --out results/bolted_beam"
)
def bolted_beam(folder: DataFolder, *, out: Out = None, jobs: Jobs = 2, as_json: AsJson = False) -> None:
    """The Brake-Reuss beam: what its joint does at four force levels; status 1 if a bar is missed."""
    written = out_folder(out, Path("bolted_beam"), "README.md", "bolted_beam.json", "figures/")
    with progress() as tell:
        from testbed.real_data.run import run_bolted_beam

        command = ["testbed", *sys.argv[1:]]
        content = run_bolted_beam(folder, written, jobs=jobs, command=command, progress=tell)
    _say_bars(content, written, "bolted_beam", as_json=as_json)


@study.command("article", epilog="Example: testbed study article --out results/article")
def article(
    *,
    out: Out = None,
    quick: Annotated[bool, typer.Option("--quick", help="At one clearance, in two or three minutes.")] = False,
    jobs: Jobs = 2,
    as_json: AsJson = False,
) -> None:
    """The article's case study as a virtual experiment: tests, three models, probability, sines and control."""
    folder = out_folder(out, Path("article"), "README.md", "article.json", "figures/")
    with progress() as tell:
        from testbed.article.run import run_article

        command = ["testbed", *sys.argv[1:]]
        content = run_article(folder, command=command, progress=tell, jobs=jobs, quick=quick)
    from testbed.cli.tables import print_json, print_table, say

    if as_json:
        print_json(content)
        return
    rows = [
        (1e3 * row["clearance"], *(f"{f:.2f}" for f in row["natural_freqs"]), *(f"{e:+.2%}" for e in row["errors"]))
        for row in content["at_rest"]
    ]
    orders = range(1, 5)
    heads = ("clearance [mm]", *(f"f{k} [Hz]" for k in orders), *(f"f{k} off" for k in orders))
    print_table(heads, rows, "natural frequencies at rest, and against the article's test")
    for engine, bars in content["bars"].items():
        reached = [(b["what"], b["asked"], b["reached"], "met" if b["is_met"] else "missed") for b in bars]
        print_table(("", "asked", "reached", ""), reached, f"models against the table tests by {engine}")
    say(f"written: {folder}/README.md, article.json, rig_table.toml, rig_force.toml and figures")


def _say_bars(content: Mapping[str, Any], folder: Path, name: str, *, as_json: bool) -> None:
    """What was to be reached and what was, and the exit status."""
    from testbed.cli.tables import print_json, print_table, say
    from testbed.real_data.page import rows_of

    if as_json:
        print_json(content)
    else:
        print_table(("", "reached", "bound", "unit", "kept"), rows_of(content))
        say(f"written: {folder}/README.md, {name}.json and figures")
    if not content["reached"]:
        raise typer.Exit(MISSED)
