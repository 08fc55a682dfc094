"""CSV: a header of ``name [unit]``, one row a sample; a column ``time [s]``, or ``# fs = 2048`` above the header."""

import codecs
import csv
import re
from pathlib import Path

import numpy as np

from models.arrays import FloatArray
from models.errors import InputError
from testbed.records.headings import check_brackets
from testbed.records.recording import RawChannel, Recording, Tag, headed
from testbed.records.units import is_unit

HOLDS = 'a header of "name [unit]" and one row of numbers for each sample'

_SETTING = re.compile(r"#\s*(fs|excitation_position)\s*[=:]\s*(\S+).*")
_TIME_NAMES = ("time", "t")
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_BRACKETS = re.compile(r"^\s*[\[(]?\s*|\s*[\])]?\s*$")
"""Around a unit in a cell of its own."""

_WITHOUT_POINT = re.compile(r"[-+]?\d+([eE][-+]?\d+)?")


def read(path: Path) -> Recording:
    """All columns as channels.

    Args:
        path: separated by comma, semicolon or tab; with semicolons, decimal commas are understood.

    Raises:
        InputError: no header, a unit in round brackets, a row of another length, a cell that is no number.
    """
    lines = [line for line in _text(path).splitlines() if line.strip()]
    settings = {m[1]: m[2] for line in lines if (m := _SETTING.fullmatch(line.strip()))}
    lines = [line for line in lines if not _SETTING.fullmatch(line.strip())]
    header, rows = _split(lines, path.name)
    separator = max(";\t,", key=header.count)
    _check_separator(header, rows, separator, path.name)
    tags = [headed(cell) for cell in next(csv.reader([header], delimiter=separator))]
    check_brackets(tags, path.name)
    values = _numbers(rows, separator, tags, path.name)
    time_at = next((i for i, tag in enumerate(tags) if (tag.name or "").lower() in _TIME_NAMES), None)
    return Recording(
        path.name,
        tuple(RawChannel(tag, values[:, i]) for i, tag in enumerate(tags) if i != time_at),
        fs=_setting(settings, "fs", path.name),
        time=None if time_at is None else values[:, time_at],
        time_unit=None if time_at is None else tags[time_at].unit,
        excitation_position=_setting(settings, "excitation_position", path.name),
    )


def write(recording: Recording, path: Path) -> None:
    """A time column in s and one column a channel, with digits enough to read back the same doubles.

    Args:
        recording: with ``fs``.
        path: written in place.
    """
    assert recording.fs is not None
    columns = [np.arange(len(recording.channels[0].data)) / recording.fs, *(c.data for c in recording.channels)]
    headings = ["time [s]", *(f"{c.tag.name} [{c.tag.unit}]" for c in recording.channels)]
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(f"# fs = {recording.fs!r} Hz\n")
        if recording.excitation_position is not None:
            file.write(f"# excitation_position = {recording.excitation_position!r} m\n")
        csv.writer(file, lineterminator="\n").writerow(headings)
        np.savetxt(file, np.column_stack(columns), fmt="%.17g", delimiter=",")


def _text(path: Path) -> str:
    content = path.read_bytes()
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return _utf_16(content, path.name)
    if b"\0" in content:
        raise InputError(f"{path.name}: holds binary data", f"a .csv file has {HOLDS}", "check the file's suffix")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        # Older Windows programs write µ and ² so.
        return content.decode("cp1252", errors="replace")


def _utf_16(content: bytes, file: str) -> str:
    """What spreadsheets call Unicode text."""
    try:
        return content.decode("utf-16")
    except UnicodeDecodeError as error:
        raise InputError(
            f"{file}: byte {error.start + 1} is not UTF-16, as which the file begins",
            f"a .csv file has {HOLDS}",
            "the file may be cut short: export it again, in UTF-8",
        ) from None


def _split(lines: list[str], file: str) -> tuple[str, list[str]]:
    """The header and the rows; a header behind ``#``, as numpy writes it, counts where no other stands."""
    comments = [line for line in lines if line.lstrip().startswith("#")]
    body = [line for line in lines if not line.lstrip().startswith("#")]
    if body and not _begins_with_number(body[0]):
        _check_nothing_above(body, file)
        header, rows = body[0], body[1:]
    elif comments:
        header, rows = comments[-1].lstrip().lstrip("#"), body
    else:
        header, rows = "", []
    if not rows:
        what = "has no header" if body and not header else "has no samples"
        raise InputError(
            f"{file}: {what}", f"a .csv record has {HOLDS}", "write time [s],P1 [m/s^2],... above the numbers"
        )
    return header, rows


def _begins_with_number(line: str) -> bool:
    return _is_number(re.split(r"[;\t,]", line)[0])


def _check_nothing_above(body: list[str], file: str) -> None:
    """Whether the header comes first: what a recorder's maker writes above it has other cells than the numbers."""
    numbers = next((i for i, line in enumerate(body) if _begins_with_number(line)), 0)
    separator = next((each for each in ";\t" if each in body[numbers]), ",")
    rows = [next(csv.reader([line], delimiter=separator), []) for line in body[:numbers]]
    width = body[numbers].count(separator) + 1
    heads = [i for i, row in enumerate(rows) if len(row) == width and not any(map(_is_number, row))]
    if not heads or heads[0] == 0:
        return
    stand = "1 line stands" if heads[0] == 1 else f"{heads[0]} lines stand"
    raise InputError(
        f"{file}: {stand} above the header, as {body[0].strip()[:40]!r}",
        "a .csv record begins with its header, but for lines that begin with #",
        "remove them, or begin each with #",
    )


def _check_separator(header: str, rows: list[str], separator: str, file: str) -> None:
    """Whether the values stand apart by one that is known, and by nothing behind the last of them."""
    if separator not in header and len(rows[0].split()) > 1:
        raise InputError(
            f"{file}: blanks stand between the values, as in {rows[0].strip()[:40]!r}",
            "the values of a .csv file stand apart by commas, semicolons or tabs",
            "export with one of these, the header alike",
        )
    if rows[0].rstrip(" ").endswith(separator) and all(row.rstrip(" ").endswith(separator) for row in rows):
        raise InputError(
            f"{file}: a {separator!r} stands at the end of each line",
            "separators stand between the values",
            "remove it there, or name the channel that is missing",
        )


def _numbers(rows: list[str], separator: str, tags: list[Tag], file: str) -> FloatArray:
    """(N, n_columns)."""
    if separator == ";":
        rows = [row.replace(",", ".") for row in rows]
    try:
        values = np.loadtxt(rows, delimiter=separator, ndmin=2, comments=None, quotechar='"')
    except ValueError as error:
        raise _bad_row(rows, separator, tags, file) from error
    if values.shape[1] != len(tags):
        raise _bad_row(rows, separator, tags, file)
    return np.asarray(values, float)


def _bad_row(rows: list[str], separator: str, tags: list[Tag], file: str) -> InputError:
    """The first row that is too short, too long or no row of numbers."""
    for sample, row in enumerate(rows):
        cells = next(csv.reader([row], delimiter=separator))
        if separator == "," and _are_halves(cells, len(tags)):
            return _decimal_commas(f"{file}: sample {sample} has {len(cells)} values, the header {len(tags)}")
        if len(cells) != len(tags):
            return InputError(
                f"{file}: sample {sample} has {len(cells)} values, the header {len(tags)}",
                "all channels are equally long",
                "complete the row, or cut the record before it",
            )
        for tag, cell in zip(tags, cells, strict=True):
            if not _is_number(cell):
                if sample == 0 and any(is_unit(_BRACKETS.sub("", each)) for each in cells):
                    return _units_below(tags, cells, separator, file)
                given = f'{file}: channel {tag.shown}, sample {sample} is "{cell.strip()[:40]}"'
                if _is_number(cell.replace(",", ".")):
                    return _decimal_commas(given)
                return InputError(
                    given,
                    "a sample is a number",
                    "repair the sample, or cut the record before it",
                )
    return InputError(f"{file}: cannot be read", f"a .csv file has {HOLDS}", "check the file's suffix")


def _units_below(tags: list[Tag], cells: list[str], separator: str, file: str) -> InputError:
    """What to say of a line of units of its own, as many recorders export it."""
    headings = [f"{tag.name} [{_BRACKETS.sub('', cell)}]" for tag, cell in zip(tags, cells, strict=True)]
    return InputError(
        f"{file}: the line below the header is {separator.join(cells)[:60]!r}",
        "units stand in the header, in square brackets behind the names",
        f"make one line of the two: {separator.join(headings)[:120]}",
    )


def _are_halves(cells: list[str], n_columns: int) -> bool:
    """Whether numbers with decimal commas were taken apart: too many cells, and a point in none of them."""
    return len(cells) > n_columns and all(_WITHOUT_POINT.fullmatch(cell.strip()) for cell in cells)


def _decimal_commas(given: str) -> InputError:
    return InputError(
        given,
        "decimals take a point where commas or tabs stand between the values; these look like decimal commas",
        "export with decimal points, or with semicolons between the values",
    )


def _is_number(cell: str) -> bool:
    text = cell.strip().strip('"').lower()
    return bool(_NUMBER.fullmatch(text)) or text.lstrip("+-") in ("nan", "inf", "infinity")


def _setting(settings: dict[str, str], key: str, file: str) -> float | None:
    if key not in settings:
        return None
    try:
        return float(settings[key])
    except ValueError:
        raise InputError(f"{file}: {key} = {settings[key]}", f"{key} is a number", "correct the comment line") from None
