"""``testbed modes``: the rig at rest and its modes."""

from typing import Annotated

import typer

from testbed.cli.options import AsJson, Out, RigFile, out_folder

EXAMPLE = "Example: testbed modes rig.toml --up-to 300"


def modes(
    rig: RigFile,
    highest: Annotated[
        float, typer.Option("--up-to", min=0.0, metavar="HZ", help="Highest natural frequency.")
    ] = 500.0,
    out: Out = None,
    as_json: AsJson = False,
) -> None:
    """The state at rest, which sleeves touch, frequencies, damping, shapes: modes.json and figures."""
    from testbed.cli.tables import print_json, print_table, say
    from testbed.figures.modes import modes_figure
    from testbed.figures.save import save
    from testbed.modes import modes_json, rig_modes
    from testbed.outputs import json_text, staged
    from testbed.whole_rig import whole_rig

    folder = out_folder(out, rig, "modes.json", "figures/")
    found = rig_modes(whole_rig(rig), highest)
    content = modes_json(found)
    with staged(folder) as stage:
        (stage / "modes.json").write_text(json_text(content), encoding="utf-8")
        if found.x is not None:
            save(modes_figure(found), stage / "figures", "modes")
    if as_json:
        print_json(content)
        return
    heads = ("sleeve", "position [m]", "touches", "force on the beam [N]", "gap [m]")
    print_table(heads, [tuple(row.values()) for row in content["sleeves"]], "at rest")
    numbers = [(float(mode["natural_freq"]), float(mode["damping_ratio"])) for mode in content["modes"]]
    rows = [(i, f"{freq:.3f}", ratio) for i, (freq, ratio) in enumerate(numbers, start=1)]
    print_table(("mode", "frequency [Hz]", "damping ratio"), rows, "small motion about rest")
    say(f"written: {folder}/modes.json{'' if found.x is None else ' and figures/modes.png'}")
