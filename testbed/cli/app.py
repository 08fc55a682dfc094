"""All commands together, and what becomes of an error: one message in three parts and exit status 2."""

import sys
from collections.abc import Sequence
from typing import Annotated

import typer
from typer.main import get_command

from models.errors import InputError
from testbed import __version__
from testbed.cli import (
    add,
    benchmark,
    budget,
    check,
    compare,
    cosim,
    crosscheck,
    demo,
    diagnose,
    effects,
    film,
    frf,
    history,
    identify,
    modes,
    simulate,
    study,
    sweep,
    undo,
)
from testbed.cli.usage import FiniteCommand, usage_words

app = typer.Typer(name="testbed", add_completion=False, pretty_exceptions_enable=False)

for module, command in (
    (demo, demo.demo),
    (check, check.check),
    (compare, compare.compare),
    (diagnose, diagnose.diagnose),
    (add, add.add),
    (history, history.history),
    (undo, undo.undo),
    (modes, modes.modes),
    (frf, frf.frf),
    (sweep, sweep.sweep),
    (budget, budget.budget),
    (identify, identify.identify),
    (simulate, simulate.simulate),
    (film, film.film),
    (cosim, cosim.cosim),
    (crosscheck, crosscheck.crosscheck),
    (effects, effects.effects),
):
    app.command(cls=FiniteCommand, epilog=module.EXAMPLE)(command)
app.add_typer(study.study, name="study")
app.add_typer(benchmark.benchmark, name="benchmark")

BAD_INPUT, INTERRUPTED = 2, 130

RESUMING = (("simulate",), ("demo",), ("benchmark",), ("study", "article"))
"""Commands that keep each record, case or part as it is done; all others write at their end."""

# typer brings its own click or uses the installed one; the ancestors of its BadParameter are those of whichever it is.
UsageErrors: tuple[type[Exception], ...] = tuple(k for k in typer.BadParameter.__mro__ if k.__name__ == "UsageError")


@app.callback(invoke_without_command=True)
def root(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    """From a test record to the missing physics, for beams that rest in clearance sleeves."""
    if version:
        print(f"testbed {__version__}")
    elif context.invoked_subcommand is None:
        print(context.get_help())


def main(arguments: Sequence[str]) -> int:
    """Run one command and return its exit status.

    Args:
        arguments: as typed after ``testbed``.
    """
    try:
        status = get_command(app).main(args=list(arguments), prog_name="testbed", standalone_mode=False)
    except InputError as error:
        return _refuse(str(error))
    except UsageErrors as error:
        return _refuse(usage_words(error))
    except ArithmeticError as error:
        return _refuse(
            f"the computation left the finite numbers: {error}; a passive rig stays finite under its measured "
            "excitation; check the rig's numbers and the record's units with testbed check"
        )
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        return _refuse(f"{where}{error.strerror or error}; files can be read and written; check the path and its space")
    except (KeyboardInterrupt, typer.Abort):
        status = INTERRUPTED
    if status == INTERRUPTED:  # newer versions of typer turn an interrupt into this status themselves
        print(_stopped(arguments), file=sys.stderr)
    return status if isinstance(status, int) else 0


def _stopped(arguments: Sequence[str]) -> str:
    """What becomes of the work when somebody stops a command."""
    if any(tuple(arguments[: len(words)]) == words for words in RESUMING):
        return "stopped; whatever was finished is kept, and the same command goes on from there"
    return "stopped; nothing was written, a new start begins anew"


def _refuse(message: str) -> int:
    print(message, file=sys.stderr)
    return BAD_INPUT


def run() -> None:
    """Run what was typed and leave with its exit status."""
    sys.exit(main(sys.argv[1:]))
