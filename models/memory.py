"""Freed memory is kept, since asking the system for it again takes longer than what is computed in it.

A simulation fills arrays of some megabytes that are freed at its end. By default the C library hands them back to the
system, and each page that is touched again in the next simulation is a fault: a quarter of the time.
"""

import ctypes
import sys

TRIM_THRESHOLD, MMAP_THRESHOLD = -1, -3
"""Of ``mallopt``, as numbered in malloc.h."""

LARGEST_KEPT = 32 * 2**20
"""Bytes of an array that does not go back to the system by itself; the C library allows no more."""

MOST_KEPT = 256 * 2**20
"""Bytes that stay with the process when they are free."""


def keep_freed_memory() -> bool:
    """Let the process keep what it frees; False, and no change, where the C library is not glibc."""
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None) if sys.platform == "linux" else None
    if mallopt is None:
        return False
    return bool(mallopt(MMAP_THRESHOLD, LARGEST_KEPT)) and bool(mallopt(TRIM_THRESHOLD, MOST_KEPT))
