"""``testbed frf``: the FRFs of one record."""

from pathlib import Path
from typing import Annotated

import typer

from testbed.cli.options import AsJson, Out, Without, out_folder

EXAMPLE = "Example: testbed frf burst.uff --rig rig.toml --resolution 1"

RecordFile = Annotated[Path, typer.Argument(metavar="RECORD", help="A time record.", show_default=False)]
Rig = Annotated[Path | None, typer.Option("--rig", metavar="RIG", help="Name sensors and excitation by this rig file.")]
Excitation = Annotated[
    str | None,
    typer.Option("--excitation", metavar="NAME", help="Channel of the excitation, without a rig; or the only force."),
]
Resolution = Annotated[
    float | None,
    typer.Option("--resolution", metavar="HZ", help="Spacing of the lines where nothing repeats; or 8 / T."),
]


def frf(
    record: RecordFile,
    *,
    rig: Rig = None,
    excitation: Excitation = None,
    resolution: Resolution = None,
    out: Out = None,
    without: Without = None,
    as_json: AsJson = False,
) -> None:
    """H1, H2 and coherence at each excitation level: frf.json and figures."""
    from models.rig_file import read_rig
    from testbed.channel_checks import check_excitation
    from testbed.channels import channels_of_file, channels_with_rig
    from testbed.cli.tables import print_json, print_table, say
    from testbed.figures.levels import levels_figure
    from testbed.figures.save import save
    from testbed.frf_record import levels_json, levels_of
    from testbed.outputs import json_text, staged

    folder = out_folder(out, record, "frf.json", "figures/")
    left_out = without or []
    if rig is not None:
        known = read_rig(rig)
        check_excitation(excitation, known)
        channels = channels_with_rig(record, known, left_out)
    else:
        channels = channels_of_file(record, excitation, left_out)
    levels = levels_of(channels, resolution)
    content = levels_json(levels)
    with staged(folder) as stage:
        (stage / "frf.json").write_text(json_text(content), encoding="utf-8")
        for i, sensor in enumerate(channels.sensors):
            save(levels_figure(levels, i), stage / "figures", f"{channels.name}-{sensor}-frf")
    if as_json:
        print_json(content)
        return
    rows = [
        (
            e.level,
            e.n_averages,
            len(e.frequency),
            float(e.frequency[0]),
            float(e.frequency[-1]),
            float(e.coherence.mean()),
        )
        for e in levels.estimates
    ]
    heads = (f"level, rms [{levels.excitation_unit}]", "averages", "lines", "from [Hz]", "to [Hz]", "mean coherence")
    print_table(heads, rows)
    for finding in content["findings"]:
        say(f"note: {finding}")
    say(f"written: {folder}/frf.json and figures")
