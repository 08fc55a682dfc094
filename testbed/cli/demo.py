"""``testbed demo``: the whole loop on records of a virtual test, or on those that ship with the project."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Annotated

import typer

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
    folder = out_folder(out, Path("demo"))
    records = _shipped() if using == SHIPPED else _simulated(using, folder / "records" / using, jobs)
    diagnose_files(
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
