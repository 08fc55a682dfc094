"""The modal model's stepper beside scipy's integrators on the same equations; writes results/benchmarks/modal."""

from collections.abc import Callable
from time import process_time

import numpy as np
from numba import njit
from reference_run import FS, SECONDS, best_of, nrmse, reference_plant, reference_record, table, write
from scipy.integrate import solve_ivp
from threadpoolctl import threadpool_limits

from models.arrays import FloatArray
from models.band_limit import raise_rate, record_channels
from models.modal import ModalModel
from models.record import Record
from models.simulate import Settings, simulate

FINE = Settings(n_modes=40, steps_per_sample=64)
SAME_MODES = Settings(n_modes=None, steps_per_sample=128)
SHORT = 0.5
"""Seconds given to scipy's integrators, which take as long for each as for any other."""

FORCE_RATE, READ_RATE = 64, 4
"""Per sample: force values between which scipy's integrators interpolate, and instants at which they are read."""

CANDIDATES = [(method, rtol) for method in ("DOP853", "LSODA", "RK45") for rtol in (1e-3, 1e-4, 1e-5)]


@njit
def rate_of(t, x, omega, damping, rows, force_row, force, force_fs, q_rest, held, gaps):
    """dx/dt of x = (q, q') with Kelvin-Voigt contacts, compiled like the stepper."""
    n = len(omega)
    q, v = x[:n], x[n:]
    place = min(t * force_fs, len(force) - 1.000001)
    i = int(place)
    push = force_row * (force[i] + (place - i) * (force[i + 1] - force[i])) - damping * v - omega**2 * q
    for port in range(len(rows)):
        here, speed = q_rest[port] + np.dot(rows[port], q), np.dot(rows[port], v)
        clearance, stiffness, dashpot = gaps[port]
        side = 1.0 if here >= 0.0 else -1.0
        depth = side * here - clearance
        normal = max(0.0, stiffness * depth + dashpot * side * speed) if depth > 0.0 else 0.0
        push += rows[port] * (-side * normal - held[port])
    return np.concatenate((v, push))


def right_hand_side(model: ModalModel, record: Record) -> Callable[[float, FloatArray], FloatArray]:
    """The modal equations of the reference rig for ``solve_ivp``."""
    contacts = model.plant.contacts
    constants = (
        model.omega,
        np.diag(model.damping).copy(),
        model.port_rows,
        model.rows(model.plant.excitation.position),
        raise_rate(record.excitation, FORCE_RATE),
        FS * FORCE_RATE,
        model.rest.position,
        model.rest.contact_forces,
        np.array([(c.clearance, c.law.stiffness, c.law.damping) for c in contacts]),
    )
    return lambda t, x: rate_of(t, x, *constants)


def by_scipy(model: ModalModel, record: Record, method: str, rtol: float) -> FloatArray:
    """(n_sensors, N) what accelerometers read."""
    rows = np.stack([model.rows(sensor.position) for sensor in model.plant.sensors])
    time = np.arange((record.n_samples - 1) * READ_RATE + 1) / (FS * READ_RATE)
    start, atol = np.zeros(2 * model.n), 1e-3 * rtol
    found = solve_ivp(right_hand_side(model, record), (0.0, time[-1]), start, method, time, rtol=rtol, atol=atol)
    return record_channels(rows @ found.y[model.n :], READ_RATE, record.n_samples, FS, np.ones(len(rows)))


def test_faster_than_a_general_integrator_at_equal_accuracy():
    plant = reference_plant()
    long, short = reference_record(plant), reference_record(plant, SHORT)
    with threadpool_limits(1):
        ours = best_of(7, lambda: simulate(plant, long))
        total_error = nrmse(simulate(plant, long).channels, simulate(plant, long, FINE).channels)
        exact = simulate(plant, short, SAME_MODES)
        own_error = nrmse(simulate(plant, short).channels, exact.channels)
        by_scipy(exact.model, reference_record(plant, 0.02), "RK45", 1e-3)  # compiles
        tried = []
        for method, rtol in CANDIDATES:
            start = process_time()
            found = by_scipy(exact.model, short, method, rtol)
            tried.append(((process_time() - start) / SHORT, method, rtol, nrmse(found, exact.channels)))
    equal = [row for row in tried if row[3] <= own_error]
    theirs, method, rtol, error = min(equal)
    ratio = theirs / (ours / SECONDS)
    rows = [["this stepper", "-", f"{100 * own_error:.3f}", f"{SECONDS / ours:.0f}"]]
    rows += [[m, f"{tol:g}", f"{100 * e:.3f}", f"{1 / seconds:.2f}"] for seconds, m, tol, e in tried]
    page = (
        "# Speed of the modal model\n\n"
        f"Reference rig, 8 accelerometers, {SECONDS} s at {FS:.0f} Hz under a multisine of 30 N rms; one core,"
        " processor time, which other work on the machine stretches. Error against the same modes at 128 steps a"
        f" sample; against 40 modes and 64 steps a sample it is {100 * total_error:.3f} %.\n\n"
        f"{table(['integrator', 'rtol', 'error, %', 'times real time'], rows)}\n"
        f"At equal accuracy {ratio:.0f} times faster than scipy's fastest ({method}, compiled right-hand side).\n"
    )
    content = {
        "real_time_factor": SECONDS / ours,
        "error": total_error,
        "error_same_modes": own_error,
        "scipy": {"method": method, "rtol": rtol, "error": error, "real_time_factor": 1.0 / theirs},
        "ratio": ratio,
    }
    write("benchmarks", "modal", content, page)
    assert total_error < 3e-3
    assert ratio > 10.0
