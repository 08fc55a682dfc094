"""Arguments and options that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

from models.errors import InputError

RigFile = Annotated[Path, typer.Argument(metavar="RIG", help="Rig file (TOML).", show_default=False)]
Records = Annotated[
    list[Path],
    typer.Argument(metavar="RECORD", help="Records: .uff .unv .csv .mat .h5 .hdf5 .npz.", show_default=False),
]
Out = Annotated[
    str | None,
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


def out_folder(out: str | None, file: Path, *written: str) -> Path:
    """Where results go: as asked for, or ``results/<name of the file>``; seen to be open before anything is computed.

    Args:
        out: from ``--out``.
        file: the rig or record that the command is about.
        written: what will be written there, as ``check_open`` takes it.

    Raises:
        InputError: results cannot be written there.
    """
    from testbed.outputs import check_open

    folder = Path("results") / file.stem if out is None else named_folder(out)
    check_open(folder, written)
    return folder


def named_folder(out: str) -> Path:
    """The folder that ``--out`` names; nothing is not taken for the folder one is in.

    Args:
        out: from ``--out``.

    Raises:
        InputError: it is empty, as after a variable that is not set.
    """
    if not out.strip():
        raise InputError(
            f"--out {out!r}", "results go into a folder that has a name", "name one; the folder you are in is --out ."
        )
    return Path(out)
