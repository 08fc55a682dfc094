"""``testbed identify``: instantaneous frequency and damping of a free decay."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from testbed.cli.options import AsJson, Out, Seed, Without, out_folder
from testbed.cli.progress import progress

EXAMPLE = "Example: testbed identify decay.csv --channel P8 --rig rig.toml"

RecordFile = Annotated[Path, typer.Argument(metavar="RECORD", help="A time record with a decay.", show_default=False)]
Names = Annotated[
    list[str] | None,
    typer.Option("--channel", metavar="NAME", help="Look at this channel; may be repeated; all unless named."),
]
RigOption = Annotated[Path | None, typer.Option("--rig", metavar="RIG", help="Name sensors by this rig file.")]
Excitation = Annotated[
    str | None, typer.Option("--excitation", metavar="NAME", help="Channel of the excitation, without a rig.")
]
Begin = Annotated[float | None, typer.Option("--from", min=0.0, metavar="S", help="Begin of the decay.")]
End = Annotated[float | None, typer.Option("--to", min=0.0, metavar="S", help="End of the decay.")]
Band = Annotated[
    tuple[float, float] | None, typer.Option("--band", metavar="LOW HIGH", help="Look at this band alone, Hz.")
]
Freqs = Annotated[
    list[float] | None, typer.Option("--mode", min=0.0, metavar="HZ", help="About where a mode is; may be repeated.")
]
Denoising = Annotated[
    Literal["none", "wavelet", "ensemble"],
    typer.Option("--denoise", help="Before all else: wavelet thresholds, or the ensemble EMD and then these."),
]
Mass = Annotated[
    float | None, typer.Option("--mass", min=0.0, metavar="KG", help="Equivalent mass of the first mode, for c(t).")
]
Sleeve = Annotated[
    str | None,
    typer.Option("--sleeve", metavar="NAME", help="Whose damping c(t) it is: adds time_varying_damping to the rig."),
]


def identify(
    record: RecordFile,
    *,
    channel: Names = None,
    rig: RigOption = None,
    excitation: Excitation = None,
    begin: Begin = None,
    end: End = None,
    band: Band = None,
    mode: Freqs = None,
    denoise: Denoising = "none",
    mass: Mass = None,
    sleeve: Sleeve = None,
    out: Out = None,
    without: Without = None,
    seed: Seed = 0,
    as_json: AsJson = False,
) -> None:
    """Frequency and damping over time with intervals, and what they depend on: identification.json and figures."""
    folder = out_folder(out, record, "identification.json", "rig.updated.toml", "figures/")
    with progress() as tell:
        from identification.decay.attempt import Settings
        from testbed.identify.run import Order, run_identification

        settings = Settings(band, tuple(mode or ()), denoise, seed=seed)
        order = Order(record, rig, tuple(channel or ()), excitation, tuple(without or ()), begin, end, mass, sleeve)
        content = run_identification(order, settings, folder, progress=tell)
    from testbed.cli.tables import ONE_STD, measured, print_json, print_table, say

    if as_json:
        print_json(content)
        return
    heads = ("decay", "mode", f"frequency {ONE_STD} [Hz]", f"damping ratio {ONE_STD} [%]", "followed [s]")
    rows = [
        (
            d + 1,
            m + 1,
            measured({"value": row["natural_freq"], "std": row["natural_freq_std"]}),
            measured({"value": 100 * row["damping_ratio"], "std": 100 * row["damping_ratio_std"]}),
            f"{row['frequency']['time'][-1]:.3g}",
        )
        for d, decay in enumerate(content["decays"])
        for m, row in enumerate(decay["modes"])
    ]
    print_table(heads, rows)
    for finding in content["findings"]:
        say(f"note: {finding}")
    updated = ", rig.updated.toml" if sleeve is not None else ""
    say(f"written: {folder}/identification.json{updated} and figures")
