"""How the kernels of the time stepper are compiled."""

from typing import Any

OPTIONS: dict[str, Any] = {
    "nogil": True,
    "cache": True,
    "error_model": "numpy",
    "fastmath": {"contract", "reassoc", "nsz", "arcp"},
}
"""A division by nothing gives no number, which counts as a motion that is lost."""

INLINE: dict[str, Any] = {**OPTIONS, "cache": False, "forceinline": True}
"""For what runs in every step: a call that hands over arrays would cost more than the arithmetic. It is kept on disk
with what it is built into alone, which notices the files that it comes from."""
