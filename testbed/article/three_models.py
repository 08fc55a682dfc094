"""The three models of every clearance, made from the force test alone: initial, updated, diagnosed; each kept.

The initial one is the rig as its owner describes it. The updated one has what the identifier reads from the soft taps.
The diagnosed one is what the loop adds by itself to the initial one, told nothing but that all sleeves may have the
same fault: it looks at one clearance, and what it finds there is fitted anew to the force test of every other.
"""

import json
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import Any

from identification.assess import fit_effects
from identification.diagnose import MOST_EFFECTS, diagnose
from identification.hypothesis import Hypothesis
from identification.progress import Progress
from models.effects import EFFECTS, Registry, build_effect, entry_of
from models.record import Record
from models.rig import EffectEntry, Rig
from models.rig_file import read_rig, write_rig
from testbed.article.bench import BenchTest
from testbed.article.reading import tapped_modes
from testbed.article.updating import updated
from testbed.loop import diagnosis_json, rig_of, updated_rig
from testbed.outputs import json_text, keep_json

Json = dict[str, Any]

KEPT = "models"

INITIAL, UPDATED, DIAGNOSED = "initial", "updated", "diagnosed"
MODELS = (INITIAL, UPDATED, DIAGNOSED)

SEED = 0
"""Of the diagnosis."""


@dataclass(frozen=True)
class Search:
    """What the diagnosis may look for.

    Attributes:
        most_effects: that it may add; the same in all sleeves counts once.
        kinds: of the library; all where there are none.
    """

    most_effects: int = MOST_EFFECTS
    kinds: tuple[str, ...] = ()

    def registry(self, rig: Rig) -> Registry:
        """The kinds, with those that the rig has.

        Args:
            rig: whose own effects are of the library too.
        """
        wanted = {*self.kinds, *(entry.kind for entry in rig.effects)}
        return {kind: cls for kind, cls in EFFECTS.items() if not self.kinds or kind in wanted}


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
    search: Search,
    folder: Path,
    jobs: int,
    progress: Progress,
) -> ThreeModels:
    """Make the models, or read those that were kept for the same test.

    Args:
        rig: as its owner describes it, with the force test's excitation.
        test: the force test.
        found: what the diagnosis at another clearance added; None where it is to be made here.
        search: what the diagnosis may look for.
        folder: where the models of this clearance are kept.
        jobs: threads.
        progress: told what is being done.

    Raises:
        InputError: modes that the rig does not have.
        ArithmeticError: a motion left the finite numbers.
    """
    made_of, path = _made_of(rig, test, found, search), folder / "models.json"
    if not path.is_file() or json.loads(path.read_text(encoding="utf-8")).get("made_of") != made_of:
        folder.mkdir(parents=True, exist_ok=True)
        write_rig(rig, folder / f"{INITIAL}.toml")
        identified = _updated(rig, test, folder)
        diagnosis, diagnosed = _diagnosed(rig, test, found, search, jobs, progress)
        write_rig(diagnosed, folder / f"{DIAGNOSED}.toml")
        keep_json(path, {"made_of": made_of, "identified": identified, "diagnosis": diagnosis})
    content = json.loads(path.read_text(encoding="utf-8"))
    rigs = {name: read_rig(folder / f"{name}.toml") for name in MODELS}
    return ThreeModels(rigs, content["identified"], content["diagnosis"])


def _updated(rig: Rig, test: BenchTest, folder: Path) -> dict[str, Json]:
    found = updated(rig, tapped_modes(test.taps, rig))
    effects = (*rig.effects, *(entry_of(effect) for effect in found.dampings))
    write_rig(found.rig.model_copy(update={"effects": effects}), folder / f"{UPDATED}.toml")
    return {
        str(effect.place.sleeve): {
            "time": effect.times,
            "damping": effect.values,
            "interval": found.intervals[:, number],
        }
        for number, effect in enumerate(found.dampings)
    }


def _diagnosed(
    rig: Rig, test: BenchTest, found: tuple[EffectEntry, ...] | None, search: Search, jobs: int, progress: Progress
) -> tuple[Json | None, Rig]:
    records: list[Record] = [test.struck, test.taps]
    if found is None:
        told = diagnose(
            rig,
            records,
            seed=SEED,
            jobs=jobs,
            registry=search.registry(rig),
            most_effects=search.most_effects,
            alike=True,
            progress=progress,
        )
        return diagnosis_json(told), updated_rig(told)
    progress(f"fitting {', '.join(dict.fromkeys(entry.kind for entry in found))} to the force test")
    effects = tuple(build_effect(entry, rig, EFFECTS) for entry in found)
    fitted = fit_effects(Hypothesis(rig, effects=effects), records, jobs=jobs, seed=SEED)
    return None, rig_of(replace(fitted.hypothesis, starts={}, offsets={}))


def _made_of(rig: Rig, test: BenchTest, found: tuple[EffectEntry, ...] | None, search: Search) -> str:
    """Digest of all that the models are made from."""
    entries = None if found is None else [entry.model_dump(exclude_none=True) for entry in found]
    parts = [json_text([rig.model_dump(exclude_none=True), entries, vars(search)]).encode()]
    for record in (test.taps, test.struck):
        assert record.excitation is not None
        parts += [record.excitation.tobytes(), record.responses.tobytes()]
    return sha256(b"".join(parts)).hexdigest()
