"""A comparison over files: ``compare.json`` and its figures in a folder."""

from pathlib import Path

from identification.hypothesis import Hypothesis
from models.rig import Rig
from testbed.compare import Comparison, compare
from testbed.compare_json import comparison_json
from testbed.figures.comparison import save_comparison
from testbed.inputs import Inputs
from testbed.outputs import Json, json_text, staged

COMPARISON, FIGURES = "compare.json", "figures"


def run_comparison(inputs: Inputs, out: Path, *, seed: int, jobs: int) -> Json:
    """Compare a rig with its records and write the result.

    Args:
        inputs: rig and records.
        out: folder of the results.
        seed: of the noise that is carried through the model.
        jobs: cores.

    Returns:
        the content of ``compare.json``.

    Raises:
        InputError: a record that does not fit the rig, or a folder that cannot be written.
        ArithmeticError: the motion left the finite numbers.
    """
    comparison = compare(Hypothesis(inputs.rig), inputs.records, seed=seed, jobs=jobs)
    with staged(out) as stage:
        return write_comparison(comparison, inputs.rig, stage)


def write_comparison(comparison: Comparison, rig: Rig, folder: Path, besides: Json | None = None) -> Json:
    """Write ``compare.json`` and the figures.

    Args:
        comparison: finished.
        rig: for the units.
        folder: that exists.
        besides: further content of ``compare.json``.

    Returns:
        the content of ``compare.json``.
    """
    content = {**comparison_json(comparison), **(besides or {})}
    (folder / COMPARISON).write_text(json_text(content), encoding="utf-8")
    save_comparison(comparison, rig, folder / FIGURES)
    return content
