"""Arguments and options that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

RigFile = Annotated[Path, typer.Argument(metavar="RIG", help="Rig file (TOML).", show_default=False)]
Records = Annotated[
    list[Path],
    typer.Argument(metavar="RECORD", help="Records: .uff .unv .csv .mat .h5 .hdf5 .npz.", show_default=False),
]
Out = Annotated[
    Path | None,
    typer.Option(
        "--out",
        metavar="DIR",
        help="Folder of the results; by default results/ and the name of the first file, demo or study.",
    ),
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Seed of every random choice.")]
Jobs = Annotated[int, typer.Option("--jobs", min=1, help="Threads or processes.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print the JSON, and nothing else, on standard output.")]
Without = Annotated[
    list[str] | None,
    typer.Option("--without", metavar="NAME", help="Leave this channel out; may be repeated.", show_default=False),
]


def out_folder(out: Path | None, file: Path) -> Path:
    """Where results go: as asked for, or ``results/<name of the file>``; seen to be open before anything is computed.

    Args:
        out: from ``--out``.
        file: the rig or record that the command is about.

    Raises:
        InputError: results cannot be written there.
    """
    from testbed.outputs import check_open

    folder = Path("results") / file.stem if out is None else out
    check_open(folder)
    return folder
