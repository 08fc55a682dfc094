"""``testbed cosim``: a plant, an identifier that watches it, and a twin that is told, in lockstep."""

from typing import Annotated

import typer

from testbed.cli.options import AsJson, Out, RigFile, Seed, out_folder
from testbed.cli.progress import progress

EXAMPLE = "Example: testbed cosim rig.toml --start 40 --seconds 5"

Seconds = Annotated[float, typer.Option("--seconds", min=0.1, metavar="S", help="Length of the run.")]
SleeveName = Annotated[
    str | None,
    typer.Option("--sleeve", metavar="NAME", help="Whose damping is followed; one that touches at rest unless given."),
]
Watched = Annotated[
    list[str] | None,
    typer.Option("--channel", metavar="NAME", help="Watch this one; may be repeated; all unless given."),
]
Window = Annotated[
    float | None,
    typer.Option("--window", min=0.0, metavar="S", help="Longest window; chosen from the rig unless given."),
]
Start = Annotated[
    float | None,
    typer.Option(
        "--start", min=0.0, metavar="C", help="Damping the twin starts with, N s/m; the rig's own unless given."
    ),
]
Snr = Annotated[float, typer.Option("--snr", metavar="DB", help="Of the channels to their noise.")]


def cosim(
    rig: RigFile,
    *,
    seconds: Seconds = 20.0,
    sleeve: SleeveName = None,
    channels: Watched = None,
    window: Window = None,
    start: Start = None,
    snr: Snr = 40.0,
    seed: Seed = 0,
    out: Out = None,
    as_json: AsJson = False,
) -> None:
    """Tap the rig, identify a sleeve's damping as it goes, feed it to a twin: cosim.json and a picture."""
    folder = out_folder(out, rig, "cosim.json", "figures/")
    with progress() as tell:
        from testbed.cosim.plan import Wish
        from testbed.cosim.run import cosimulate

        wish = Wish(seconds, sleeve, tuple(channels or ()), window, start, snr, seed)
        content = cosimulate(rig, wish, folder, tell)
    from testbed.cli.tables import print_json, print_table, say

    if as_json:
        print_json(content)
        return
    taps, lag, damping, twin = (content[key] for key in ("taps", "lag", "damping_error", "twin_error"))
    say(
        f"{content['sleeve']} carries {content['rest_force']:.3g} N at rest; taps of {taps['peak']:.3g} N and "
        f"{1e3 * taps['width']:.2g} ms every {taps['period']:.3g} s leave it closed"
    )
    modes = [(i, f"{m['natural_freq']:.3f}", m["damping_ratio"], m["share"]) for i, m in enumerate(content["modes"], 1)]
    print_table(("mode", "frequency [Hz]", "damping ratio at the start", "share of what is known"), modes)
    steady = "not told: the true damping hardly changes during the run"
    aligned = steady if lag["by_alignment"] is None else f"{lag['by_alignment']:.3f}"
    estimates, first = len(content["damping"]["values"]), f"from the first exchange at {damping['fed_back_from']:.3g}"
    begun = f"with {content['start_damping']:.3g} N s/m until then"
    rows = [
        (f"damping as identified, rms error over {estimates} estimates", f"{damping['identified']:.2%}"),
        ("share of the 95 % intervals that hold the truth", f"{damping['coverage']:.1%}"),
        (f"damping as fed back, rms error over time, {first} s on", f"{damping['fed_back']:.2%}"),
        (f"damping the twin moved with, rms error over the whole run, {begun}", f"{damping['moved_with']:.2%}"),
        ("lag, by the age of what is fed back [s]", f"{lag['by_window']:.3f}"),
        ("lag, by the best alignment with the truth [s]", aligned),
        ("twin that is told, NRMSE over the whole run", f"{twin['told']:.2%}"),
        ("twin that is told nothing, NRMSE over the whole run", f"{twin['alone']:.2%}"),
        ("seconds of motion for a second of computing", f"{content['real_time_factor']:.1f}"),
    ]
    print_table(("what", "value"), rows)
    for finding in content["findings"]:
        say(f"note: {finding}")
    say(f"written: {folder}/cosim.json and figures/cosim.png")
