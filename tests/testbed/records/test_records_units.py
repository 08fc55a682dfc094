import pytest
from a_rig_and_its_records import a_rig, csv_lines, sensors

from models.errors import InputError
from testbed.records.read import read_record
from testbed.records.recording import Tag
from testbed.records.units import Measured, check_sensitivities, quantity_of, seconds, si_factor

# Factors by definition: g = 9.80665 m/s^2, lb = 0.45359237 kg, inch = 0.0254 m.
KNOWN = [
    ("acceleration", "m/s^2", 1.0),
    ("acceleration", "m/s²", 1.0),
    ("acceleration", "m/s**2", 1.0),
    ("acceleration", "m/s2", 1.0),
    ("acceleration", "m s^-2", 1.0),
    ("acceleration", "m/s/s", 1.0),
    ("acceleration", "mm/s^2", 1e-3),
    ("acceleration", "g", 9.80665),
    ("acceleration", "mg", 9.80665e-3),
    ("acceleration", "µg", 9.80665e-6),
    ("acceleration", "g_0", 9.80665),
    ("acceleration", "gn", 9.80665),
    ("acceleration", "in/s^2", 0.0254),
    ("velocity", "m/s", 1.0),
    ("velocity", "mm/s", 1e-3),
    ("velocity", "in/s", 0.0254),
    ("displacement", "m", 1.0),
    ("displacement", "mm", 1e-3),
    ("displacement", "um", 1e-6),
    ("displacement", "µm", 1e-6),
    ("displacement", "inch", 0.0254),
    ("angular_velocity", "rad/s", 1.0),
    ("angular_velocity", "deg/s", 0.017453292519943295),
    ("angular_velocity", "°/s", 0.017453292519943295),
    ("force", "N", 1.0),
    ("force", "kN", 1e3),
    ("force", "lbf", 0.45359237 * 9.80665),
]


@pytest.mark.parametrize(("quantity", "label", "factor"), KNOWN)
def test_known_labels(quantity, label, factor):
    tag = Tag("P1", unit=f" {label} ")
    assert si_factor(tag, Measured("P1", quantity, None), "a.csv", {}) == (pytest.approx(factor, rel=1e-14), None)
    assert quantity_of(tag) == quantity


@pytest.mark.parametrize(
    "label", ["bananas", "m/", "(", "m^^2", "m**9**9**9", "import os", "N" * 60, "2*m", "[x]", "'", "m/s^22", "\x7f"]
)
def test_unknown_labels_are_named_with_file_and_channel(label):
    with pytest.raises(InputError) as caught:
        si_factor(Tag("P1", unit=label), Measured("P1", "acceleration", None), "a.csv", {})
    assert f'a.csv: channel P1 has the unknown unit "{label}"' in str(caught.value)


@pytest.mark.parametrize(
    ("quantity", "label"),
    [("acceleration", "mm"), ("displacement", "g"), ("force", "kg"), ("angular_velocity", "Hz"), ("velocity", "degC")],
)
def test_a_unit_of_something_else_is_refused(quantity, label):
    with pytest.raises(
        InputError, match=rf'channel P1 is in "{label}"; the rig says P1 is an? {quantity.replace("_", " ")}'
    ):
        si_factor(Tag("P1", unit=label), Measured("P1", quantity, None), "a.csv", {})


@pytest.mark.parametrize(
    ("sensitivity", "quantity", "label", "factor"),
    [
        ("100 mV/g", "acceleration", "mV", 9.80665 / 100),
        ("100 mV/g", "acceleration", "V", 9.80665 / 0.1),
        ("10.2 mV/(m/s^2)", "acceleration", "mV", 1 / 10.2),
        ("10.2 mV/m/s^2", "acceleration", "mV", 1 / 10.2),
        ("1 V/N", "force", "V", 1.0),
        ("22.5 mV/N", "force", "V", 1 / 0.0225),
        ("8e3 counts/mm", "displacement", "counts", 1e-3 / 8e3),
        ("20 mV/(deg/s)", "angular_velocity", "mV", 0.017453292519943295 / 20),
        ("100 mV/g", "acceleration", "m/s^2", 1.0),
    ],
)
def test_sensitivities(sensitivity, quantity, label, factor):
    found, _ = si_factor(Tag("P1", unit=label), Measured("P1", quantity, sensitivity), "a.csv", {})
    assert found == pytest.approx(factor, rel=1e-12)


@pytest.mark.parametrize(
    ("sensitivity", "label", "words"),
    [
        (None, "mV", r'is in "mV" and the rig gives P1 no sensitivity.*add sensitivity = "100 mV/g"'),
        (None, "counts", r"no sensitivity.*add sensitivity"),
        ("100 mV/N", "mV", r"the sensitivity leads from the record's unit to an acceleration"),
        ("100 counts/g", "mV", r"the sensitivity leads from the record's unit"),
        ("100 mV/bananas", "mV", r'sensitivity = "100 mV/bananas".*two known units'),
        ("0 mV/g", "mV", r"a number above 0"),
        ("1.2.3 mV/g", "mV", r"a number above 0"),
    ],
)
def test_volts_that_lead_nowhere(sensitivity, label, words):
    with pytest.raises(InputError, match=words):
        si_factor(Tag("P1", unit=label), Measured("P1", "acceleration", sensitivity), "a.csv", {})


def test_a_record_in_volts_is_converted_through_each_channels_sensitivity(tmp_path):
    lines = csv_lines(units=("V", *["mV"] * 4))
    (tmp_path / "a.csv").write_text("\n".join(lines))
    excitation = {"name": "shaker", "node": 100, "position": 1.3, "sensitivity": "0.5 V/N"}
    back = read_record(tmp_path / "a.csv", a_rig(excitation=excitation, sensors=sensors(sensitivity="100 mV/g")))
    first = [float(cell) for cell in lines[1].split(",")]
    assert back.excitation[0] == pytest.approx(2 * first[1], rel=1e-12)
    assert back.responses[2, 0] == pytest.approx(9.80665 / 100 * first[4], rel=1e-12)


def test_time_has_a_unit_of_time():
    assert seconds("ms", "a.csv") == pytest.approx(1e-3)
    assert seconds(None, "a.csv") == 1
    with pytest.raises(InputError, match=r'a\.csv: time in "m"'):
        seconds("m", "a.csv")


@pytest.mark.parametrize(
    ("quantity", "sensitivity", "message"),
    [
        ("acceleration", "100 mV/N", r'P1: sensitivity = "100 mV/N"; P1 measures an acceleration, .* per g or a unit'),
        ("velocity", "100 mV/g", r"P1 measures a velocity, so its sensitivity is per m/s or a unit like it; correct"),
        ("acceleration", "100 mV/bananas", r'sensitivity = "100 mV/bananas"; .*two known units'),
    ],
)
def test_a_sensitivity_of_another_quantity_is_refused_whether_it_is_needed_or_not(quantity, sensitivity, message):
    with pytest.raises(InputError, match=message):
        check_sensitivities(a_rig(sensors=sensors(quantity=quantity, sensitivity=sensitivity)))


def test_sensitivities_of_the_right_quantity_are_fine():
    excitation = {"name": "shaker", "node": 100, "position": 1.3, "sensitivity": "2 mV/N"}
    check_sensitivities(a_rig(sensors=sensors(sensitivity="100 mV/g"), excitation=excitation))
    shaken = {"name": "base", "quantity": "base_acceleration", "sensitivity": "100 mV/g"}
    check_sensitivities(a_rig(excitation=shaken))
