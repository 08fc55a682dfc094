"""The balance of harmonics and its slopes as compiled code.

A curve of a few hundred motions asks for these some thousand times, and arrays of some sixty numbers take numpy longer
to begin with than to work through. Coefficients are real here: mean, then real and imaginary part of each harmonic.
"""

from typing import NamedTuple

import numpy as np

from models.arrays import ComplexArray, FloatArray
from models.compiled import compiled
from models.harmonic_balance.forces import forces_and_slopes, forces_at
from models.point_forces import Items


class Waves(NamedTuple):
    """Between the N samples of a period and its coefficients.

    Attributes:
        to_time: (2 H + 1, N) samples by coefficient.
        to_harmonics: (N, 2 H + 1) coefficients by sample.
        to_more: (N, 4 H + 1) up to twice the highest harmonic, as slopes need.
    """

    to_time: FloatArray
    to_harmonics: FloatArray
    to_more: FloatArray


class Frame(NamedTuple):
    """What stays while a curve is followed with H harmonics.

    Attributes:
        items: compiled laws and contacts.
        rest: (n_ports,) displacement at rest, m.
        rest_force: (n_ports,) of the laws at rest, N.
        absolute: (n_ports,) 1 where a law reads absolute motion and the base moves.
        poles: (2n,) of the linear part, 1/s.
        residues: (2n, n_ports * (n_ports + 1)) from the ports and the excitation to the ports.
        waves: between samples and coefficients.
    """

    items: Items
    rest: FloatArray
    rest_force: FloatArray
    absolute: FloatArray
    poles: ComplexArray
    residues: ComplexArray
    waves: Waves


class Sine(NamedTuple):
    """The excitation: two-sided coefficients of its harmonic, each with its slopes over frequency and amplitude.

    Attributes:
        omega: rad/s.
        base, base_by_omega, base_by_amplitude: displacement of the base, m.
        given, given_by_omega, given_by_amplitude: force, N, or acceleration of the base, m/s^2.
    """

    omega: float
    base: complex
    base_by_omega: complex
    base_by_amplitude: complex
    given: complex
    given_by_omega: complex
    given_by_amplitude: complex


@compiled
def _motion_of(frame: Frame, y: FloatArray, sine: Sine) -> tuple[FloatArray, FloatArray, float]:
    """(n_ports, N) displacement, m, and velocity, m/s, as the laws see them, and the time between samples, s.

    Args:
        frame: of the equations.
        y: (n_ports, 2 H + 1) coefficients about rest, m.
        sine: the excitation.
    """
    n_ports, size = y.shape
    seen = np.empty((2 * n_ports, size))
    for i in range(n_ports):
        seen[i] = y[i]
        seen[i, 1] += frame.absolute[i] * sine.base.real
        seen[i, 2] += frame.absolute[i] * sine.base.imag
        seen[n_ports + i, 0] = 0.0
        for k in range(1, size // 2 + 1):
            turn = k * sine.omega
            seen[n_ports + i, 2 * k - 1] = -turn * seen[i, 2 * k]
            seen[n_ports + i, 2 * k] = turn * seen[i, 2 * k - 1]
    moved = np.dot(seen, frame.waves.to_time)
    for i in range(n_ports):
        moved[i] += frame.rest[i]
    return moved[:n_ports], moved[n_ports:], 2.0 * np.pi / (sine.omega * moved.shape[1])


@compiled
def _shares(poles: ComplexArray, omega: float, kept: int) -> ComplexArray:
    """(kept, 2n) what each pole does to the harmonics from 0 on: 1 / (i k omega - pole), s."""
    shares = np.empty((kept, poles.shape[0]), np.complex128)
    for k in range(kept):
        for m in range(poles.shape[0]):
            away = 1j * omega * k - poles[m]
            shares[k, m] = np.conj(away) / (away.real**2 + away.imag**2)
    return shares


@compiled
def _at(coefficients: FloatArray, i: int, k: int) -> complex:
    """Harmonic k, which may be negative, of row i."""
    if k == 0:
        return complex(coefficients[i, 0], 0.0)
    if k < 0:
        return complex(coefficients[i, -2 * k - 1], -coefficients[i, -2 * k])
    return complex(coefficients[i, 2 * k - 1], coefficients[i, 2 * k])


@compiled
def _put(y: FloatArray, i: int, k: int, value: complex) -> None:
    """Set harmonic k of row i."""
    if k == 0:
        y[i, 0] = value.real
    else:
        y[i, 2 * k - 1], y[i, 2 * k] = value.real, value.imag


@compiled
def over_period(frame: Frame, y: FloatArray, sine: Sine) -> tuple[FloatArray, FloatArray, FloatArray]:
    """(n_ports, N) forces less those at rest, N, and their slopes over the motion, N/m and N s/m.

    Args:
        frame: of the equations.
        y: (n_ports, 2 H + 1) coefficients about rest, m.
        sine: the excitation.
    """
    q, v, h = _motion_of(frame, y, sine)
    force, by_q, by_v = forces_and_slopes(frame.items, q, v, h)
    for i in range(force.shape[0]):
        force[i] -= frame.rest_force[i]
    return force, by_q, by_v


@compiled
def residual_of(frame: Frame, y: FloatArray, sine: Sine) -> FloatArray:
    """(n_ports, 2 H + 1) what is left: motion less what forces and excitation make of it, m.

    Args:
        frame: of the equations.
        y: (n_ports, 2 H + 1) coefficients about rest, m.
        sine: the excitation.
    """
    n_ports, size = y.shape
    q, v, h = _motion_of(frame, y, sine)
    force = forces_at(frame.items, q, v, h)
    for i in range(n_ports):
        force[i] -= frame.rest_force[i]
    pushed = np.dot(force, frame.waves.to_harmonics)
    n_kept = size // 2 + 1
    response = np.dot(_shares(frame.poles, sine.omega, n_kept), frame.residues).reshape(n_kept, n_ports, n_ports + 1)
    left = np.empty_like(y)
    for k in range(n_kept):
        for o in range(n_ports):
            moved = response[k, o, n_ports] * sine.given if k == 1 else 0.0j
            for i in range(n_ports):
                moved += response[k, o, i] * _at(pushed, i, k)
            _put(left, o, k, _at(y, o, k) - moved)
    return left


@compiled
def slopes_of(frame: Frame, y: FloatArray, sine: Sine) -> FloatArray:
    """(n, n + 2) slopes of what is left over the coefficients, m/m, omega, m s, and the amplitude.

    Args:
        frame: of the equations.
        y: (n_ports, 2 H + 1) coefficients about rest, m; n of them in all.
        sine: the excitation.
    """
    n_ports, size = y.shape
    q, v, h = _motion_of(frame, y, sine)
    force, by_q, by_v = forces_and_slopes(frame.items, q, v, h)
    course = np.empty((4 * n_ports, q.shape[1]))
    for i in range(n_ports):
        course[i], course[n_ports + i] = force[i] - frame.rest_force[i], by_v[i] * v[i]
        course[2 * n_ports + i], course[3 * n_ports + i] = by_q[i], by_v[i]
    spectra = np.dot(course, frame.waves.to_more)
    pushed, changed = spectra[:n_ports], spectra[n_ports : 2 * n_ports]
    slope_q, slope_v = spectra[2 * n_ports : 3 * n_ports], spectra[3 * n_ports :]
    n_kept, shares = size // 2 + 1, _shares(frame.poles, sine.omega, size // 2 + 1)
    response = np.dot(shares, frame.residues).reshape(n_kept, n_ports, n_ports + 1)
    response_slope = np.dot(-shares * shares, frame.residues).reshape(n_kept, n_ports, n_ports + 1)
    slopes = np.empty((n_ports * size, n_ports * size + 2))
    _over_motion(slope_q, slope_v, response, sine.omega, slopes)
    for k in range(n_kept):
        for o in range(n_ports):
            by_omega, by_amplitude = 0.0j, 0.0j
            if k == 1:
                direct, turned = response[1, o, n_ports], response_slope[1, o, n_ports]
                by_omega -= direct * sine.given_by_omega + 1j * turned * sine.given
                by_amplitude -= direct * sine.given_by_amplitude
            for i in range(n_ports):
                # v = i k omega x and the base's motion change with omega, and so do the receptances.
                seen = frame.absolute[i]
                forth, back = _coupling(slope_q, slope_v, i, k, 1, sine.omega)
                turned = _at(changed, i, k) / sine.omega
                turned += seen * (forth * sine.base_by_omega + back * np.conj(sine.base_by_omega))
                by_omega -= response[k, o, i] * turned + 1j * k * response_slope[k, o, i] * _at(pushed, i, k)
                moved = seen * (forth * sine.base_by_amplitude + back * np.conj(sine.base_by_amplitude))
                by_amplitude -= response[k, o, i] * moved
            row = o * size + max(0, 2 * k - 1)
            slopes[row, -2], slopes[row, -1] = by_omega.real, by_amplitude.real
            if k > 0:
                slopes[row + 1, -2], slopes[row + 1, -1] = by_omega.imag, by_amplitude.imag
    return slopes


@compiled
def _coupling(
    slope_q: FloatArray, slope_v: FloatArray, i: int, row: int, column: int, omega: float
) -> tuple[complex, complex]:
    """A harmonic of the force at port i by one of its motion, and by that one's conjugate, which the mean has not."""
    turn = 1j * omega * column
    forth = _at(slope_q, i, row - column) + turn * _at(slope_v, i, row - column)
    if column == 0:
        return forth, 0.0j
    return forth, _at(slope_q, i, row + column) - turn * _at(slope_v, i, row + column)


@compiled
def _over_motion(
    slope_q: FloatArray, slope_v: FloatArray, response: ComplexArray, omega: float, slopes: FloatArray
) -> None:
    """Fill in the slopes of x - H f over the coefficients of x."""
    n_ports, kept = response.shape[1], response.shape[0]
    size = 2 * kept - 1
    for i in range(n_ports):
        for r in range(kept):
            forth, _ = _coupling(slope_q, slope_v, i, r, 0, omega)
            for o in range(n_ports):
                moved = response[r, o, i] * forth
                row = o * size + max(0, 2 * r - 1)
                slopes[row, i * size] = -moved.real
                if r > 0:
                    slopes[row + 1, i * size] = -moved.imag
            for c in range(1, kept):
                forth, back = _coupling(slope_q, slope_v, i, r, c, omega)
                plus, minus = forth + back, forth - back
                column = i * size + 2 * c - 1
                for o in range(n_ports):
                    own = response[r, o, i]
                    row = o * size + max(0, 2 * r - 1)
                    slopes[row, column] = own.imag * plus.imag - own.real * plus.real
                    slopes[row, column + 1] = own.real * minus.imag + own.imag * minus.real
                    if r > 0:
                        slopes[row + 1, column] = -own.real * plus.imag - own.imag * plus.real
                        slopes[row + 1, column + 1] = own.imag * minus.imag - own.real * minus.real
    for k in range(n_ports * size):
        slopes[k, k] += 1.0
