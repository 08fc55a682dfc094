"""From a coefficient of restitution to the damping of a contact law, as the literature has it, and what comes of it.

Every law of the form N = k p^n (1 + a dp/dt) gives a mass m back a share e of the speed v with which it struck, and e
depends on the product d = a v alone: m w dw/dp = -k p^n (1 + a w) separates into w / (1 + a w) dw = -(k / m) p^n dp,
whose left side, over the speeds from v to -e v, comes to zero, since p returns to where it was:

    d (1 + e) = ln((1 + d) / (1 - d e)).

The published rules d(e) are approximations of this, each with its own way of guessing the motion while in contact.
Source of the closed form: D. W. Marhefka, D. E. Orin, IEEE Trans. Syst. Man Cybern. A 29 (1999) 566.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import atan2, exp, log, log1p, pi, sqrt

from scipy.optimize import brentq


@dataclass(frozen=True)
class Rule:
    """How an author chooses the damping for a restitution.

    Attributes:
        author: as the tables name it.
        dissipation: d = a v from the restitution that is set.
        source: where it was published.
        valid: for what it was meant, in words.
    """

    author: str
    dissipation: Callable[[float], float]
    source: str
    valid: str


RULES: dict[str, Rule] = {
    "hunt_crossley": Rule(
        "Hunt and Crossley",
        lambda e: 1.5 * (1.0 - e),
        "J. Appl. Mech. 42 (1975) 440",
        "e near 1: the speed in contact is that of a lossless impact",
    ),
    "herbert_mcwhannell": Rule(
        "Herbert and McWhannell",
        lambda e: 6.0 * (1.0 - e) / ((2.0 * e - 1.0) ** 2 + 3.0),
        "J. Eng. Ind. 99 (1977) 657",
        "e near 1",
    ),
    "lee_wang": Rule(
        "Lee and Wang", lambda e: 0.75 * (1.0 - e), "J. Mech. Trans. Autom. Des. 105 (1983) 252", "light loss only"
    ),
    "lankarani_nikravesh": Rule(
        "Lankarani and Nikravesh",
        lambda e: 0.75 * (1.0 - e**2),
        "J. Mech. Des. 112 (1990) 369",
        "e near 1: the energy lost is small beside that in the contact",
    ),
    "gonthier": Rule(
        "Gonthier et al.",
        lambda e: (1.0 - e**2) / e,
        "Multibody Syst. Dyn. 11 (2004) 209",
        "all e, approximately",
    ),
    "flores": Rule(
        "Flores et al.",
        lambda e: 1.6 * (1.0 - e) / e,
        "Multibody Syst. Dyn. 25 (2011) 357",
        "all e, approximately; soft contacts",
    ),
    "exact": Rule("exact rule", lambda e: exact_dissipation(e), "Marhefka and Orin (1999)", "all e"),  # noqa: PLW0108
}


def obtained(dissipation: float) -> float:
    """Restitution that d = a v brings about.

    Args:
        dissipation: d, not negative.
    """
    if dissipation < SLIGHT:
        return 1.0 - dissipation / 1.5
    highest = min(1.0, CAUGHT / dissipation)
    if _balance(dissipation, highest) <= 0.0:
        return highest
    return float(brentq(lambda e: _balance(dissipation, e), 0.0, highest, xtol=1e-14))


def exact_dissipation(restitution: float) -> float:
    """d = a v that brings about a restitution.

    Args:
        restitution: above 0, at most 1.
    """
    slight = 1.5 * (1.0 - restitution)
    if slight < SLIGHT:
        return slight
    highest = CAUGHT / restitution
    if _balance(highest, restitution) <= 0.0:
        return highest
    return float(brentq(lambda d: _balance(d, restitution), 0.5 * slight, highest, xtol=1e-14))


CAUGHT = 1.0 - 1e-15
"""Largest d e; at 1 the mass parts so slowly that the contact's dashpot alone lets it go."""


SLIGHT = 1e-4
"""A d below which 1 - e is two thirds of it, to its own square."""


def _balance(d: float, e: float) -> float:
    """Of work and speed over an impact; 0 for the restitution that d brings about."""
    return log1p(d) - log1p(-d * e) - d * (1.0 + e)


def damping_ratio(restitution: float) -> float:
    """Damping ratio of spring and dashpot that never pull, for a restitution.

    Source: T. Schwager, T. Poeschel, Granular Matter 9 (2007) 465: contact ends where the force does.

    Args:
        restitution: above 0, at most 1.
    """
    if restitution >= 1.0:
        return 0.0
    return float(brentq(lambda zeta: restitution_of(zeta) - restitution, 0.0, HEAVIEST, xtol=1e-14))


HEAVIEST = 50.0
"""Damping ratio up to which one is sought."""


def restitution_of(zeta: float) -> float:
    """Restitution of spring and dashpot that never pull.

    The force k p + c dp/dt ends where tan(w t) = -2 b w / (w^2 - b^2), with b the decay rate and w the frequency of the
    free decay, and the speed is then exp(-b t) of the first.

    Args:
        zeta: damping ratio c / (2 sqrt(k m)).
    """
    if zeta == 1.0:
        return exp(-2.0)
    if zeta < 1.0:
        damped = sqrt(1.0 - zeta**2)
        return exp(-zeta / damped * (pi - atan2(2.0 * zeta * damped, damped**2 - zeta**2)))
    damped = sqrt(zeta**2 - 1.0)
    return exp(-zeta / damped * log((zeta + damped) / (zeta - damped)))


def hardness(mass: float, speed: float, stiffness: float, exponent: float) -> tuple[float, float, float]:
    """(largest penetration m, largest force N, time in contact s) of a lossless impact on k p^n.

    Args:
        mass: kg.
        speed: m/s.
        stiffness: k, N/m^n.
        exponent: n.
    """
    from scipy.special import gamma

    depth = ((exponent + 1.0) * mass * speed**2 / (2.0 * stiffness)) ** (1.0 / (exponent + 1.0))
    share = 1.0 / (exponent + 1.0)
    lasts = 2.0 * depth / speed * sqrt(pi) * float(gamma(1.0 + share) / gamma(0.5 + share))
    return depth, stiffness * depth**exponent, lasts
