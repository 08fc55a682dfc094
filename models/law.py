"""Force laws: one plain Python function each, compiled to machine code on first use.

A law is written once, as a scalar function of (time s, q, v, internal state z, parameters). The time steppers call
its compiled form through a pointer; figures and other simulators call the Python function itself.
"""

from collections.abc import Callable, Sequence
from functools import cache

LawFunction = Callable[[float, float, float, float, Sequence[float]], float]


@cache
def law_address(law: LawFunction) -> int:
    """Address of the compiled law, callable from numba code and from any C interface.

    Args:
        law: ``law(t, q, v, z, p) -> float``, using only arithmetic, ``math`` and indexing of ``p``.

    Returns:
        the address of ``double law(double t, double q, double v, double z, const double *p)``.
    """
    from numba import cfunc, types

    signature = types.float64(types.float64, types.float64, types.float64, types.float64, types.CPointer(types.float64))
    compiled = cfunc(signature, cache=True)(law)
    _keep_alive.append(compiled)
    return int(compiled.address or 0)


_keep_alive: list[object] = []
