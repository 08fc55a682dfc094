"""What the pictures show is what the effects are: closed forms of the simplest kinds of each hook."""

from dataclasses import replace

import numpy as np
import pytest

from models.effects import EFFECTS, Place
from testbed.effects_page.bench import BAND, bench_of
from testbed.effects_page.example import LARGEST, LEAST, example_of, place_for
from testbed.effects_page.inside import inside_panels
from testbed.effects_page.panels import frequency_panels, place_panel, relative_change, sensor_shown, time_panel
from testbed.effects_page.showing import showing_of
from testbed.figures.effects_page import COLUMNS, effect_figure

SLEEVE = Place(sleeve="sleeve 2", position=1.0)


@pytest.fixture(scope="module")
def bench():
    return bench_of()


def inside(bench, effect):
    answers = bench.answers_with(effect)
    return inside_panels(bench, effect, answers, sensor_shown(bench, answers))


def curve(panel, name):
    (found,) = [c for c in panel.curves if c.name == name]
    return found


def test_a_gain_is_one_factor_on_one_channel_at_all_frequencies_and_times(bench):
    effect = EFFECTS["sensor_gain"](Place(sensor="P5"), gain=1.5)
    answers = bench.answers_with(effect)
    sensor = sensor_shown(bench, answers)
    assert bench.rig.sensors[sensor].name == "P5"
    amplitude, phase = inside_panels(bench, effect, answers, sensor)
    np.testing.assert_allclose(curve(amplitude, "with").y, 1.5)
    np.testing.assert_allclose(curve(phase, "with").y, 0.0, atol=1e-9)
    place = place_panel(bench, answers, 0.83)
    for level in ("low", "high"):
        expected = [50.0 if s.name == "P5" else 0.0 for s in bench.rig.sensors]
        np.testing.assert_allclose(curve(place, level).y, expected, atol=1e-9)
    low, high = frequency_panels(bench, answers, sensor)
    for panel in (low, high):
        np.testing.assert_allclose(curve(panel, "with").y, 1.5 * curve(panel, "without").y)
        assert (panel.curves[0].x[0], panel.curves[0].x[-1]) == BAND


def test_small_motion_answers_alike_per_force_at_both_ends_of_the_low_level(bench):
    """Half the force, half the answer: at the low level the rig stays on its sleeve."""
    plant, record = bench.plant(), bench.records["low"][0]
    half = replace(record, excitation=0.5 * record.excitation)
    from models.simulate import simulate

    np.testing.assert_allclose(2.0 * simulate(plant, half).channels, record.responses, atol=1e-6)
    high = bench.traced().trace.contact_forces
    assert all(np.any(force == 0.0) and np.any(force != 0.0) for force in high)


def test_a_modulus_shifts_all_natural_frequencies_by_the_root_of_its_ratio(bench):
    shift, _ = inside(bench, EFFECTS["youngs_modulus"](Place(), ratio=1.21))
    np.testing.assert_allclose(curve(shift, "with").y, 10.0, rtol=1e-6)


def test_a_drift_is_shown_where_it_has_come_to_at_the_end(bench):
    shift, _ = inside(bench, EFFECTS["stiffness_drift"](Place(), rate=0.21 / bench.records["high"][0].duration))
    np.testing.assert_allclose(curve(shift, "with").y, 10.0, rtol=1e-6)
    assert shift.title == "free natural frequencies at the end"


def test_modal_damping_multiplies_the_ratios(bench):
    shift, damping = inside(bench, EFFECTS["modal_damping"](Place(), ratio=3.0))
    np.testing.assert_allclose(curve(shift, "with").y, 0.0, atol=1e-2)  # a ratio of 4 % moves |lambda| by rounding only
    np.testing.assert_allclose(curve(damping, "with").y, 3.0 * curve(damping, "without").y, rtol=1e-6)


def test_a_law_is_drawn_as_its_formula_says(bench):
    loop, _ = inside(bench, EFFECTS["cubic_stiffness"](SLEEVE, stiffness=1e9))
    drawn = curve(loop, "with")
    np.testing.assert_allclose(drawn.y, -1e9 * (1e-3 * drawn.x) ** 3, rtol=1e-9, atol=1e-12)
    _, over_speed = inside(bench, EFFECTS["coulomb_friction"](SLEEVE, 1.0, 5e-3))
    drawn = curve(over_speed, "with")
    np.testing.assert_allclose(drawn.y, -np.tanh(1e-3 * drawn.x / 5e-3), rtol=1e-9, atol=1e-12)


def test_a_sleeve_shows_where_its_force_begins(bench):
    """Below, the beam is pushed up once it is lower than the clearance."""
    loop, over_time = inside(bench, EFFECTS["clearance"](SLEEVE, clearance=4e-4))
    for name, clearance in (("with", 0.4), ("without", 0.15)):
        drawn = curve(loop, name)
        assert np.all(np.abs(drawn.x[drawn.y > 0.0]) > clearance)
    assert curve(over_time, "with").y.max() == pytest.approx(np.abs(bench_peak(bench, 4e-4)), rel=1e-9)


def bench_peak(bench, clearance):
    return np.abs(bench.traced(EFFECTS["clearance"](SLEEVE, clearance=clearance)).trace.contact_forces[1]).max()


def test_what_changes_through_time_is_drawn_early_and_late(bench):
    effect = EFFECTS["time_varying_damping"](SLEEVE, (0.0, 8.0), (20.0, 200.0))
    loop, _ = inside(bench, effect)
    assert [c.name for c in loop.curves] == ["without", "early", "late"]


def test_the_change_over_time_is_none_before_an_effect_begins(bench):
    effect = EFFECTS["time_varying_damping"](SLEEVE, (0.0, 4.0, 8.0), (80.0, 80.0, 800.0))
    panel = time_panel(bench, bench.answers_with(effect))
    for level in ("low", "high"):
        drawn = curve(panel, level)
        assert drawn.y[drawn.x < 3.5].max() < 1e-3
        assert drawn.y[drawn.x > 6.0].min() > 1.0


def test_a_kind_is_shown_where_it_acts(bench):
    """The outer sleeve moves most; the sensor stands in the middle of the list."""
    assert place_for(EFFECTS["squeeze_film"], bench) == SLEEVE
    assert place_for(EFFECTS["point_mass"], bench) == Place(position=0.88)
    assert place_for(EFFECTS["sensor_gain"], bench) == Place(sensor="P5")
    assert place_for(EFFECTS["force_gain"], bench) == Place()


def test_what_cannot_sit_on_a_beam_is_shown_on_an_oscillator():
    bench = bench_of("oscillator")
    effect = EFFECTS["cubic_stiffness"](Place(), stiffness=1e12)
    loop, _ = inside(bench, effect)
    drawn = curve(loop, "with")
    np.testing.assert_allclose(drawn.y, -1e12 * (1e-3 * drawn.x) ** 3, rtol=1e-9, atol=1e-12)
    low, _ = frequency_panels(bench, bench.answers, 0)
    peak = curve(low, "without")
    assert peak.x[np.argmax(peak.y)] == pytest.approx(30.0, abs=0.5)  # the lines are 0.25 Hz apart


def test_an_example_is_a_trial_scaled_until_it_shows(bench):
    kind = EFFECTS["point_mass"]
    shown = example_of(kind, bench)
    trials = [trial.mass for trial in kind.trials(bench.scene(shown.place))]
    assert LEAST * min(trials) <= shown.mass <= LARGEST * max(trials)
    change = relative_change(bench.answers["low"], bench.answers_with(shown)["low"])
    assert change.max() > 0.2
    assert float(f"{shown.mass:.3g}") == shown.mass


def test_a_figure_has_three_panels_in_a_row_that_nothing_overlaps(bench):
    shown = showing_of(EFFECTS["point_stiffness"], bench)
    figure = effect_figure(shown)
    assert len(figure.axes) == len(shown.panels) == 2 * COLUMNS
    assert shown.title.startswith("point_stiffness at 0.880 m: ")


def test_a_table_over_time_is_shown_with_ends_that_differ(bench):
    shown = example_of(EFFECTS["time_varying_damping"], bench)
    assert max(shown.values[0], shown.values[-1]) > 3.0 * min(shown.values[0], shown.values[-1])
