"""All slews of the study: at every clearance, by every model's course, in both simulators; each clearance kept."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from identification.progress import Progress
from models.arrays import FloatArray
from models.plant import Plant, build_plant
from testbed.article.compared import PERFECT
from testbed.article.rig import Geometry
from testbed.article.slew import (
    FS,
    INVERTED_TO,
    ITERATIONS,
    STEP,
    WATCHED,
    Slew,
    by_engine,
    carried_out,
    courses,
    slewed,
    wanted,
)
from testbed.article.three_models import ThreeModels
from testbed.article.truth import truth_of
from testbed.outputs import Json, digest_of, kept
from testbed.processes import as_done

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
        real = build_plant(slewed(truth.built), truth.hidden)
        rows.append(
            kept(
                path,
                digest_of(three.rigs, truth, engines, wanted(), INVERTED_TO, ITERATIONS, STEP, WATCHED),
                partial(_slews, clearance, real, three, engines, jobs, progress),
            )
        )
    return rows


def _slews(
    clearance: float, real: Plant, three: ThreeModels, engines: Sequence[str], jobs: int, progress: Progress
) -> Json:
    progress(f"slewing the base at {1e3 * clearance:g} mm: the course of each model, in {' and '.join(engines)}")
    plants = {name: build_plant(slewed(rig)) for name, rig in three.rigs.items()}
    bases = courses({**plants, PERFECT: real})
    every = round(FS / DRAWN_AT)
    pairs = [(name, engine) for name in bases for engine in engines]
    slews = dict(as_done(partial(_one, real, bases), pairs, jobs))
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


def _one(real: Plant, bases: Mapping[str, FloatArray], pair: tuple[str, str]) -> Slew:
    name, engine = pair
    return carried_out(bases[name], by_engine(real, engine))
