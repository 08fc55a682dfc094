"""``testbed demo``: the whole loop on records of a virtual test, or on those that ship with the project."""

import tomllib
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Annotated, Any

import typer

from models.errors import InputError
from testbed.cli.diagnose import Again, diagnose_files
from testbed.cli.options import AsJson, Jobs, Out, Seed, out_folder
from testbed.cli.progress import progress

EXAMPLE = "Example: testbed demo --with exudyn --out results/demo"

SHIPPED = "shipped"
HELD_BACK = "multisine_6"
"""Records with this word in their names are kept aside."""

EXPERIMENTS = ("multisines", "sweep")
"""Files of the virtual test, carried out side by side."""

DEMO = Path(__file__).parents[1] / "demo"

TRUTH = "truth.toml"

With = Annotated[
    str,
    typer.Option("--with", metavar="NAME", help="Simulator of the records: mujoco, exudyn, modal; or shipped."),
]


def demo(
    using: With = "mujoco",
    out: Out = None,
    seed: Seed = 0,
    jobs: Jobs = 2,
    again: Again = False,
    as_json: AsJson = False,
) -> None:
    """Make records of a rig with grease that its file does not mention, diagnose them, and say where the report is."""
    from models.simulators import SIMULATORS

    if using not in (*SIMULATORS, SHIPPED):
        raise InputError(
            f"--with {using}",
            f"the records of the demo are made by {', '.join(SIMULATORS)}, or are {SHIPPED} with the project",
            "choose one of them",
        )
    folder = out_folder(out, Path("demo"))
    records = _shipped() if using == SHIPPED else _simulated(using, folder / "records" / using, jobs)
    truth = DEMO / TRUTH if using == SHIPPED else records[0].parent / TRUTH
    found = diagnose_files(
        DEMO / "rig.toml",
        [path for path in records if HELD_BACK not in path.stem],
        [path for path in records if HELD_BACK in path.stem],
        folder,
        [],
        seed=seed,
        jobs=jobs,
        again=again,
        as_json=as_json,
    )
    if not as_json and truth.is_file():
        from testbed.cli.tables import say

        say(f"{against_truth(tomllib.loads(truth.read_text(encoding='utf-8')), found)} (truth: {truth})")


def against_truth(truth: Mapping[str, Any], found: Mapping[str, Any]) -> str:
    """What was hidden in a virtual test, and what the diagnosis found, in one line.

    Args:
        truth: of ``truth.toml``.
        found: of ``diagnosis.json``.
    """
    from models.effects import EFFECTS
    from testbed.cli.tables import measured, named

    hidden = []
    for effect in truth["effects"]:
        units = {name: about.unit for name, about in EFFECTS[effect["kind"]].parameters().items()}
        numbers = {name: {"value": effect[name], "std": None, "unit": units[name]} for name in units if name in effect}
        hidden.append({**effect, "parameters": numbers})

    def told(effects: list[dict[str, Any]]) -> str:
        words = [
            ", ".join([named(effect), *(f"{k} {measured(n)} {n['unit']}" for k, n in effect["parameters"].items())])
            for effect in effects
        ]
        return " and ".join(words) or "nothing"

    return f"hidden: {told(hidden)}; found: {told(found['effects'])}"


def _shipped() -> list[Path]:
    return sorted(path for path in (DEMO / "records").iterdir() if not path.name.startswith("."))


def _simulated(using: str, folder: Path, jobs: int) -> list[Path]:
    """Records of the demonstration's experiments by a simulator, made anew unless they are there."""
    from models.simulators.protocol import Resolution
    from testbed.processes import processes
    from testbed.simulate_run import Order, run_experiment

    with progress() as tell:

        def made(experiment: str) -> list[Path]:
            order = Order(DEMO / "rig.toml", DEMO / f"{experiment}.toml", using, Resolution(), ".uff")
            tell(f"a virtual test by {using}: {experiment}")
            content = run_experiment(order, folder / experiment, jobs=jobs, progress=tell, pool=pool)
            return [folder / experiment / row["record"] for row in content["records"]]

        with processes(jobs) as pool, ThreadPoolExecutor(len(EXPERIMENTS)) as side_by_side:
            return [path for paths in side_by_side.map(made, EXPERIMENTS) for path in paths]
