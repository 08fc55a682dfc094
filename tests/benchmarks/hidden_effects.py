"""``python -m tests.benchmarks.hidden_effects``: hide an effect in a random rig, diagnose its records, count.

Every case is a file of its own, named by kind, number and seed; what is there is not computed again, so a run that was
stopped goes on, and more cases can be added later.
"""

import argparse
import json
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from models.effects import EFFECTS, Effect, entry_of
from models.record import Record
from models.rig import Rig
from tests.benchmarks.hidden_cases import NOTHING, Case, draw_case
from tests.benchmarks.hidden_judge import judged
from tests.benchmarks.hidden_table import summarise

Json = dict[str, Any]

NOTHING_SHARE = 10
"""Cases with nothing hidden for each case of a kind."""


def main() -> None:
    """Run what is missing and write the table."""
    options = _options()
    (options.out / "cases").mkdir(parents=True, exist_ok=True)
    todo = [
        task for task in tasks(options.cases, options.only) if not _is_done(_path(options.out, options.seed, *task))
    ]
    print(f"{len(todo)} cases to do", file=sys.stderr)
    with ProcessPoolExecutor(options.jobs, mp_context=get_context("spawn")) as pool:
        running = {pool.submit(run_case, kind, options.seed, number): (kind, number) for kind, number in todo}
        for done, future in enumerate(as_completed(running), start=1):
            kind, number = running[future]
            case = future.result()
            _write(_path(options.out, options.seed, kind, number), case)
            print(f"{done}/{len(todo)} {_in_a_line(case)}", file=sys.stderr, flush=True)
    summary = summarise(options.out)
    print(json.dumps({key: summary[key] for key in ("cases", "hidden", "nothing hidden", "false_alarms")}, indent=1))


def tasks(cases: int, only: Sequence[str]) -> Iterator[tuple[str, int]]:
    """(kind, number) of each case, the first ones of every kind before the second ones.

    Args:
        cases: of each kind.
        only: kinds to run; all, and nothing hidden, where it is empty.
    """
    for number in range(cases):
        for kind in EFFECTS:
            if not only or kind in only:
                yield kind, number
        if not only or NOTHING in only:
            for extra in range(NOTHING_SHARE):
                yield NOTHING, number * NOTHING_SHARE + extra


def run_case(kind: str, seed: int, number: int) -> Json:
    """One case from its draw to its judgement, as its file holds it."""
    began = time.perf_counter()
    with threadpool_limits(1):
        case = draw_case(kind, seed, number)
        drawn = time.perf_counter()
        about: Json = {"case": f"{kind}-{number}", "kind": kind, "seed": seed, "number": number, **_described(case)}
        try:
            diagnosis = run_diagnosis(case.rig, case.records, case.holdout, seed)
        except Exception as failure:  # noqa: BLE001 - a crash is a result of the benchmark, told with its message
            return about | {"failure": f"{type(failure).__name__}: {failure}"}
    sleeves = {sleeve.name: sleeve.position for sleeve in case.rig.sleeves}
    result = judged(diagnosis, about["hidden"], sleeves, case.rig.structure.length)
    took = {"draw": drawn - began, "diagnosis": time.perf_counter() - drawn}
    return about | {"judged": result, "seconds": took, "diagnosis": diagnosis}


def run_diagnosis(rig: Rig, records: Sequence[Record], holdout: Sequence[Record], seed: int) -> Json:
    """The diagnosis of a rig's records as ``diagnosis.json``."""
    from testbed.loop import diagnose_to_json

    return diagnose_to_json(rig, records, holdout, seed, jobs=1)


def _described(case: Case) -> Json:
    return {
        "hidden": None if case.hidden is None else described_effect(case.hidden),
        "noise": case.noise,
        "wanted_ratio": case.wanted,
        "expected_ratio": case.expected,
        "floor": case.floor,
        "rig": case.rig.model_dump(mode="json", exclude_none=True),
        "built": {parameter.path: parameter.value for parameter in case.built.parameters()},
        "force_rms": {
            r.name: float(r.excitation.std()) for r in (*case.records, *case.holdout) if r.excitation is not None
        },
    }


def described_effect(effect: Effect) -> Json:
    """Kind, place and numbers of an effect."""
    return entry_of(effect).model_dump(mode="json", exclude_none=True)


def _path(folder: Path, seed: int, kind: str, number: int) -> Path:
    return folder / "cases" / f"{kind}-{number}-seed{seed}.json"


def _is_done(path: Path) -> bool:
    """A case that failed is tried again."""
    return path.exists() and "failure" not in json.loads(path.read_text(encoding="utf-8"))


def _write(path: Path, case: Json) -> None:
    part = path.with_suffix(".part")
    part.write_text(json.dumps(case, indent=1), encoding="utf-8")
    part.replace(path)


def _in_a_line(case: Json) -> str:
    if "judged" not in case:
        return f"{case['case']}: {case['failure']}"
    result = case["judged"]
    found = None if result["found"] is None else result["found"]["kind"]
    mark = "right" if result["right"] else "WRONG"
    return (
        f"{case['case']}: {mark}, {result['verdict']}, {found}, held out {result['holdout_ratio']}, {case['seconds']}"
    )


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m tests.benchmarks.hidden_effects", description=(__doc__ or "")[:120]
    )
    parser.add_argument(
        "--cases", type=int, default=2, help="cases of each kind (ten times as many with nothing hidden)"
    )
    parser.add_argument("--jobs", type=int, default=2, help="processes")
    parser.add_argument("--only", action="append", default=[], metavar="KIND", help="only this kind (may be repeated)")
    parser.add_argument("--seed", type=int, default=0, help="of all cases")
    parser.add_argument("--out", type=Path, default=Path("results/hidden_effects"), help="folder")
    return parser.parse_args()


if __name__ == "__main__":
    main()
