"""A wrong option or argument in three parts, whatever the library that reads the command line says of it."""

from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any

from typer.core import TyperCommand

from models.errors import InputError

NUMBERS = {"float": "a number", "int": "a whole number"}

RULES: dict[str, Callable[[Mapping[str, Any]], str]] = {
    "greater_than": lambda context: f"above {context['gt']:g}",
    "greater_than_equal": lambda context: f"{context['ge']:g} or more",
    "less_than": lambda context: f"below {context['lt']:g}",
    "less_than_equal": lambda context: f"{context['le']:g} or less",
    "value_error": lambda context: f"one of{str(context['error']).rstrip('.').partition(' is not one of')[2]}".replace(
        "'", ""
    ),
}
"""What a value has to be, by the kind of its fault."""


class FiniteCommand(TyperCommand):
    """A command whose numbers are finite: ``nan`` and ``inf`` read as numbers, and no computation survives them."""

    def invoke(self, ctx: Any) -> Any:
        """Run it.

        Raises:
            InputError: an option that is no number.
        """
        for option in self.params:
            value = ctx.params.get(option.name or "")
            numbers = value if isinstance(value, list | tuple) else [value]
            for wrong in (number for number in numbers if isinstance(number, float) and not isfinite(number)):
                raise InputError(
                    f"{ctx.command_path}: {option.opts[0]} {wrong}",
                    "a number is finite",
                    f"correct it, or see {ctx.command_path} --help",
                )
        return super().invoke(ctx)


def usage_words(error: BaseException) -> str:
    """What was typed, what is expected, and where to look.

    Args:
        error: typer's, of an unknown command or option, or of a value that it does not take.
    """
    context = getattr(error, "ctx", None)
    command = context.command_path if context is not None else "testbed"
    value = _value(error)
    if value is not None:
        given, rule = value
        return f"{command}: {given}; it is {rule}; correct it, or see {command} --help"
    message = error.format_message() if hasattr(error, "format_message") else str(error)
    if context is not None and not message.strip():
        commands = ", ".join(context.command.list_commands(context))
        return f"{command}: nothing was named; it takes one of {commands}; see {command} --help"
    if context is not None and message.startswith("Missing"):
        return f"{command}: {message.rstrip('.')}; {_usage(context)}; {context.command.epilog}"
    return f"{command}: {message.rstrip('.')}; a command takes what its help shows; see {command} --help"


def _usage(context: Any) -> str:
    """How a command is called, with the options that it cannot do without."""
    needed = [
        f"{option.opts[0]} {option.metavar or option.type.name.upper()}"
        for option in context.command.params
        if option.required and option.param_type_name == "option"
    ]
    *pieces, last = context.command.collect_usage_pieces(context)
    arguments = [piece.replace("{", "").replace("}", "") for piece in (*pieces[1:], last)]
    return " ".join(["usage:", context.command_path, *arguments, *needed, "[OPTIONS]"])


def _value(error: BaseException) -> tuple[str, str] | None:
    """A value and what it has to be; None where something else is wrong, or in unknown words."""
    from pydantic import ValidationError

    cause, option = error.__cause__, getattr(error, "param", None)
    if not isinstance(cause, ValidationError) or option is None:
        return None
    fault = cause.errors(include_url=False)[0]
    rule = NUMBERS.get(fault["type"].partition("_")[0])
    if fault["type"] in RULES:
        rule = RULES[fault["type"]](fault.get("ctx", {}))
    if rule is None or rule == "one of":
        return None
    return f"Invalid value for {option.get_error_hint()}: {fault['input']}", rule
