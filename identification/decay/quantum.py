"""A quantum-inspired genetic algorithm: bit strings observed from qubits that turn towards the best string.

Qubits are (2, population, length) amplitudes alpha of 0 and beta of 1, so a qubit is observed as 1 with probability
beta^2. They start positive and no operator here changes a sign, so a turn by a positive angle goes towards 1 and the
cases of sign in the table of Han and Kim do not arise.
"""

import math
from dataclasses import dataclass

import numpy as np

from identification.decay.search import Objective, RememberingObjective, Search, check_box
from models.arrays import BoolArray, FloatArray
from models.errors import InputError

METHOD = "quantum genetic algorithm"

MARGIN = 0.03
"""rad: a qubit turns no closer than this to a sure bit, which leaves it a chance of sin^2 = 0.1 % to be the other."""

RANGES = {
    "population": (2, math.inf),
    "bits": (2, 52),  # positions are numbered by floats, which are exact up to 2^53
    "rotation_angle": (1e-6, 0.5 * math.pi),
    "crossover_rate": (0, 1),
    "mutation_rate": (0, 1),
    "catastrophe_after": (1, math.inf),
    "max_iterations": (1, math.inf),
    "tolerance": (0, 1),
    "memory": (1, math.inf),
}


@dataclass(frozen=True)
class QuantumSettings:
    """How the quantum genetic algorithm searches.

    Attributes:
        population: chromosomes, each observed once in an iteration; 2 or more, so that they can cross.
        bits: qubits per variable; it takes 2^bits positions, (upper - lower) / (2^bits - 1) apart, bounds included.
        rotation_angle: rad, turn of a qubit towards the bit of the best string.
        crossover_rate: chance that a pair of chromosomes exchanges its tails.
        mutation_rate: chance that a qubit exchanges its amplitudes.
        catastrophe_after: iterations without gain after which all qubits forget what they learnt.
        max_iterations: iterations at most.
        tolerance: the best value gains when it falls by more than this share of itself.
        memory: iterations without gain after the catastrophe that end the search.

    Raises:
        InputError: a setting outside ``RANGES``.
    """

    population: int = 10
    bits: int = 12
    rotation_angle: float = 0.05 * math.pi
    crossover_rate: float = 0.6
    mutation_rate: float = 0.02
    catastrophe_after: int = 10
    max_iterations: int = 100
    tolerance: float = 1e-4
    memory: int = 10

    def __post_init__(self) -> None:
        for name, (low, high) in RANGES.items():
            value = getattr(self, name)
            if not low <= value <= high:
                limits = f"{low:g} or more" if high == math.inf else f"from {low:g} to {high:g}"
                raise InputError(
                    f"QuantumSettings.{name} = {value:g}",
                    f"it is {limits}",
                    "change it, or leave it out for its default",
                )


def quantum_search(
    objective: Objective, lower: FloatArray, upper: FloatArray, settings: QuantumSettings, seed: int
) -> Search:
    """Look for the lowest value of an objective in a box with a quantum-inspired genetic algorithm.

    To stop as soon as the best value has changed by less than 1e-4 of itself over 10 iterations would end a search that
    sits on one string before a catastrophe can free it. So the catastrophe comes first, once per best value, and the
    10 iterations count from it: a search stops when its catastrophe has brought nothing. A gain starts both counts
    anew. The change is compared with a share of the best value and not divided by it, which may be 0.

    Args:
        objective: takes (n_var,), returns a number; asked once per position.
        lower: (n_var,) lower bounds.
        upper: (n_var,) upper bounds.
        settings: population, operators and stopping rule.
        seed: of the random numbers; the same seed gives the same bits.

    Raises:
        InputError: a box that is empty or not finite, or an objective of nan.

    Source: Han and Kim, IEEE Trans. Evol. Comput. 6 (2002) 580; margins: Han and Kim, ibid. 8 (2004) 156.
    """
    check_box(lower, upper)
    ask = RememberingObjective(objective)
    rng = np.random.default_rng(seed)
    qubits = even_qubits(settings.population, lower.size * settings.bits)
    best, best_string = math.inf, np.zeros(lower.size * settings.bits, dtype=bool)
    history: list[float] = []
    reason = f"the limit of {settings.max_iterations} iterations was reached"
    while len(history) < settings.max_iterations:
        strings = observe(qubits, rng)
        values = np.array([ask(position) for position in decode(strings, lower, upper)])
        if values.min() < best:
            best, best_string = float(values.min()), strings[values.argmin()]
        history.append(best)
        quiet = iterations_without_gain(history, settings.tolerance)
        if quiet == settings.catastrophe_after + settings.memory:
            reason = f"no gain above {settings.tolerance:g} of the best value in {settings.memory} iterations"
            reason += " after a catastrophe"
            break
        if quiet == settings.catastrophe_after:
            qubits = even_qubits(*strings.shape)
        else:
            worse = (values > best)[:, np.newaxis]
            qubits = rotate(qubits, best_string, settings.rotation_angle * (worse & (strings != best_string)))
        qubits = mutate(cross(qubits, settings.crossover_rate, rng), settings.mutation_rate, rng)
    return ask.close(METHOD, reason, np.array(history))


def iterations_without_gain(history: list[float], tolerance: float) -> int:
    """Iterations since the best value last fell by more than a share of itself, small falls added up.

    Args:
        history: the best value after each iteration.
        tolerance: the share.
    """
    mark, last = history[0], 0
    for k, best in enumerate(history):
        if mark - best > tolerance * abs(best):
            mark, last = best, k
    return len(history) - 1 - last


def even_qubits(population: int, length: int) -> FloatArray:
    """Qubits (2, population, length) from which every string is observed with the same probability."""
    return np.full((2, population, length), math.sqrt(0.5))


def observe(qubits: FloatArray, rng: np.random.Generator) -> BoolArray:
    """Draw one string (population, length) per chromosome, each bit true with probability beta^2."""
    return np.asarray(rng.random(qubits.shape[1:]) < qubits[1] ** 2)


def decode(strings: BoolArray, lower: FloatArray, upper: FloatArray) -> FloatArray:
    """Positions (population, n_var) of strings (population, n_var * bits) in Gray code.

    Neighbours differ by one bit in Gray code; in plain binary the middle of the box is a cliff where all bits change.

    Source: Press et al., Numerical Recipes, 2007, section 22.3.
    """
    gray = strings.reshape(len(strings), lower.size, -1)
    binary = np.logical_xor.accumulate(gray, axis=-1)
    powers = 2.0 ** np.arange(binary.shape[-1])[::-1]
    share = binary @ powers / powers.sum()
    return np.asarray(lower * (1.0 - share) + upper * share)


def rotate(qubits: FloatArray, towards: BoolArray, angle: FloatArray) -> FloatArray:
    """Turn qubits towards bits with the rotation gate, as far as the margins.

    Args:
        qubits: (2, population, length).
        towards: (length,) bits.
        angle: (population, length) rad, 0 or more.

    Source: Han and Kim, 2002, section III, for the gate and its table.
    """
    alpha, beta = qubits
    before = np.arctan2(beta, alpha)
    turn = np.clip(before + np.where(towards, angle, -angle), MARGIN, 0.5 * math.pi - MARGIN) - before
    cos, sin = np.cos(turn), np.sin(turn)
    return np.stack((cos * alpha - sin * beta, sin * alpha + cos * beta))


def cross(qubits: FloatArray, rate: float, rng: np.random.Generator) -> FloatArray:
    """Pair the chromosomes at random and let each pair exchange its qubits beyond a random cut, at that rate."""
    _, population, length = qubits.shape
    first, second = rng.permutation(population)[: population // 2 * 2].reshape(2, -1)
    cut = rng.integers(1, length, size=(first.size, 1))
    tails = (np.arange(length) >= cut) & (rng.random((first.size, 1)) < rate)
    crossed = qubits.copy()
    crossed[:, first] = np.where(tails, qubits[:, second], qubits[:, first])
    crossed[:, second] = np.where(tails, qubits[:, first], qubits[:, second])
    return crossed


def mutate(qubits: FloatArray, rate: float, rng: np.random.Generator) -> FloatArray:
    """Let each qubit exchange its two amplitudes, the quantum NOT gate, at that rate."""
    return np.where(rng.random(qubits.shape[1:]) < rate, qubits[::-1], qubits)
