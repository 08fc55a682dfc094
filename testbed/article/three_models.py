"""The three models of every clearance, made from the force test alone: initial, updated, and diagnosed, which is kept.

The initial one is the rig as its owner describes it. The updated one has what the identifier reads from the soft taps.
The diagnosed one is what the loop adds by itself to the initial one, told nothing but that all sleeves may have the
same fault: it looks at one clearance, and what it finds there is fitted anew to the force test of every other.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from identification.assess import fit_effects
from identification.diagnose import diagnose
from identification.hypothesis import Hypothesis
from identification.progress import Progress
from models.arrays import FloatArray
from models.effects import EFFECTS, build_effect, entry_of
from models.record import Record
from models.rig import EffectEntry, Rig
from models.rig_file import write_rig
from testbed.article.bench import BenchTest
from testbed.article.reading import tapped_modes
from testbed.article.updating import updated
from testbed.loop import diagnosis_json, rig_of, updated_rig
from testbed.outputs import Json, digest_of, kept

KEPT = "models"

INITIAL, UPDATED, DIAGNOSED = "initial", "updated", "diagnosed"
MODELS = (INITIAL, UPDATED, DIAGNOSED)

SEED = 0
"""Of the diagnosis."""


@dataclass(frozen=True, eq=False)
class ThreeModels:
    """The models of one clearance.

    Attributes:
        rigs: by name, each with all its effects and the force test's excitation.
        identified: what the identifier read: per sleeve ``time``, ``damping`` and its 95 % ``interval``.
        diagnosis: the content of ``diagnosis.json``; None where it was made at another clearance.
    """

    rigs: dict[str, Rig]
    identified: dict[str, Json]
    diagnosis: Json | None

    @property
    def found(self) -> tuple[EffectEntry, ...]:
        """What the diagnosis added to the rig's own effects."""
        return self.rigs[DIAGNOSED].effects[len(self.rigs[INITIAL].effects) :]

    def driven_like(self, other: Rig) -> dict[str, Rig]:
        """The models of another test of the same rig.

        Args:
            other: the rig with that test's excitation, as its owner describes it.
        """
        return {name: rig.model_copy(update={"excitation": other.excitation}) for name, rig in self.rigs.items()}


def three_models(
    rig: Rig,
    test: BenchTest,
    found: tuple[EffectEntry, ...] | None,
    most_effects: int,
    folder: Path,
    jobs: int,
    progress: Progress,
) -> ThreeModels:
    """Make the models, or read those that were kept for the same test.

    Args:
        rig: as its owner describes it, with the force test's excitation.
        test: the force test.
        found: what the diagnosis at another clearance added; None where it is to be made here.
        most_effects: that the diagnosis may add; the same in all sleeves counts once.
        folder: where the models of this clearance are kept.
        jobs: cores.
        progress: told what is being done.

    Raises:
        InputError: modes that the rig does not have.
        ArithmeticError: a motion left the finite numbers.
    """
    folder.mkdir(parents=True, exist_ok=True)
    found_now = updated(rig, tapped_modes(test.taps, rig))
    effects = (*rig.effects, *(entry_of(effect) for effect in found_now.dampings))
    better = found_now.rig.model_copy(update={"effects": effects})
    content = kept(
        folder / "diagnosis.json",
        digest_of(rig, found, most_effects, SEED, *_signals(test)),
        lambda: _diagnosed(rig, test, found, most_effects, jobs, progress),
    )
    rigs = {INITIAL: rig, UPDATED: better, DIAGNOSED: Rig.model_validate(content["rig"])}
    for name, model in rigs.items():
        write_rig(model, folder / f"{name}.toml")
    identified: dict[str, Json] = {
        str(effect.place.sleeve): {
            "time": effect.times,
            "damping": effect.values,
            "interval": found_now.intervals[:, number],
        }
        for number, effect in enumerate(found_now.dampings)
    }
    return ThreeModels(rigs, identified, content["diagnosis"])


def _diagnosed(
    rig: Rig,
    test: BenchTest,
    found: tuple[EffectEntry, ...] | None,
    most_effects: int,
    jobs: int,
    progress: Progress,
) -> Json:
    """The diagnosed rig, and the diagnosis where it is made here."""
    records: list[Record] = [test.struck, test.taps]
    if found is None:
        told = diagnose(
            rig,
            records,
            seed=SEED,
            jobs=jobs,
            most_effects=most_effects,
            alike=True,
            progress=progress,
        )
        return {"rig": _plain(updated_rig(told)), "diagnosis": diagnosis_json(told)}
    progress(f"fitting {', '.join(dict.fromkeys(entry.kind for entry in found)) or 'the rig'} to the force test")
    effects = tuple(build_effect(entry, rig, EFFECTS) for entry in found)
    fitted = fit_effects(Hypothesis(rig, effects=effects), records, jobs=jobs, seed=SEED)
    return {"rig": _plain(rig_of(replace(fitted.hypothesis, starts={}, offsets={}))), "diagnosis": None}


def _plain(rig: Rig) -> Json:
    return rig.model_dump(exclude_none=True)


def _signals(test: BenchTest) -> Iterator[FloatArray]:
    """What was measured."""
    for record in (test.taps, test.struck):
        assert record.excitation is not None
        yield record.excitation
        yield record.responses
