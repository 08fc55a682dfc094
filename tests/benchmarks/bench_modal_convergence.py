"""How the error falls with modes and with steps; writes results/modal_convergence for docs/theory.md."""

from dataclasses import replace

import numpy as np
from reference_run import FS, RMS, nrmse, reference_plant, reference_record, table, write

from models.arrays import FloatArray
from models.band_limit import record_channels
from models.drive import drive_of
from models.modal import ModalModel, build_modal
from models.plant import Plant
from models.record import Record
from models.rest import find_rest
from models.simulate import Settings, _march, simulate

LEAST_MODES = 8
MODES, STEPS = (4, 6, 8, 10, 12, 16), (2, 3, 4, 6, 8, 16)
FINE = Settings(n_modes=40, steps_per_sample=64)
FINE_STEPS = 32
STATIC = 3  # two sleeves and the shaker
OTHER_SLEEVES = (
    {"stiffness": 3e4},
    {"stiffness": 3e5},
    {"damping": 5.0},
    {"damping": 300.0},
    {"clearance": 5e-5},
    {"clearance": 5e-4},
)
SHORT = 2.0


def truncated(plant: Plant, n_modes: int) -> ModalModel:
    """Plain truncation: the lowest modes alone, with the sag and the flexibility at the sleeves that they have."""
    full = build_modal(plant, FS, n_modes)
    rows, square = full.port_rows[:, :n_modes], full.omega[:n_modes] ** 2
    rest = find_rest(
        plant,
        full.ports,
        sag=rows @ (-plant.structure.gravity * full.carried[:n_modes] / square),
        flexibility=(rows / square) @ rows.T,
    )
    return replace(
        full,
        omega=full.omega[:n_modes],
        damping=full.damping[:n_modes, :n_modes],
        carried=full.carried[:n_modes],
        rest=rest,
        _modes=full._modes[:, :n_modes],
    )


def channels_of(model: ModalModel, record: Record) -> FloatArray:
    """What accelerometers read of a model that is given, at ``FINE_STEPS`` steps per sample."""
    drive = drive_of(record, model.plant, FINE_STEPS, {})
    fine, _ = _march(model, drive, record, FINE_STEPS, model.plant.sensors, None, 1e-9 * RMS, keep_trace=False)
    return record_channels(fine, FINE_STEPS, record.n_samples, FS, np.ones(len(fine)))


def error_of(plant: Plant, settings: Settings) -> float:
    """On a short record, against the fine settings."""
    record = reference_record(plant, SHORT)
    return nrmse(simulate(plant, record, settings).channels, simulate(plant, record, FINE).channels)


def test_modes_and_steps():
    plant = reference_plant()
    record = reference_record(plant)
    exact = simulate(plant, record, FINE).channels
    plain = {n: nrmse(channels_of(truncated(plant, n), record), exact) for n in MODES}
    static = {n: nrmse(simulate(plant, record, Settings(n, FINE_STEPS)).channels, exact) for n in MODES}
    by_modes = table(
        ["dynamic modes", "plain truncation, %", "with static shapes, %"],
        [[str(n), f"{100 * plain[n]:.2f}", f"{100 * static[n]:.3f}"] for n in MODES],
    )
    steps = {r: nrmse(simulate(plant, record, Settings(None, r)).channels, exact) for r in STEPS}
    by_steps = table(
        ["steps per second", "error, %"], [[f"{r * FS:.0f}", f"{100 * error:.3f}"] for r, error in steps.items()]
    )
    chosen = simulate(plant, record)
    about = (
        f"Reference rig, multisine {RMS:.0f} N rms, 3 to 250 Hz, {record.duration:.0f} s at {FS:.0f} Hz,"
        " 8 accelerometers: rms of the error over rms of the channels, against"
        f" {FINE.n_modes} modes and {FINE.steps_per_sample} steps a sample."
        f" By default {chosen.model.n - STATIC} modes, {STATIC} static shapes and"
        f" {chosen.steps_per_sample * FS:.0f} steps a second: {100 * nrmse(chosen.channels, exact):.3f} %.\n"
    )
    page = f"# Convergence of the modal model\n\n{about}\nAt {FINE_STEPS} steps a sample:\n\n{by_modes}\n"
    page += f"With the modes of the default:\n\n{by_steps}"
    others = {
        f"{key} {value:g}": (error_of(plant, Settings()), error_of(plant, Settings(8, FINE_STEPS)))
        for sleeves in OTHER_SLEEVES
        for key, value in sleeves.items()
        for plant in [reference_plant(**sleeves)]
    }
    by_sleeves = table(
        ["sleeves with (SI)", "default, %", "8 modes, small steps, %"],
        [[name, *(f"{100 * error:.3f}" for error in errors)] for name, errors in others.items()],
    )
    page += f"\nOther sleeves, {SHORT:.0f} s:\n\n{by_sleeves}"
    content = {"other_sleeves": others, "plain_truncation": plain, "static_shapes": static, "steps_per_sample": steps}
    write("modal_convergence", "convergence", content, page)
    assert all(static[n] < 0.1 * plain[n] for n in MODES if n >= LEAST_MODES)  # fewer do not span the force's band
    assert nrmse(chosen.channels, exact) < 3e-3
    assert max(default for default, _ in others.values()) < 3e-3
