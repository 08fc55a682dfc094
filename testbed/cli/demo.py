"""``testbed demo``: the whole loop on the records that ship with the project."""

from pathlib import Path

from testbed.cli.diagnose import Again, diagnose_files
from testbed.cli.options import AsJson, Jobs, Out, Seed

EXAMPLE = "Example: testbed demo --out results/demo"

HELD_BACK = "holdout"
"""Records with this word in their names are kept aside."""


def demo(out: Out = None, seed: Seed = 0, jobs: Jobs = 2, again: Again = False, as_json: AsJson = False) -> None:
    """Diagnose the rig and the records that ship with the project, and say where the report is."""
    folder = Path(__file__).parents[1] / "demo"
    records = sorted(path for path in (folder / "records").iterdir() if not path.name.startswith("."))
    diagnose_files(
        folder / "rig.toml",
        [path for path in records if HELD_BACK not in path.stem],
        [path for path in records if HELD_BACK in path.stem],
        Path("results/demo") if out is None else out,
        [],
        seed=seed, jobs=jobs, again=again, as_json=as_json,
    )  # fmt: skip
