"""A modal model as the compiled stepper takes it: the tables of one step, and of the laws and contacts."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from models.arrays import FloatArray
from models.contact.protocol import ContactLaw
from models.drive import Drive
from models.law import law_address
from models.modal import ModalModel, Modes
from models.ports import Port
from models.propagator import Blocks, Step, exact_step, to_blocks
from models.rest import is_bilateral
from models.stepping import Items, Linear, Reading


def linear_of(model: ModalModel, drive: Drive, h: float) -> tuple[Blocks, Linear, FloatArray]:
    """The linear system, a step of it as the stepper takes it, and the (n_in, M) known inputs."""
    system, step, motion = _step_of(model.modes, model.ports, _driven_at(model), h)
    columns, signals = signals_of(model, drive)
    return system, linear_with(model, step, columns, motion, h), np.stack(signals)


def signals_of(model: ModalModel, drive: Drive) -> tuple[list[int], list[FloatArray]]:
    """Which of ``input_columns`` are known beforehand, and their (M,) courses."""
    given = enumerate((drive.force, drive.base), start=len(model.ports))
    known = [(column, signal) for column, signal in given if signal is not None]
    return [column for column, _ in known], [signal for _, signal in known]


def linear_with(
    model: ModalModel, step: Step, columns: Sequence[int], motion: tuple[Reading, Reading], h: float
) -> Linear:
    """A step as the stepper takes it.

    Args:
        model: with its ports.
        step: for the ports' forces and the known inputs.
        columns: the inputs that act.
        motion: q and v of the ports from the state.
        h: s.
    """
    n_ports = len(model.ports)
    return Linear(
        exponential=step.exponential,
        in_start=step.start[columns],
        in_end=step.end[columns],
        port_start=step.start[:n_ports],
        port_end=step.end[:n_ports],
        q=motion[0],
        v=motion[1],
        q_rest=model.rest.position,
        absolute=np.array([1.0 if port.frame == "ground" else 0.0 for port in model.ports]),
        h=h,
    )


def input_columns(model: ModalModel) -> FloatArray:
    """(n, n_ports + 2) modal force per unit of each port's force, of the excitation and of the base's acceleration."""
    return _columns_of(model.modes, model.ports, _driven_at(model))


def _driven_at(model: ModalModel) -> float | None:
    return None if model.plant.excitation is None else model.plant.excitation.position


def _columns_of(modes: Modes, ports: tuple[Port, ...], driven_at: float | None) -> FloatArray:
    return np.column_stack([*modes.port_rows(ports), modes.rows(driven_at), -modes.carried])


@lru_cache(maxsize=256)
def _step_of(
    modes: Modes, ports: tuple[Port, ...], driven_at: float | None, h: float
) -> tuple[Blocks, Step, tuple[Reading, Reading]]:
    """The linear system, a step of it, and q and v of its ports, kept while only contacts, laws and records change."""
    system = to_blocks(modes.omega, modes.damping, _columns_of(modes, ports, driven_at))
    rows = modes.port_rows(ports)
    return system, exact_step(system, h), (Reading.of(system.displacement(rows)), Reading.of(system.velocity(rows)))


def items_of(model: ModalModel) -> Items:
    """Point laws, then contacts, as the stepper takes them."""
    laws, contacts = model.plant.laws, model.plant.contacts
    index = {port: i for i, port in enumerate(model.ports)}
    numbers = [law.parameters for law in laws] + [contact.law.values for contact in contacts]
    forces = [law.force for law in laws] + [contact.law.normal_force for contact in contacts]
    rates = [law_address(law.rate) if law.rate is not None else 0 for law in laws] + [0] * len(contacts)
    gaps = [(0.0,) * 4 for _ in laws]
    straight = [(0.0,) * 3 for _ in laws] + [_straight(contact.law) for contact in contacts]
    gaps += [(c.clearance, c.offset, c.clearance_rate, float(is_bilateral(c))) for c in contacts]
    return Items(
        port=np.array([index[law.port] for law in laws] + [index[Port(c.position)] for c in contacts], np.int64),
        law=np.array([law_address(force) for force in forces], np.int64),
        rate=np.array(rates, np.int64),
        values=np.array([number for row in numbers for number in row], float),
        offset=np.cumsum([0, *(len(row) for row in numbers)])[:-1].astype(np.int64),
        contact=np.array(gaps, float).reshape(-1, 4),
        is_contact=np.array([0] * len(laws) + [1] * len(contacts), np.int64),
        straight=np.array(straight, float).reshape(-1, 3),
        rest_force=np.concatenate([model.rest.law_forces, model.rest.contact_forces]),
    )


def _straight(law: ContactLaw) -> tuple[float, float, float]:
    """A row of ``Items.straight``."""
    return (0.0, 0.0, 0.0) if law.straight is None else (1.0, *law.straight)
