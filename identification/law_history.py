"""Forces that contacts and point laws give along a motion that is known already."""

from typing import Any

import numpy as np
from numba import njit

from models.arrays import FloatArray
from models.compiled import noticing
from models.contact_forces import internal_state, normal_force, on_structure, penetration_of
from models.law import law_address
from models.law_call import call_law
from models.ports import Contact, PointLaw
from models.rest import is_bilateral

OPTIONS: dict[str, Any] = {"nogil": True, "cache": True}

BUILT_IN = "../models/contact_forces.py", "../models/law_call.py", "../models/step_options.py"
"""Files of which the code of these kernels holds some."""


def law_along(law: PointLaw, q: FloatArray, v: FloatArray, fs: float) -> FloatArray:
    """(M,) force of a point law on the structure, N, its internal state marched along from 0.

    Args:
        law: the law.
        q: (M,) m, as the law sees it.
        v: (M,) m/s.
        fs: samples per second, Hz.
    """
    rate = 0 if law.rate is None else law_address(law.rate)
    return np.asarray(_law_along(law_address(law.force), rate, np.array(law.parameters, float), q, v, 1.0 / fs))


def contact_along(contact: Contact, q: FloatArray, v: FloatArray, fs: float) -> FloatArray:
    """(M,) force of a sleeve on the structure, N, positive upwards.

    Args:
        contact: the sleeve.
        q: (M,) m.
        v: (M,) m/s.
        fs: samples per second, Hz.
    """
    gap = (contact.clearance, contact.offset, contact.clearance_rate, float(is_bilateral(contact)))
    law, values = law_address(contact.law.normal_force), np.array(contact.law.values, float)
    return np.asarray(_contact_along(law, values, np.array([gap]), q, v, 1.0 / fs))


@noticing(*BUILT_IN)
@njit(**OPTIONS)
def _law_along(law: int, rate: int, values: FloatArray, q: FloatArray, v: FloatArray, h: float) -> FloatArray:
    force = np.empty(len(q))
    z = 0.0
    for i in range(len(q)):
        if rate != 0 and i > 0:
            z = internal_state(rate, values, 0, i * h, h, q[i - 1], v[i - 1], z, q[i], v[i])
        force[i] = call_law(law, i * h, q[i], v[i], z, values, 0)
    return force


@noticing(*BUILT_IN)
@njit(**OPTIONS)
def _contact_along(law: int, values: FloatArray, gap: FloatArray, q: FloatArray, v: FloatArray, h: float) -> FloatArray:
    force = np.empty(len(q))
    for i in range(len(q)):
        p, p_rate, side = penetration_of(gap, 0, i * h, q[i], v[i])
        normal = normal_force(law, values, 0, i * h, p, p_rate, gap[0, 3])
        force[i] = on_structure(normal, side, gap[0, 3])
    return force
