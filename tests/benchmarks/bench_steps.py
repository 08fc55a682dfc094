"""What it spares to meet contacts together instead of one by one; writes results/benchmarks/steps."""

import numpy as np
from reference_run import FS, reference_plant, reference_record, spent, table, write
from threadpoolctl import threadpool_limits

from models.band_limit import STOP_EDGE
from models.drive import drive_of
from models.modal import build_modal
from models.simulate import FORCE_TOLERANCE, STEP_RATE, output_rows
from models.step_tables import items_of, linear_of
from models.stepping import Items, Reading, march

CLEARANCES = (0.0, 2e-5, 2e-4, 1.0)
"""m: from sleeves that always hold to some that are never met."""

STEPS = int(STEP_RATE / FS)
TIMES, DEARER = 25, 1.15
"""Runs of which the least counts, and what a step may cost more where no contact is met."""


def test_contacts_met_together_take_less_time():
    with threadpool_limits(1):
        rows = [marched(clearance) for clearance in CLEARANCES]
    head = ["clearance, mm", "closed, mean of the two", "ns a step, one by one", "together", "times as fast"]
    lines = [
        [f"{1e3 * clearance:g}", f"{shut:.0%}", f"{one:.0f}", f"{joined:.0f}", f"{one / joined:.2f}"]
        for clearance, (shut, one, joined) in zip(CLEARANCES, rows, strict=True)
    ]
    page = (
        "# Speed of a step\n\n"
        "The stepper on the reference rig with two Kelvin-Voigt sleeves, 8 sensors, under a multisine of 30 N rms; one "
        f"core, the least of {TIMES} runs in turn. Contacts that stay closed are met together, or each by an iteration "
        "of its own.\n\n"
        f"{table(head, lines)}"
    )
    steps = [dict(zip(("closed", "ns one by one", "ns together"), row, strict=True)) for row in rows]
    write("benchmarks", "steps", {"steps": steps}, page)
    assert all(together < one_by_one for shut, one_by_one, together in rows if shut)
    assert all(together < DEARER * one_by_one for _, one_by_one, together in rows)


def marched(clearance: float) -> tuple[float, float, float]:
    """Share of the time in which a contact is closed, and ns a step one by one and together."""
    plant = reference_plant(clearance=clearance)
    record = reference_record(plant)
    model, drive = build_modal(plant, STOP_EDGE * FS), drive_of(record, plant, STEPS, {})
    system, linear, inputs = linear_of(model, drive, 1.0 / (STEPS * FS))
    items, read = items_of(model), Reading.of(output_rows(model, system, plant.sensors))
    n_steps, n_ports = record.n_samples * STEPS - 1, len(model.ports)
    out, trace = np.empty((len(plant.sensors), n_steps + 1)), np.empty((n_steps + 1, 2 * n_ports + len(items.port)))

    def run(items: Items, trace: np.ndarray) -> None:
        start, tolerance = np.zeros(len(system.from_modal)), FORCE_TOLERANCE * np.abs(record.excitation).max()
        assert march(linear, items, inputs, drive.base_motion, start, read, out, trace, tolerance) == n_steps

    run(items, trace)
    shut = float(np.mean(trace[:, 2 * n_ports :] != 0.0))
    alone = items._replace(straight=np.zeros_like(items.straight))
    untraced = np.empty((0, 0))
    turns = [[spent(lambda each=each: run(each, untraced)) for each in (alone, items)] for _ in range(TIMES)]
    one, joined = np.min(turns, axis=0)
    return shut, 1e9 * one / n_steps, 1e9 * joined / n_steps
