"""``testbed sweep``: nonlinear FRFs under sines."""

from typing import Annotated

import typer

from testbed.cli.options import AsJson, Out, RigFile, out_folder
from testbed.cli.progress import progress

EXAMPLE = "Example: testbed sweep rig.toml --amplitude 1 --amplitude 5 --from 5 --to 14 --sensor P8"


def sweep(
    rig: RigFile,
    *,
    amplitudes: Annotated[
        list[float], typer.Option("--amplitude", metavar="A", help="Of the sine, in the excitation's unit; repeat it.")
    ],
    low: Annotated[float, typer.Option("--from", metavar="HZ", help="Lowest frequency of the sine.")],
    high: Annotated[float, typer.Option("--to", metavar="HZ", help="Highest frequency of the sine.")],
    sensor: Annotated[
        str | None, typer.Option("--sensor", metavar="NAME", help="Whose reading is shown; the last by default.")
    ] = None,
    highest: Annotated[
        float, typer.Option("--up-to", metavar="HZ", help="Frequency up to which modes follow the motion.")
    ] = 400.0,
    out: Out = None,
    as_json: AsJson = False,
) -> None:
    """Steady motion under sines at several levels, around its folds, and the backbone: sweep.json and a figure."""
    folder = out_folder(out, rig, "sweep.json", "figures/")
    with progress() as tell:
        from testbed.figures.save import save
        from testbed.figures.sweep import sweep_figure
        from testbed.outputs import json_text, staged
        from testbed.sweep import sweep_json, swept
        from testbed.whole_rig import whole_rig

        found = swept(whole_rig(rig), amplitudes, (low, high), sensor, highest, tell)
        content = sweep_json(found)
        with staged(folder) as stage:
            (stage / "sweep.json").write_text(json_text(content), encoding="utf-8")
            save(sweep_figure(found), stage / "figures", "sweep")
    from testbed.cli.tables import print_json, print_table, say

    if as_json:
        print_json(content)
        return
    rows = []
    for curve, row in zip(found.curves, content["curves"], strict=True):
        top = int(row["peak"].argmax())
        unstable = 1.0 - float(curve.is_stable.mean())
        cells = (f"{row['peak'][top]:.4g}", f"{curve.freqs[top]:.4g}", len(curve.freqs), f"{unstable:.0%}")
        rows.append((f"{curve.amplitudes[0]:g}", *cells))
    heads = (f"amplitude [{found.level_unit}]", f"largest [{found.unit}]", "at [Hz]", "points", "unstable")
    print_table(heads, rows, f"{found.sensor} under sines")
    for curve in found.curves:
        if curve.ended:
            say(f"note: {curve.amplitudes[0]:g} {found.level_unit}: {curve.ended}")
    if found.spine is None:
        say(f"note: no backbone: {found.without_spine}")
    say(f"written: {folder}/sweep.json and figures/sweep.png")
