"""One effect added by hand, over files: the updated rig, its comparison and its place in the history."""

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from identification.calibrate import strained
from identification.outcome import effect_estimates, rig_estimates
from models.effects import EFFECTS, Effect
from models.effects.build import KEYS
from models.errors import InputError
from models.record import Record
from models.rig import EffectEntry, Rig
from models.rig_parts import term
from testbed.add import Added, add_effect, pattern_of
from testbed.compare_run import write_comparison
from testbed.history import Model, check_history, remember
from testbed.inputs import Inputs
from testbed.loop import estimate_json, identity, rig_of
from testbed.outputs import Json, staged
from testbed.whole_rig import whole_rig


@dataclass(frozen=True, eq=False)
class AddedByHand:
    """What was added.

    Attributes:
        effect: fitted.
        models: as given, then with the effect.
        comparison: the content of ``compare.json``, of the latter, with the numbers of the effect under ``added`` and
            those of the rig under ``calibrated``.
    """

    effect: Effect
    models: tuple[Model, Model]
    comparison: Json


def numbers_of(added: Added) -> Json:
    """The fitted numbers with their standard deviations: the effect's, and those of the rig that moved with it.

    Args:
        added: finished.
    """
    given = {parameter.path: parameter for parameter in added.before.rig.parameters()}
    effect = effect_estimates(added.fit, len(added.after.effects) - 1)
    at_the_end = {unknown.parameter.path for unknown in strained(added.fit)}
    return {
        "added": {**identity(added.effect), "parameters": {row.name: estimate_json(row) for row in effect}},
        "calibrated": {
            row.name: {
                **estimate_json(row),
                "label": given[row.name].label,
                "held": row.name in at_the_end,
                "given": given[row.name].value,
                "sigmas": given[row.name].deviations(float(np.max(row.value))),
            }
            for row in rig_estimates(added.fit)
        },
    }


def check_order(rig: Path, kind: str) -> None:
    """See that the rig file is named before the kind.

    Args:
        rig: file.
        kind: of the effect.

    Raises:
        InputError: they were exchanged.
    """
    if str(rig) in EFFECTS and not rig.exists():
        raise InputError(
            f"{rig}: a kind of effect in the place of the rig",
            "the rig file comes first, then the kind",
            f"write testbed add {kind} {rig}",
        )


def check_effect(rig_path: Path, kind: str, settings: Mapping[str, Any]) -> None:
    """Whether a rig can have an effect, before its records are read.

    Args:
        rig_path: the rig file.
        kind: of the effect.
        settings: its place and options.

    Raises:
        InputError: a rig file with errors, or an effect that does not fit the rig.
    """
    rig = whole_rig(rig_path)
    _check_place(rig, kind, settings)
    pattern_of(rig, _entry(kind, settings))


PLACED = tuple(dict.fromkeys(key for keys in KEYS.values() for key in keys))
"""What says where an effect sits."""


def _check_place(rig: Rig, kind: str, settings: Mapping[str, Any]) -> None:
    """Refuse a kind that was told no place of its own, in the words of the command's options."""
    if kind not in EFFECTS or rig.structure.kind != "beam":
        return
    places, given = EFFECTS[kind].places, [key for key in PLACED if key in settings]
    if given in [list(KEYS[place]) for place in places] or not (places or given):
        return
    options = " and ".join(f"--{key}" for key in given)
    sleeves, sensors = (", ".join(part.name for part in parts) for parts in (rig.sleeves, rig.sensors))
    ways = {
        "sleeve": f"--sleeve NAME: {sleeves or 'this rig has none'}",
        "position": f"--position M, up to {getattr(rig.structure, 'length', 0.0):g}",
        "sensor": f"--sensor NAME: {sensors}",
        "sensor pair": f"--sensor NAME --other NAME: {sensors}",
    }
    raise InputError(
        f"{kind} with {options}" if given else f"{kind} without a place",
        f"it sits at one {' or '.join(places)}" if places else "it has no place",
        f"give {', or '.join(ways[place] for place in places)}" if places else f"leave {options} out",
    )


def _entry(kind: str, settings: Mapping[str, Any]) -> EffectEntry:
    """An effect as a rig file's table would name it."""
    try:
        return EffectEntry(kind=kind, **settings)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = str(first["loc"][0])
        words = term(EffectEntry, key)
        given = f"new effect.{key} = {first['input']} {words.unit}".rstrip()
        raise InputError(given, words.rule, words.mend) from None


def run_add(
    inputs: Inputs, kind: str, settings: Mapping[str, Any], out: Path, *, seed: int, jobs: int, command: Sequence[str]
) -> AddedByHand:
    """Add one effect, fit it, and write the result.

    Args:
        inputs: rig and the records to fit to.
        kind: of the effect.
        settings: its place and options.
        out: folder of the results.
        seed: of the noise that is carried through the model.
        jobs: cores.
        command: as typed, for the history.

    Raises:
        InputError: an effect that does not fit the rig, a record without time histories, a folder that cannot be
            written.
        ArithmeticError: the motion left the finite numbers.
    """
    timed = [record for record in inputs.records if isinstance(record, Record)]
    if len(timed) < len(inputs.records):
        names = ", ".join(r.name for r in inputs.records if not isinstance(r, Record))
        raise InputError(f"--fit {names}", "an effect is fitted to time records", "name time records only")
    check_history(out)
    added = add_effect(inputs.rig, _entry(kind, settings), timed, seed=seed, jobs=jobs)
    given, updated = added.comparison_before.score, added.comparison_after.score
    assert given is not None
    assert updated is not None
    rig = rig_of(added.after)
    models = (
        Model("as given", inputs.rig, given.nrmse),
        Model(f"+ {added.effect.label()}", rig, updated.nrmse),
    )
    with staged(out) as stage:
        content = write_comparison(added.comparison_after, rig, stage, numbers_of(added))
        remember(out, stage, models, like=inputs.rig_path, command=shlex.join(command))
    return AddedByHand(added.effect, models, content)
