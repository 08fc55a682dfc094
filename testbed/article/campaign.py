"""All tests of the bench, each kept when it is done: a run that was stopped goes on where it was."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from identification.progress import Progress
from models.errors import InputError
from models.record import Record
from testbed.article.bench import FS, STRUCK, TAPPED, TAPS, BenchTest, bench_test, struck_by, taps_of
from testbed.article.rig import Drive, Geometry
from testbed.article.truth import truth_of
from testbed.outputs import Json, digest_of, keep_json
from testbed.processes import as_done
from testbed.records.read import read_record
from testbed.records.write import write_record

KEPT = "records"
"""Folder of the records; they are made again where they are missing, and are no part of the results."""


@dataclass(frozen=True)
class Order:
    """One test.

    Attributes:
        clearance: of both sleeves, m.
        drive: which test.
        engine: that moves the rig.
    """

    clearance: float
    drive: Drive
    engine: str

    @property
    def name(self) -> str:
        """Of its folder."""
        return f"{1e3 * self.clearance:g}-mm-{self.drive}-{self.engine}"


def campaign(
    geometry: Geometry, orders: Sequence[Order], out: Path, jobs: int, progress: Progress
) -> Mapping[Order, BenchTest]:
    """Carry out the tests that are not there yet, and read all.

    Args:
        geometry: of the rig.
        orders: what is to be tested.
        out: folder of the results.
        jobs: processes.
        progress: told what is being done.

    Raises:
        DivergenceError: an engine lost the motion.
        InputError: a record that was written cannot be read back.
    """
    there = {order: _kept(geometry, order, out) for order in orders}
    todo = [order for order, kept in there.items() if kept is None]
    for number, (order, _) in enumerate(as_done(partial(carry_out, geometry, out), todo, jobs), start=1):
        progress(f"{order.drive} test at {1e3 * order.clearance:g} mm by {order.engine}: {number} of {len(todo)}")
        there[order] = _kept(geometry, order, out)
    lost = [order.name for order, test in there.items() if test is None]
    if lost:
        raise InputError(
            f"{out / KEPT}: {', '.join(lost)} cannot be read back",
            "records that were just written are there",
            "leave the folder alone while the study runs",
        )
    return {order: test for order, test in there.items() if test is not None}


def carry_out(geometry: Geometry, out: Path, order: Order) -> None:
    """Carry out one test and keep it.

    Args:
        geometry: of the rig.
        out: folder of the results.
        order: the test.

    Raises:
        DivergenceError: the engine lost the motion.
    """
    test = bench_test(geometry, order.clearance, order.drive, order.engine)
    folder, rig = out / KEPT / order.name, geometry.rig(order.clearance, order.drive)
    folder.mkdir(parents=True, exist_ok=True)
    for record in (test.taps, test.struck):
        write_record(record, rig, folder / f"{record.name}.npz")
    keep_json(folder / "test.json", {"made_of": _made_of(geometry, order), "noise": test.noise})


def _kept(geometry: Geometry, order: Order, out: Path) -> BenchTest | None:
    """A test that was kept, made of the same things."""
    folder = out / KEPT / order.name
    try:
        content: Json = json.loads((folder / "test.json").read_text(encoding="utf-8"))
        if content["made_of"] != _made_of(geometry, order):
            return None
        rig = geometry.rig(order.clearance, order.drive)
        taps, struck = (read_record(folder / f"{name}.npz", rig) for name in (TAPS, STRUCK))
    except (OSError, ValueError, KeyError, InputError):
        return None
    assert isinstance(taps, Record)
    assert isinstance(struck, Record)
    return BenchTest(taps, struck, content["noise"])


def _made_of(geometry: Geometry, order: Order) -> str:
    """Digest of all that a test depends on."""
    truth = truth_of(geometry, order.clearance, order.drive, order.engine)
    return digest_of(truth, taps_of(geometry, order.drive), TAPPED, FS, struck_by(order.drive))
