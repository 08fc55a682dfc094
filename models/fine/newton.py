"""The equations of one collocation step, solved for the port forces and internal states at both stages."""

from models.arrays import FloatArray
from models.compiled import compiled
from models.fine.desk import (
    BY_Q,
    BY_V,
    BY_Z,
    FORCE,
    LAW,
    RATE,
    RATE_BY_Q,
    RATE_BY_V,
    RATE_BY_Z,
    START,
    Desk,
    Z,
)
from models.fine.gauss import WEIGHTS
from models.fine.tables import Tables
from models.point_forces import Items

A11, A12, A21, A22 = (float(weight) for weight in WEIGHTS.ravel())


@compiled
def faults(desk: Desk, items: Items, h: float) -> tuple[float, float, int]:
    """Fill in what is missing in forces and internal states: the largest of each, and how many equations there are."""
    n_ports = desk.port.shape[2]
    worst_force, worst_state = 0.0, 0.0
    for stage in range(2):
        for i in range(n_ports):
            fault = desk.port[LAW, stage, i] - desk.port[FORCE, stage, i]
            desk.fault[stage * n_ports + i] = fault
            worst_force = max(worst_force, abs(fault))
    row = 2 * n_ports
    for j in range(items.port.shape[0]):
        if items.rate[j] != 0:
            for stage in range(2):
                first, second = (A11, A12) if stage == 0 else (A21, A22)
                growth = h * (first * desk.item[RATE, 0, j] + second * desk.item[RATE, 1, j])
                desk.fault[row + stage] = desk.item[Z, START, j] + growth - desk.item[Z, stage, j]
                worst_state = max(worst_state, abs(desk.fault[row + stage]))
            row += 2
    return worst_force, worst_state, row


@compiled
def write_force_rows(desk: Desk, tables: Tables, level: int, size: int) -> None:
    """Equations of the forces: each is what its port's laws give for the motion that all of them cause."""
    n_ports, reached = desk.port.shape[2], tables.reached
    for stage in range(2):
        for i in range(n_ports):
            row = stage * n_ports + i
            by_q, by_v = desk.port[BY_Q, stage, i], desk.port[BY_V, stage, i]
            for k in range(size):
                desk.matrix[row, k] = 0.0
            for other in range(2):
                for m in range(n_ports):
                    motion = by_q * reached[level, 2 * stage, i, other, m]
                    motion += by_v * reached[level, 2 * stage + 1, i, other, m]
                    desk.matrix[row, other * n_ports + m] = -motion
            desk.matrix[row, row] += 1.0


@compiled
def write_state_rows(desk: Desk, tables: Tables, items: Items, level: int, size: int) -> None:
    """Equations of the internal states: each is the integral of its rate up to the stage."""
    n_ports, reached, h, row = desk.port.shape[2], tables.reached, tables.h[level], 2 * desk.port.shape[2]
    for j in range(items.port.shape[0]):
        if items.rate[j] == 0:
            continue
        i = items.port[j]
        for stage in range(2):
            for k in range(size):
                desk.matrix[row + stage, k] = 0.0
            for at in range(2):
                weight = h * ((A11 if at == 0 else A12) if stage == 0 else (A21 if at == 0 else A22))
                by_q, by_v = desk.item[RATE_BY_Q, at, j], desk.item[RATE_BY_V, at, j]
                for other in range(2):
                    for m in range(n_ports):
                        motion = by_q * reached[level, 2 * at, i, other, m]
                        motion += by_v * reached[level, 2 * at + 1, i, other, m]
                        desk.matrix[row + stage, other * n_ports + m] -= weight * motion
                desk.matrix[row + stage, row + at] -= weight * desk.item[RATE_BY_Z, at, j]
            desk.matrix[row + stage, row + stage] += 1.0
            desk.matrix[stage * n_ports + i, row + stage] -= desk.item[BY_Z, stage, j]
        row += 2


@compiled
def correct(desk: Desk, tables: Tables, items: Items, level: int, size: int) -> None:
    """One Newton correction of the forces and internal states."""
    n_ports = desk.port.shape[2]
    write_force_rows(desk, tables, level, size)
    write_state_rows(desk, tables, items, level, size)
    eliminate(desk.matrix, desk.fault, size)
    for stage in range(2):
        for i in range(n_ports):
            desk.port[FORCE, stage, i] += desk.fault[stage * n_ports + i]
    row = 2 * n_ports
    for j in range(items.port.shape[0]):
        if items.rate[j] != 0:
            desk.item[Z, 0, j] += desk.fault[row]
            desk.item[Z, 1, j] += desk.fault[row + 1]
            row += 2


@compiled
def pivot(matrix: FloatArray, right: FloatArray, k: int, n: int) -> None:
    """Bring the equation with the largest coefficient in column k to row k."""
    best = k
    for i in range(k + 1, n):
        if abs(matrix[i, k]) > abs(matrix[best, k]):
            best = i
    if best != k:
        right[k], right[best] = right[best], right[k]
        for j in range(k, n):
            matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]


@compiled
def eliminate(matrix: FloatArray, right: FloatArray, n: int) -> None:
    """Solve the leading n equations in place by elimination with pivots; the solution stands in ``right``."""
    for k in range(n):
        pivot(matrix, right, k, n)
        for i in range(k + 1, n):
            share = matrix[i, k] / matrix[k, k]
            if share != 0.0:
                right[i] -= share * right[k]
                for j in range(k + 1, n):
                    matrix[i, j] -= share * matrix[k, j]
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            right[k] -= matrix[k, j] * right[j]
        right[k] /= matrix[k, k]
