"""``testbed add``: one effect by hand."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from testbed.cli.options import AsJson, Jobs, Out, RigFile, Seed, Without, out_folder
from testbed.cli.progress import progress

EXAMPLE = 'Example: testbed add rig.toml squeeze_film --sleeve "sleeve 2" --fit sweep.uff'

Kind = Annotated[
    str, typer.Argument(metavar="KIND", help="Kind of the effect; see docs/effects.md.", show_default=False)
]
Fit = Annotated[
    list[Path], typer.Option("--fit", metavar="RECORD", help="Fit to this record; may be repeated.", show_default=False)
]


def add(
    rig: RigFile,
    kind: Kind,
    fit: Fit,
    *,
    sleeve: Annotated[str | None, typer.Option(metavar="NAME", help="At this sleeve.")] = None,
    position: Annotated[float | None, typer.Option(metavar="M", help="At this position, m from the clamp.")] = None,
    sensor: Annotated[str | None, typer.Option(metavar="NAME", help="On this sensor.")] = None,
    other: Annotated[str | None, typer.Option(metavar="NAME", help="And on this one, of a pair.")] = None,
    against: Annotated[str | None, typer.Option(metavar="FRAME", help="base or ground, where the kind has it.")] = None,
    out: Out = None,
    without: Without = None,
    seed: Seed = 0,
    jobs: Jobs = 2,
    as_json: AsJson = False,
) -> None:
    """Add one effect and fit it: rig.updated.toml, compare.json and figures."""
    given = {"sleeve": sleeve, "position": position, "sensor": sensor, "other": other, "against": against}
    settings = {key: value for key, value in given.items() if value is not None}
    folder = out_folder(out, rig, "compare.json", "figures/")
    with progress() as tell:
        from testbed.add_run import check_effect, check_order, run_add
        from testbed.inputs import read_inputs

        check_order(rig, kind)
        check_effect(rig, kind, settings)
        inputs = read_inputs(rig, fit, without=without or ())
        tell(f"adding {kind} and fitting it to {', '.join(record.name for record in inputs.records)}")
        command = ["testbed", *sys.argv[1:]]
        added = run_add(inputs, kind, settings, folder, seed=seed, jobs=jobs, command=command)
    from testbed.cli.tables import ONE_STD, measured, print_comparison, print_json, print_table, say

    if as_json:
        print_json(added.comparison)
        return
    print_table(("model", "NRMSE"), [(model.label, model.nrmse) for model in added.models], "error")
    numbers = added.comparison["added"]["parameters"].items()
    rows = [(name, measured(number), number["unit"]) for name, number in numbers]
    if rows:
        print_table(("parameter", f"value {ONE_STD}", "unit"), rows, added.effect.label())
    else:
        say(f"{added.effect.label()}: {added.effect.in_words()}")
    moved = added.comparison["calibrated"].values()
    calibrated = [(row["label"], row["given"], measured(row), row["unit"], f"{row['sigmas']:+.1f}") for row in moved]
    if calibrated:
        heads = ("number of the rig", "given", f"fitted {ONE_STD}", "unit", "moved by, in tolerances")
        print_table(heads, calibrated, "fitted along with it")
    if held := [row["label"] for row in moved if row["held"]]:
        say(
            f"note: {' and '.join(held)} moved as far as a fit may, beyond what the owner allows: something else pulls "
            "there, which testbed diagnose looks for; or the tolerance is too small"
        )
    print_comparison(added.comparison)
    say(f"written: {folder}/rig.updated.toml, compare.json and figures")
