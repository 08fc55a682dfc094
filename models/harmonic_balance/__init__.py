"""Periodic motion of the modal model by harmonic balance: nonlinear FRFs, their stability, and backbone curves."""

from models.harmonic_balance.backbone import backbone
from models.harmonic_balance.curve import PeriodicCurve
from models.harmonic_balance.frf import from_both_ends, nonlinear_frf

__all__ = ["PeriodicCurve", "backbone", "from_both_ends", "nonlinear_frf"]
