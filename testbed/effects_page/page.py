"""The page of effects as Markdown, from the library alone: no number on it is computed."""

import inspect
import re
from collections.abc import Iterator, Mapping
from math import inf

from models.effects import EFFECTS, Effect, Registry
from models.effects.protocol import Family, Parameter, Signature, StructureKind
from testbed.effects_page.bench import BAND, LEVELS
from testbed.effects_page.table import table_of

FIGURES = "figures/effects"
"""Folder of the pictures beside the page."""

COMMAND = "testbed effects --out docs"

FAMILIES: Mapping[Family, tuple[str, str]] = {
    "point force": ("A force at a place, or the contact of a sleeve", "what it does"),
    "structure": ("The linear structure", "change"),
    "time": ("In time", "change"),
    "measurement": ("In the measurement, not in the rig", "change"),
}
"""Heading of each family's table and of the column that says what an effect does."""

LETTERS: Mapping[StructureKind, str] = {"beam": "B", "oscillator": "O"}

HEAD = f"""\
# The effects: what a rig may hide

An effect is one piece of physics that a rig file does not describe yet: a gap that is wider than drawn, grease,
friction, a sensor mounted upside down. A diagnosis names effects in these words, `testbed add` puts one in by hand, and
a rig file keeps them:

```toml
[[effects]]
kind = "squeeze_film"
sleeve = "sleeve 2"      # or position = 0.83, or sensor = "P3", as the tables say
damping = 18.5           # every parameter in SI units, angles in rad
```

Each kind has such a table below, complete, with numbers that a rig could have: copy it and change them. Tables,
signatures and pictures are made from the library by `{COMMAND}`.

## The frame

- `q` is the beam's displacement at the effect's place, m, positive up, measured from the straight unloaded axis:
  gravity's sag is included. `v` is its velocity. `F` is the force on the beam, N.
- `q` and `v` are relative to the base, that is the clamp and the sleeves, which move together where the base is driven.
  `against = "ground"` makes them absolute.
- Time starts at each record's first sample. At rest friction and hysteresis carry no force (`z = 0`).
- A sensor pair is `sensor` and `other`, whichever comes first.
- A sleeve and its position are the same place. On an oscillator there is one place only, so `position` is left out,
  also where a table says "position"; an effect of a sensor still names it.
- Effects act in the order of the file. Those that change a sleeve (its clearance, offset, stiffness, damping) change
  what another effect there sees, wherever it stands in the file; of two that replace the same thing the last counts.
- `p` is the penetration of a sleeve's contact and `k p` the elastic part of its force.
- Rayleigh damping follows the changed mass and stiffness of the beam, without point springs, dashpots and absorbers.
- A table of numbers has one value for each time, and its times grow: `times = [0.0, 2.0, 5.0]` beside
  `values = [90.0, 40.0, 20.0]`.

The column *on* says whether the kind acts on a beam (B), an oscillator (O) or both.
"""

PICTURES = f"""\
## What each does, and how it shows

Each picture sets the reference rig with one effect against the rig without it, both under the same multisines of
{BAND[0]:g} to {BAND[1]:g} Hz, at {LEVELS["low"]:g} and at {LEVELS["high"]:g} N rms. The effect is a trial value of its
kind, scaled so that it shows. From left to right:

- response over force at the sensor whose channel changes most, in its own unit, at the low and at the high level;
- the change of each channel along the beam, as a share of its rms; grey bars are sleeves, the triangle is the effect;
- below, two views of what changed: its force over motion and speed, the force in its sleeve, the natural frequencies
  and damping ratios of the beam without sleeves, or the channel as read over the channel as it was;
- the change of all channels through the record, as a share of the response.

What a picture shows is one case: on the reference rig impacts carry a change that begins in one sleeve to the other. A
kind that cannot sit on a beam is shown on an oscillator of 30 Hz.
"""

TAIL = """\
## What cannot be told apart

Some kinds are one and the same in some data: on an oscillator a `modal_damping` above 1 and a `point_damping`, or a
`bouc_wen` far below its yield displacement and a `point_stiffness`. A diagnosis lists what it cannot tell apart.

Each kind's formula with its source stands in `models/effects/<kind>.py`; a new one is explained in
[extending.md](extending.md).
"""


def page_of(registry: Registry = EFFECTS) -> str:
    """The page.

    Args:
        registry: kind -> class.
    """
    parts = [HEAD, *_tables(registry), PICTURES, *(_section(kind) for kind in registry.values()), TAIL]
    return "\n".join(parts)


def words_of(kind: type[Effect]) -> str:
    """What an effect is, as its class says: paragraphs without what is raised, in Markdown.

    Args:
        kind: of the library.
    """
    text = inspect.getdoc(kind) or ""
    text = re.split(r"\n\n(?:Raises|Attributes|Args):", text)[0]
    return text.replace("``", "`")


def parameters_of(kind: type[Effect]) -> str:
    """Parameters with their units, in the order of the class, or a dash.

    Args:
        kind: of the library.
    """
    return ", ".join(f"`{name}` {about.unit}" for name, about in kind.parameters().items()) or "-"


def place_of(kind: type[Effect]) -> str:
    """What the place of an effect may be, or a dash.

    Args:
        kind: of the library.
    """
    return " or ".join(kind.places) or "-"


def signature_lines(signature: Signature) -> Iterator[tuple[str, str]]:
    """(aspect, where it shows in it).

    Args:
        signature: of a kind.
    """
    yield from vars(signature).items()


def _tables(registry: Registry) -> Iterator[str]:
    for family, (heading, change) in FAMILIES.items():
        members = [kind for kind in registry.values() if kind.family == family]
        lines = [f"## {heading}", "", f"| kind | place | on | {change} | parameters |", "|---|---|---|---|---|"]
        yield "\n".join([*lines, *(_row(kind) for kind in members), ""])


def _row(kind: type[Effect]) -> str:
    on = " ".join(LETTERS[structure] for structure in kind.structures)
    what = words_of(kind).split("\n\n")[0].replace("\n", " ").replace("|", "\\|").rstrip(".")
    return (
        f"| [`{kind.kind}`](#{kind.kind}) | {place_of(kind)} | {on} | {what}{_options(kind)} | {parameters_of(kind)} |"
    )


def _options(kind: type[Effect]) -> str:
    quoted = {key: " or ".join(f'"{value}"' for value in values) for key, values in kind.options.items()}
    return "".join(f"; `{key}` {values}" for key, values in quoted.items())


def _section(kind: type[Effect]) -> str:
    numbers = "; ".join(_number(kind, name, about) for name, about in kind.parameters().items())
    lines = [
        f"### {kind.kind}",
        "",
        words_of(kind),
        "",
        *(f"- **{aspect}**: {text}" for aspect, text in signature_lines(kind.signature)),
        "",
        f"![{kind.kind}: where it shows and what it does]({FIGURES}/{kind.kind}.png)",
        "",
        f"Parameters: {numbers or 'none'}{_options(kind)}. Source: {kind.source}.",
        "",
        "```toml",
        table_of(kind),
        "```",
        "",
    ]
    return "\n".join(lines)


def _number(kind: type[Effect], name: str, about: Parameter) -> str:
    """One parameter with its unit, bounds and default."""
    if about.upper < inf:
        bounds = f", {about.lower:g} to {about.upper:g}"
    elif about.lower == 0.0:
        bounds = ", 0 or more"
    else:
        bounds = ", above 0" if about.lower > 0.0 else ""
    default = f", {getattr(kind, name):g} unless given" if kind.has_default(name) else ""
    return f"`{name}` {about.unit}{', a list' if about.table else ''}{bounds}{default}"
