"""All slews of the study: at every clearance, by every model's course, in both simulators; each clearance kept."""

import json
from collections.abc import Mapping, Sequence
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from identification.progress import Progress
from models.arrays import FloatArray
from models.plant import Plant, build_plant
from models.rig import Rig
from testbed.article.compared import PERFECT
from testbed.article.rig import Geometry
from testbed.article.slew import FS, Slew, by_engine, carried_out, courses, slewed, wanted
from testbed.article.three_models import ThreeModels
from testbed.article.truth import truth_of
from testbed.hidden_effects.truth import Truth
from testbed.outputs import json_text, keep_json
from testbed.simulate_run import processes

Json = dict[str, Any]

KEPT = "slews"

DRAWN_AT = 256.0
"""Hz, at which courses are kept for the figure."""


def all_slews(
    geometry: Geometry,
    models: Mapping[float, ThreeModels],
    engines: Sequence[str],
    out: Path,
    jobs: int,
    progress: Progress,
) -> list[Json]:
    """Per clearance the tip's error with each course, in each simulator.

    Args:
        geometry: of the rig.
        models: by clearance, m.
        engines: names of simulators.
        out: folder of the results.
        jobs: processes.
        progress: told what is being done.

    Raises:
        DivergenceError: a motion left the finite numbers.
    """
    rows = []
    for clearance, three in models.items():
        path = out / KEPT / f"{1e3 * clearance:g}-mm.json"
        truth = truth_of(geometry, clearance, "table", "modal")
        made_of = _made_of(three.rigs, truth, engines)
        if not path.is_file() or json.loads(path.read_text(encoding="utf-8")).get("made_of") != made_of:
            progress(
                f"slewing the base at {1e3 * clearance:g} mm: the course of each model, in {' and '.join(engines)}"
            )
            real = build_plant(slewed(truth.built), truth.hidden)
            plants = {name: build_plant(slewed(rig)) for name, rig in three.rigs.items()}
            bases = courses({**plants, PERFECT: real})
            keep_json(path, {"made_of": made_of, **_slews(clearance, real, bases, engines, jobs)})
        rows.append(json.loads(path.read_text(encoding="utf-8")))
    return rows


def _slews(clearance: float, real: Plant, bases: Mapping[str, FloatArray], engines: Sequence[str], jobs: int) -> Json:
    every = round(FS / DRAWN_AT)
    pairs = [(name, engine) for name in bases for engine in engines]
    with processes(min(jobs, len(pairs))) as pool:
        done = [pool.submit(_one, real, bases[name], engine) for name, engine in pairs]
        slews = dict(zip(pairs, (future.result() for future in done), strict=True))
    return {
        "clearance": clearance,
        "rate": FS / every,
        "wanted": wanted()[::every],
        "courses": {
            name: {
                "base": base[::every],
                "engines": {
                    engine: {
                        "rms": slews[name, engine].rms,
                        "largest": slews[name, engine].largest,
                        "after": slews[name, engine].after,
                        "tip": slews[name, engine].tip[::every],
                    }
                    for engine in engines
                },
            }
            for name, base in bases.items()
        },
    }


def _one(real: Plant, base: FloatArray, engine: str) -> Slew:
    return carried_out(base, by_engine(real, engine))


def _made_of(rigs: Mapping[str, Rig], truth: Truth, engines: Sequence[str]) -> str:
    texts = [json_text({name: rig.model_dump(exclude_none=True) for name, rig in rigs.items()}), repr(truth)]
    return sha256("".join([*texts, *engines, repr(np.round(wanted()[::64], 9).tolist())]).encode()).hexdigest()
