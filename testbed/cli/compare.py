"""``testbed compare``: how well the rig predicts its records."""

from testbed.cli.options import AsJson, Jobs, Out, Records, RigFile, Seed, Without, out_folder
from testbed.cli.progress import progress

EXAMPLE = "Example: testbed compare rig.toml sweep.uff burst.uff --out results/compare"


def compare(
    rig: RigFile,
    records: Records,
    *,
    out: Out = None,
    without: Without = None,
    seed: Seed = 0,
    jobs: Jobs = 2,
    as_json: AsJson = False,
) -> None:
    """Predict each record from its measured excitation and compare: compare.json and figures."""
    folder = out_folder(out, rig, "compare.json", "figures/")
    with progress() as tell:
        from testbed.compare_run import run_comparison
        from testbed.inputs import read_inputs

        inputs = read_inputs(rig, records, without=without or ())
        for finding in inputs.findings:
            tell(finding)
        tell(f"comparing with {', '.join(record.name for record in inputs.records)}")
        content = run_comparison(inputs, folder, seed=seed, jobs=jobs)
    from testbed.cli.tables import print_comparison, print_json, say

    if as_json:
        print_json(content)
        return
    print_comparison(content)
    for finding in content["findings"]:
        say(f"note: {finding}")
    say(f"written: {folder}/compare.json and figures")
