"""A rig file that is written like another keeps its owner's comments, order and number formats."""

from pathlib import Path

import pytest

from models.rig import EffectEntry, Excitation, Oscillator, Sensor
from models.rig_file import read_rig, write_rig

REFERENCE = Path(__file__).parents[1] / "data" / "reference_rig.toml"
OSCILLATOR_TOML = '[structure]\nkind = "oscillator"\nmass = 1.0\nstiffness = 2.0\ndamping = 0.1\n'
FILM = EffectEntry(kind="squeeze_film", sleeve="sleeve 2", damping=18.5)
GREASE = EffectEntry(kind="time_varying_damping", sleeve="sleeve 1", times=(0.0, 5.0), values=(90.0, 20.0))
MOVED = EffectEntry(kind="sensor_position", sensor="P1", position=0.2)


def lines_changed(old: str, new: str) -> list[tuple[str, str]]:
    pairs = zip(old.splitlines(), new.splitlines(), strict=True)
    return [(a, b) for a, b in pairs if a != b]


def rewritten(text: str, change, folder: Path) -> str:
    """The text after a change of its rig, written like it; the file holds the changed rig whatever its text is."""
    source, target = folder / "rig.toml", folder / "rig.updated.toml"
    source.write_bytes(text.encode())
    changed = change(read_rig(source))
    write_rig(changed, target, like=source)
    assert read_rig(target) == changed
    return target.read_bytes().decode()


def having(**parts):
    return lambda rig: rig.model_copy(update=parts)


@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_an_unchanged_rig_is_written_byte_for_byte(tmp_path, line_end, mark):
    text = mark + REFERENCE.read_text().replace("\n", line_end)
    assert rewritten(text, lambda rig: rig.with_values({p.path: p.value for p in rig.parameters()}), tmp_path) == text


def test_only_the_changed_values_change_and_their_comments_stay(tmp_path):
    values = {"youngs_modulus": 2.05e11, "rayleigh_damping[1]": 7e-6, "sleeves[0].clearance": 1.6e-4, "gravity": 0}
    text = REFERENCE.read_text()
    assert lines_changed(text, rewritten(text, lambda rig: rig.with_values(values), tmp_path)) == [
        ("youngs_modulus = 210e9           # Pa", "youngs_modulus = 205000000000.0           # Pa"),
        (
            "rayleigh_damping = [1.2, 6e-6]   # eta1 1/s, eta2 s:  C = eta1 M + eta2 K",
            "rayleigh_damping = [1.2, 7e-06]   # eta1 1/s, eta2 s:  C = eta1 M + eta2 K",
        ),
        (
            "gravity = 9.81                   # m/s^2, downwards; 0 for a rig in orbit",
            "gravity = 0.0                   # m/s^2, downwards; 0 for a rig in orbit",
        ),
        (
            "clearance = 1.5e-4               # m, radial gap d; 0 is a bilateral linear support",
            "clearance = 0.00016               # m, radial gap d; 0 is a bilateral linear support",
        ),
    ]


def test_windows_line_ends_stay_when_something_changes(tmp_path):
    text = REFERENCE.read_text().replace("\n", "\r\n")
    edited = rewritten(text, having(effects=(FILM,)), tmp_path)
    assert edited.startswith(text)
    assert edited.count("\n") == edited.count("\r\n")


def test_new_effects_are_appended_kind_place_and_settings(tmp_path):
    text = REFERENCE.read_text()
    assert rewritten(text, having(effects=(FILM, GREASE, MOVED)), tmp_path) == text + (
        '\n[[effects]]\nkind = "squeeze_film"\nsleeve = "sleeve 2"\ndamping = 18.5\n'
        '\n[[effects]]\nkind = "time_varying_damping"\nsleeve = "sleeve 1"\ntimes = [0.0, 5.0]\nvalues = [90.0, 20.0]\n'
        '\n[[effects]]\nkind = "sensor_position"\nsensor = "P1"\nposition = 0.2\n'
    )


EFFECTS_TOML = """
[[effects]]            # found in May
kind = "squeeze_film"
sleeve = "sleeve 2"
damping = 18.5         # grease

# found in June
[[effects]]
kind = "time_varying_damping"
sleeve = "sleeve 1"
times = [0.0, 5.0]     # s
values = [90.0, 20.0]

# the end
"""


def test_a_removed_effect_leaves_the_comments_around_it(tmp_path):
    text = REFERENCE.read_text()
    kept = EFFECTS_TOML[EFFECTS_TOML.index("# found in June") :]
    assert rewritten(text + EFFECTS_TOML, having(effects=(GREASE,)), tmp_path) == f"{text}\n{kept}"
    assert rewritten(text + EFFECTS_TOML, having(effects=()), tmp_path) == f"{text}\n# found in June\n# the end\n"


def test_an_effect_that_changes_keeps_its_comments_beside_a_new_one(tmp_path):
    text = REFERENCE.read_text() + EFFECTS_TOML
    stronger = EffectEntry(kind="squeeze_film", sleeve="sleeve 2", damping=20.0)
    axial = EffectEntry(kind="axial_load", force=-40.0)
    edited = rewritten(text, having(effects=(stronger, GREASE, axial)), tmp_path)
    refitted = text.replace("damping = 18.5         # grease", "damping = 20.0         # grease")
    assert edited == refitted + '\n[[effects]]\nkind = "axial_load"\nforce = -40.0\n'


def test_a_key_that_was_left_out_is_added_above_the_next_comment(tmp_path):
    text = REFERENCE.read_text()
    line = (
        'quantity = "force"               # or base_acceleration, base_velocity, base_displacement (no position then)\n'
    )
    edited = rewritten(
        text, lambda rig: having(excitation=rig.excitation.model_copy(update={"sensitivity": "2 mV/N"}))(rig), tmp_path
    )
    assert edited == text.replace(line, f'{line}sensitivity = "2 mV/N"\n')


def test_tables_can_leave_and_the_rest_stays(tmp_path):
    text = REFERENCE.read_text()
    edited = rewritten(text, lambda rig: having(sleeves=rig.sleeves[1:], tolerances={})(rig), tmp_path)
    start, second = text.index("[tolerances]"), text.index('[[sleeves]]\nname = "sleeve 2"')
    assert edited == text[:start] + text[second:]


LAYOUTS = {
    "inline tables": (
        'structure = {kind = "oscillator", mass = 1.0, stiffness = 2, damping = 0.1}\n'
        'sensors = [{name = "a"}, {name = "b"}]\neffects = [{kind = "x", a = 1}]\n'
    ),
    "dotted keys": (
        'structure.kind = "oscillator"\nstructure.mass = 1.0\nstructure.stiffness = 2\nstructure.damping = 0.1\n'
        'excitation.name = "e"\neffects = []\n'
    ),
    "mixed order, no newline at the end": (
        '[[sensors]]\nname = "a"\n[[effects]]\nkind = "x"\n[[sensors]]\nname = "b"\n# c\n' + OSCILLATOR_TOML.strip()
    ),
    "empty tables": "effects = []\nsensors = []\n[tolerances]\n[excitation]\n" + OSCILLATOR_TOML,
}
CHANGES = {
    "grown": lambda rig: having(
        structure=rig.structure.model_copy(update={"gravity": 9.81, "damping": 0.3}),
        tolerances={"mass": 0.1},
        sensors=(*rig.sensors, Sensor(name="n")),
        excitation=Excitation(name="hammer", node=4),
        effects=(*rig.effects, EffectEntry(kind="y", b=(1.0, 2.0))),
    )(rig),
    "replaced": having(sensors=(Sensor(name="n", node=3),), effects=(EffectEntry(kind="y", b=2.0),)),
    "emptied": having(sensors=(), effects=(), excitation=None, tolerances={}),
}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("change", CHANGES)
def test_whatever_the_layout_the_file_holds_the_changed_rig(tmp_path, layout, change):
    rewritten(LAYOUTS[layout], CHANGES[change], tmp_path)


def test_a_default_that_changes_its_meaning_is_written_out(tmp_path):
    """A beam's gravity is 9.81 when left out, an oscillator's is 0."""
    text = '[structure]\nkind = "beam"\nlength = 1.0\ndiameter = 0.01\nyoungs_modulus = 2e11\ndensity = 7850.0\n'
    heavy = Oscillator(kind="oscillator", mass=1.0, stiffness=2.0, damping=0.0, gravity=9.81)
    assert "gravity = 9.81" in rewritten(text, having(structure=heavy), tmp_path)
