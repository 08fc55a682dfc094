"""Shapes of forces whose law is known: the quantity, the course over it, and what no function explains."""

import numpy as np
import pytest

from identification.locating.courses import Course
from identification.locating.located import PlacedForce
from identification.locating.reading import Facts, reading
from identification.locating.shape import shape_of

FS, N = 2048.0, 8192
NOISE = 0.05


def motion(level=1.0, seed=1):
    """Two sines that drift through each other and a little of everything: displacement in m, velocity in m/s."""
    rng = np.random.default_rng(seed)
    freq = np.fft.rfftfreq(N, 1.0 / FS)
    size = np.exp(-(((freq - 20.0) / 6.0) ** 2)) + 0.1 * np.exp(-(((freq - 90.0) / 20.0) ** 2))
    spectrum = size * np.exp(2j * np.pi * rng.uniform(size=len(freq)))
    q = np.fft.irfft(spectrum, N)
    scale = 1e-3 * level / q.std()
    return scale * q, scale * np.fft.irfft(2j * np.pi * freq * spectrum, N)


def shape(law, levels=(0.5, 1.0)):
    forces = []
    for i, level in enumerate(levels):
        q, v = motion(level, seed=i + 1)
        clean = law(q, v, np.arange(N) / N)
        noisy = clean + NOISE * clean.std() * np.random.default_rng(i).standard_normal(N)
        told = np.ones(int(0.35 * N))
        spectrum = np.fft.rfft(noisy)
        spectrum[len(told) :] = 0.0
        forces.append(PlacedForce(f"test {i}", FS, q, v, np.fft.irfft(spectrum, N), told))
    return shape_of(forces, 0.0)


LAWS = {
    "spring": (lambda q, v, t: -1e3 * q, "displacement", "against it, odd, in proportion"),
    "hardening": (lambda q, v, t: -1e3 * q - 1e9 * q**3, "displacement", "against it, odd, growing more than"),
    "stop": (
        lambda q, v, t: -1e4 * (q - np.clip(q, -1e-3, 1e-3)),
        "displacement",
        "against it, odd, only beyond",
    ),
    "even": (lambda q, v, t: 1e6 * q**2, "displacement", "even: the same on both sides"),
    "rubbing": (lambda q, v, t: -2.0 * np.tanh(v / 1e-2), "velocity", "against it, odd, of the same size beyond"),
    "drag": (lambda q, v, t: -v * np.abs(v), "velocity", "against it, odd, growing more than"),
}


@pytest.mark.parametrize("law", LAWS)
def test_the_quantity_and_the_course_over_it(law):
    force, quantity, words = LAWS[law]

    found = shape(force, (1.0, 2.0))

    assert found.words[0].startswith(f"it follows the {quantity} (")
    assert dict(found.explained)[quantity] > 0.9
    assert words in found.words[1]


def test_a_stop_is_told_where_it_stands():
    found = shape(LAWS["stop"][0], (1.0, 2.0))

    bend = float(found.words[1].split("only beyond ")[1].split()[0])
    assert bend == pytest.approx(1.0, rel=0.1)  # mm; bends are tried in steps of 2 % of the largest value


def test_the_size_grows_with_a_power_of_the_amplitude():
    rubbing, cubic = shape(LAWS["rubbing"][0]), shape(lambda q, v, t: -1e9 * q**3)

    assert float(rubbing.words[-1].split()[-1]) == pytest.approx(0.1, abs=0.1)  # it slips a little when slow
    assert float(cubic.words[-1].split()[-1]) == pytest.approx(3.0, abs=0.3)


def test_two_quantities_side_by_side_and_their_curves():
    found = shape(lambda q, v, t: -1e3 * q - 2.0 * np.tanh(v / 1e-2))

    assert "displacement" in found.words[0]
    assert "velocity" in found.words[0]
    curve = next(curve for curve in found.curves if curve.of == "velocity")
    fast = curve.x > 0.05
    # A constant is not told of either part; the step between both directions is.
    step = curve.mean[curve.x < -0.05].mean() - curve.mean[fast].mean()
    assert step == pytest.approx(4.0, rel=0.05)
    assert np.all(curve.error > 0.0)


def test_a_resistance_that_depends_on_where_the_beam_is():
    found = shape(lambda q, v, t: -10.0 * v * (1.0 + (q / 1e-3) ** 2))

    assert any(text.startswith("displacement and velocity act together") for text in found.words)


def test_a_force_that_grows_through_the_record():
    found = shape(lambda q, v, t: -1e3 * q * (1.0 + 2.0 * t))

    grows = next(text for text in found.words if text.startswith("at the same motion it grows"))
    assert float(grows.split(", to ")[1].split()[0]) == pytest.approx(3.0, rel=0.1)


def test_memory_is_told():
    def late(q, v, t):
        return -1e3 * np.roll(q * v, 300)

    found = shape(late)

    (words,) = (text for text in found.words if "remembers what was before" in text)
    assert "none of the functions tried predicts from the motion at the same moment" in words
    assert "jointly" in words


def test_no_shape_where_no_force_is_told():
    q, v = motion()
    nothing = PlacedForce("test", FS, q, v, np.zeros(N), np.zeros(int(0.35 * N)))

    assert shape_of([nothing]) is None


def facts(**changes):
    shares = {"displacement": 0.2, "velocity": 0.3, "acceleration": 0.35}
    told = {"chosen": ("acceleration",), "together": 0.35, "surface": 0.3, "growing": 0.35, "trend": 1.0}
    return Facts(explained=shares, power=np.nan, courses={"acceleration": COURSE}, **{**told, **changes})


COURSE = Course("linear", 0.0, "odd", against=True)


def test_what_predicts_most_but_not_half_is_not_called_what_the_force_follows():
    assert reading(facts())[0] == (
        "what it follows is hardly told: most nearly the acceleration, which predicts 35% of it"
    )
    assert reading(facts(surface=0.6))[0].startswith("it follows the acceleration (35%)")


@pytest.mark.parametrize(
    ("trend", "words"),
    [
        (1.0, "is not of one size through the record, but ends as large as it began"),
        (2.5, "grows through the record, to 2.5 times its size at the beginning"),
        (0.4, "falls through the record, to 0.4 times its size at the beginning"),
    ],
)
def test_growth_is_told_by_what_it_comes_to(trend, words):
    assert f"at the same motion it {words}" in reading(facts(growing=0.9, trend=trend))
