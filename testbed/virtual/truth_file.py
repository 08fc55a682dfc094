"""The truth of an earlier virtual test, so that the next one is carried out on the very same rig."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from models.effects import EFFECTS, Effect, build_effect
from models.errors import InputError, in_file
from models.rig import EffectEntry, Rig
from testbed.virtual.experiment import Experiment, Truth
from testbed.virtual.laboratory import Laboratory

RULE = "truth.toml, which testbed simulate writes, says what was tested"


@dataclass(frozen=True)
class KnownTruth:
    """What was really tested.

    Attributes:
        file: its name, for errors.
        parameters: of the rig as built, by path.
        positions: where sensors really sit, m from the clamp, by name.
        effects: that the rig file does not mention, the masses of sensors among them.
    """

    file: str
    parameters: Mapping[str, float]
    positions: Mapping[str, float]
    effects: tuple[EffectEntry, ...]


def read_truth(path: Path) -> KnownTruth:
    """The content of a ``truth.toml``.

    Args:
        path: of the file.

    Raises:
        InputError: it cannot be read or says nothing of a rig as built.
    """
    try:
        content: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
        effects = tuple(EffectEntry(**table) for table in content["effects"])
        return KnownTruth(path.name, dict(content["parameters"]), dict(content.get("sensor_positions", {})), effects)
    except OSError as error:
        raise InputError(f"--truth {path}: {error.strerror}", RULE, "correct the path") from error
    except KeyError as missing:
        raise InputError(f"--truth {path}: {missing.args[0]} is missing", RULE, "name that file") from missing
    except (ValueError, TypeError, ValidationError) as error:
        raise InputError(f"--truth {path}: it cannot be read as such ({error})", RULE, "name that file") from error


def on_the_same_rig(laboratory: Laboratory, experiment: Experiment, truth: KnownTruth) -> Laboratory:
    """The laboratory of another experiment with the rig as an earlier one had built it.

    Args:
        laboratory: of the experiment, whose own truth is none.
        experiment: that is carried out.
        truth: of the earlier one.

    Raises:
        InputError: the experiment has a truth of its own, or the file is that of another rig.
    """
    if experiment.truth != Truth():
        raise InputError(
            "[truth] beside --truth", "a rig was built once", "take [truth] out of the experiment, or leave --truth out"
        )
    rig = laboratory.rig
    return replace(laboratory, built=_built(rig, truth), hidden=_hidden(rig, truth))


def _built(rig: Rig, truth: KnownTruth) -> Rig:
    known = {parameter.path for parameter in rig.parameters()}
    strange = [path for path in truth.parameters if path not in known]
    if strange:
        raise InputError(
            f"{truth.file}: parameters.{strange[0]}",
            f"the toleranced numbers of this rig are {', '.join(known) or 'none'}",
            "take the rig file and the truth of the same test",
        )
    sensors = [
        sensor.model_copy(update={"position": truth.positions.get(sensor.name, sensor.position)})
        for sensor in rig.sensors
    ]
    return rig.with_values(truth.parameters).model_copy(update={"sensors": tuple(sensors)})


def _hidden(rig: Rig, truth: KnownTruth) -> tuple[Effect, ...]:
    with in_file(truth.file):
        entries = enumerate(truth.effects)
        return tuple(build_effect(entry, rig, EFFECTS, f"effects[{i}]") for i, entry in entries)
