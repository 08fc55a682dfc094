"""The reference rig with a damping that varies, for the tests of the co-simulation."""

from pathlib import Path

from models.rig import EffectEntry
from models.rig_file import read_rig

REFERENCE = read_rig(Path(__file__).parents[2] / "data" / "reference_rig.toml")
SLEEVE = "sleeve 2"
"""It touches at rest; sleeve 1 does not."""


def varying(times, values, rig=REFERENCE, sleeve=SLEEVE):
    entry = EffectEntry(kind="time_varying_damping", sleeve=sleeve, times=tuple(times), values=tuple(values))
    return rig.model_copy(update={"effects": (*rig.effects, entry)})


def with_sleeves(**changes):
    """The reference rig, all of whose sleeves are changed."""
    return REFERENCE.model_copy(update={"sleeves": tuple(s.model_copy(update=changes) for s in REFERENCE.sleeves)})


def silent(_text):
    """No progress."""
