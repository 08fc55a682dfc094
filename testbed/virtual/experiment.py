"""An experiment as its TOML file describes it: what drives the rig, what listens, and what nobody mentioned."""

import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from models.errors import InputError
from models.excitations import Lines
from models.rig import EffectEntry, NonNegative, Part, Positive
from models.rig_checks import nearest
from models.rig_file import RECORDS, not_toml

Count = Annotated[int, Field(ge=1, strict=True)]


class Drive(Part):
    """What a rig's excitation does; ``angle``, degrees, turns a force about the beam's axis out of the rig's plane."""

    angle: Annotated[float, Field(ge=-180, le=180, strict=True)] = 0.0


class Placed(Drive):
    """What acts at ``position``, m from the clamp, if not where the rig file has its excitation."""

    position: Positive | None = None


class Multisine(Placed):
    """Periods of a sum of sines of random phase; ``rms`` may be a list of levels, each a record.

    ``lines``: all of a period's spectrum, the odd ones, or the odd ones without one of each four, drawn at random,
    where odd distortion then shows.
    """

    kind: Literal["multisine"]
    low: Positive = 5.0
    high: Positive = 300.0
    rms: Positive | Annotated[tuple[Positive, ...], Field(min_length=1)] = 3.0
    period: Positive = 1.0
    periods: Count = 4
    realisations: Count = 1
    lines: Lines = "full"


class Sweep(Placed):
    """A sine whose frequency grows by equal ratios in equal times."""

    kind: Literal["sweep"]
    low: Positive = 5.0
    high: Positive = 300.0
    amplitude: Positive = 10.0
    duration: Positive = 8.0


class SteppedSine(Placed):
    """Sines one after the other, each for so many cycles and without a jump of phase."""

    kind: Literal["stepped_sine"]
    low: Positive = 5.0
    high: Positive = 300.0
    steps: Count = 40
    cycles: Positive = 20.0
    amplitude: Positive = 5.0


class Hammer(Placed):
    """Blows of half a sine; ``double`` is the share of a second hit ``rebound`` s after each, 0 for none."""

    kind: Literal["hammer"]
    peak: Positive = 100.0
    width: Positive = 2e-3
    blows: Count = 1
    interval: Positive = 2.0
    start: NonNegative = 0.05
    double: Annotated[float, Field(ge=0, le=1, strict=True)] = 0.0
    rebound: Positive = 0.02


class RovingHammer(Drive):
    """The same blow at one place after the other, each a record: ``positions`` are m from the clamp."""

    kind: Literal["roving_hammer"]
    positions: tuple[Positive, ...]
    peak: Positive = 100.0
    width: Positive = 2e-3
    start: NonNegative = 0.05
    duration: Positive = 2.0


class Release(Part):
    """The rig is held down by a force, N, at a position, m, and let go at the first sample."""

    kind: Literal["release"]
    position: Positive
    force: Annotated[float, Field(allow_inf_nan=False, strict=True)]
    duration: Positive = 4.0


class FreeDecay(Placed):
    """A burst of a sine, and the record of what follows it: the excitation is over before it begins."""

    kind: Literal["free_decay"]
    frequency: Positive
    amplitude: Positive = 5.0
    cycles: Positive = 20.0
    duration: Positive = 4.0


AnyExcitation = Multisine | Sweep | SteppedSine | Hammer | RovingHammer | Release | FreeDecay


class SensorTable(Part):
    """A sensor as it is bought and mounted; what is not given is that of the preset, or ideal.

    Units: ``noise_density`` in the sensor's SI unit per root hertz, ``range`` in its SI unit, ``resonance`` in Hz on
    its mount, ``mass`` in kg with its cable on the beam, ``position_error`` in m, ``gain_error`` as a fraction.
    """

    preset: str | None = None
    noise_density: NonNegative | None = None
    range: Positive | None = None
    bits: Annotated[int, Field(ge=4, le=32, strict=True)] | None = None
    resonance: Positive | None = None
    quality: Positive | None = None
    mass: NonNegative | None = None
    position_error: Annotated[float, Field(allow_inf_nan=False, strict=True)] | None = None
    gain_error: Annotated[float, Field(gt=-1, allow_inf_nan=False, strict=True)] | None = None


class Truth(Part):
    """What the rig's owner does not know: numbers off within their tolerance, and effects that nobody mentioned."""

    perturbed: Annotated[bool, Field(strict=True)] = False
    effects: tuple[EffectEntry, ...] = ()


class Experiment(Part):
    """One virtual test campaign.

    Attributes:
        fs: rate of the records, Hz.
        seed: of phases, noise and perturbed numbers.
        excitation: what is done.
        sensors: by the names of the rig's sensors, ``all`` for the rest, ``excitation`` for the excitation's own.
        truth: what the rig file does not say.
    """

    fs: Positive = 2048.0
    seed: Annotated[int, Field(ge=0, strict=True)] = 0
    excitation: Annotated[AnyExcitation, Field(discriminator="kind")]
    sensors: dict[str, SensorTable] = Field(default_factory=dict)
    truth: Truth = Truth()


def read_experiment(path: Path) -> Experiment:
    """The experiment that a TOML file describes.

    Args:
        path: the file.

    Raises:
        InputError: it cannot be read, is not TOML, or describes no experiment; the first problem is told.
    """
    content = _content(path)
    if "structure" in content:
        raise InputError(
            f"{path.name}: a rig file in the place of the experiment",
            "an experiment has an [excitation] with a kind, and no [structure]",
            f"name the rig first and then an experiment; {LOOK}",
        )
    try:
        experiment = Experiment.model_validate(content)
    except ValidationError as error:
        raise _fault(error, path.name) from error
    _check_band(experiment, path.name)
    _check_length(experiment, path.name)
    return experiment


def _content(path: Path) -> dict[str, Any]:
    """The tables of the file, with or without a byte order mark as Windows writes it."""
    if path.suffix.lower() in RECORDS:
        raise InputError(
            f"{path.name}: a record in the place of the experiment",
            "testbed simulate makes records, from a rig file and an experiment (.toml)",
            f"name the experiment second; {LOOK}",
        )
    try:
        return tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}", "an experiment is a TOML file", "correct the path") from error
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path.name}: byte {error.start + 1} is not UTF-8",
            "an experiment is a text in UTF-8",
            "save it from a text editor with that encoding",
        ) from error
    except tomllib.TOMLDecodeError as error:
        raise not_toml(path.name, "an experiment", error, "numbers have no unit") from error


def _check_band(experiment: Experiment, file: str) -> None:
    """A band begins below its end, and a record holds no frequency beyond half its rate."""
    drive, highest = experiment.excitation, 0.5 * experiment.fs
    for key in ("high", "frequency"):
        value = getattr(drive, key, 0.0)
        if value > highest:
            raise InputError(
                f"{file}: excitation.{key} = {value:g} Hz at fs = {experiment.fs:g} Hz",
                f"a record at this rate holds frequencies up to {highest:g} Hz",
                f"{'lower' if key in drive.model_fields_set else 'set a lower'} {key}, or raise fs",
            )
    if isinstance(drive, Multisine | Sweep | SteppedSine) and drive.low >= drive.high:
        raise InputError(
            f"{file}: excitation.low = {drive.low:g} Hz, high = {drive.high:g} Hz",
            "a band begins below its end",
            "give low below high",
        )


MOST_SAMPLES = 1e7
"""Of a record: more than an hour at 2048 Hz, and near a gigabyte in a dozen channels."""


def _check_length(experiment: Experiment, file: str) -> None:
    """A record ends before it fills the memory; seconds that were given in ms ask for a thousand times too many."""
    for key in ("duration", "period", "interval"):
        seconds = getattr(experiment.excitation, key, 0.0)
        if seconds * experiment.fs > MOST_SAMPLES:
            raise InputError(
                f"{file}: excitation.{key} = {seconds:g} s at fs = {experiment.fs:g} Hz",
                f"a record has up to {MOST_SAMPLES:g} samples, {MOST_SAMPLES / experiment.fs:.3g} s at this rate",
                f"give {key} in s and fs in Hz",
            )


EXCITATIONS: dict[str, type[Part]] = {
    "multisine": Multisine,
    "sweep": Sweep,
    "stepped_sine": SteppedSine,
    "hammer": Hammer,
    "roving_hammer": RovingHammer,
    "release": Release,
    "free_decay": FreeDecay,
}

LOOK = "docs/experiments.md lists the keys and their units"

FORMS = {
    "excitation": ("the excitation is one table", "head it with [excitation], in single brackets, and name its kind"),
    "sensors": ("each sensor is a table under its name", "head it with [sensors.NAME], or [sensors.all] for the rest"),
    "truth": ("the truth is one table", "head it with [truth], in single brackets"),
    "effects": ("effects are a list of tables", "head each one with [[truth.effects]], in double brackets"),
    "positions": ("positions are a list of numbers, m", "write it as in positions = [0.3, 0.7]"),
}
"""What is a table or a list, and how it is written."""

FORM_FAULTS = ("model_attributes_type", "model_type", "dict_type", "tuple_type")

RULES = {"bool_type": "it should be true or false, without quotes"}
"""Where the validator's own words are not an engineer's."""


def _fault(error: ValidationError, file: str) -> InputError:
    """The first problem in three parts; of a key that takes one number or a list, that of the list if it was given."""
    # A misspelt key may also be a missing one; the spelling is what its owner has to hear about.
    first = min(error.errors(), key=lambda each: each["type"] != "extra_forbidden")
    if isinstance(first["input"], list):
        there = [each for each in error.errors() if each["loc"][:3] == first["loc"][:3]]
        first = max(reversed(there), key=lambda each: len(each["loc"]))
    keys = [str(key) for key in first["loc"] if key not in EXCITATIONS and not _is_branch(key)]
    where = f"{file}: {'.'.join(keys)}"
    if first["type"] == "extra_forbidden":
        known = _keys_beside(first["loc"])
        near = nearest(keys[-1], known)
        mend = f"did you mean {near}?" if near else FORMS.get(keys[-1], ("", "remove it"))[1]
        return InputError(f"{where} is unknown", f"the keys here are {', '.join(known)}", mend)
    if first["type"] == "missing":
        return InputError(f"{where} is missing", "it has no default", f"add {keys[-1]}; {LOOK}")
    if first["type"].startswith("union_tag"):
        kind = first.get("ctx", {}).get("tag", "none")
        return InputError(f"{where}.kind = {kind}", f"a kind is one of {', '.join(EXCITATIONS)}", "choose one of them")
    form = next((FORMS[key] for key in reversed(keys) if key in FORMS), None)
    if first["type"] in FORM_FAULTS and form is not None:
        return InputError(f"{where} = {_shown(first['input'])}", *form)
    rule = RULES.get(first["type"], first["msg"].replace("Input should", "it should"))
    if _takes_a_list(first["loc"], error):
        rule += ", or a list of them"
    return InputError(f"{where} = {first['input']!r}", rule[0].lower() + rule[1:], LOOK)


def _shown(value: Any) -> str:
    """A value as it stands in the file, a table without its keys."""
    if isinstance(value, list):
        return f"[{', '.join(map(_shown, value))}]"
    return "{...}" if isinstance(value, dict) else repr(value)


def _is_branch(key: str | int) -> bool:
    """Whether a part of a place is the validator's name for one of several types, as ``constrained-float``."""
    return isinstance(key, str) and key.startswith(("constrained-", "tuple["))


def _takes_a_list(place: tuple[str | int, ...], error: ValidationError) -> bool:
    """Whether the key of one number at fault takes a list too, of which the validator complains besides."""
    beside = (each["loc"] for each in error.errors() if each["loc"][: len(place) - 1] == place[:-1])
    return "tuple[" not in str(place) and any("tuple[" in str(loc[-1]) for loc in beside)


def _keys_beside(place: tuple[Any, ...]) -> list[str]:
    """Keys that are known in the table of an unknown one."""
    part: type[Part] = Experiment
    if place[0] == "excitation":
        part = EXCITATIONS[place[1]]
    elif place[0] == "sensors":
        part = SensorTable
    elif place[0] == "truth":
        part = Truth
    return list(part.model_fields)
