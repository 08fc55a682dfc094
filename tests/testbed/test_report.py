"""The report: one whole page for every verdict, with nothing from outside and nothing unescaped."""

import hashlib
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from made_up_diagnosis import FRICTION, made_up_diagnosis, made_up_record, made_up_score

from identification.at_rest import PairedModes
from identification.locating.located import Shape
from identification.next_experiment.proposal import Proposal
from identification.result import Candidate, Estimate, FrfScore, ModesScore, Score
from models.record import FrfRecord, ModeShapeRecord
from models.rig import Excitation, Oscillator, Rig, Sensor
from models.rig_file import read_rig
from testbed.report import Provenance, provenance, write_report
from testbed.report.budget_rows import budget_table
from testbed.report.figures import shown_records
from testbed.report.place_figure import panels_of
from testbed.report.rows import rig_pulls
from testbed.report.words import chance, headline, number, percent, with_std

SECTIONS = (
    "models", "parameters", "candidates", "where", "force", "records", "budget", "decisions", "next", "provenance",
)  # fmt: skip
VOID = {"meta", "img", "br", "link", "hr", "input"}
MADE = Provenance(
    "testbed diagnose rig.toml sweep.csv",
    "2025-01-01T00:00:00+00:00",
    7,
    (("numpy", "2.0"),),
    (("rig.toml", "ab" * 32),),
)


@pytest.fixture(scope="module")
def whole_rig():
    return read_rig("tests/data/reference_rig.toml")


@pytest.fixture(scope="module")
def rig(whole_rig):
    """With three of its sensors, since drawing takes the time."""
    return whole_rig.model_copy(update={"sensors": whole_rig.sensors[:3]})


@pytest.fixture
def oscillator():
    return Rig(
        structure=Oscillator(kind="oscillator", mass=3.08, stiffness=1191.0, damping=0.67),
        excitation=Excitation(quantity="base_acceleration"),
        sensors=(Sensor(name="mass", quantity="acceleration"),),
        tolerances={"stiffness": 0.02},
    )


class Page(HTMLParser):
    """What a browser would see: text, ids, links and sources, and whether every tag is closed where it should be."""

    def __init__(self, html):
        super().__init__()
        self.open, self.ids, self.links, self.texts, self.tags = [], [], [], [], []
        self.feed(html)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.ids += [value for key, value in attrs if key == "id"]
        self.links += [value for key, value in attrs if key in ("src", "href", "action", "data", "srcset")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] != "style":
            self.texts.append(data.strip())

    @property
    def text(self):
        return " ".join(text for text in self.texts if text)


def page_of(diagnosis, rig, folder):
    path = write_report(diagnosis, rig, folder, MADE)
    assert path == folder / "report.html"
    return Page(path.read_text(encoding="utf-8"))


@pytest.fixture
def diagnosis(rig):
    return made_up_diagnosis(rig)


def complete(diagnosis):
    return replace(
        diagnosis, verdict="complete", added=(), candidates=(), indistinguishable=(), stages=diagnosis.stages[:2]
    )


def unexplained(diagnosis):
    return replace(diagnosis, verdict="unexplained", added=(), stages=diagnosis.stages[:2])


@pytest.mark.parametrize(
    "case", [lambda d: d, complete, unexplained], ids=["missing_effect", "complete", "unexplained"]
)
@pytest.mark.parametrize("aside", [True, False], ids=["with hold-out", "without"])
def test_every_verdict_makes_a_whole_page_with_nothing_from_outside(rig, diagnosis, tmp_path, case, aside):
    found = case(diagnosis if aside else replace(diagnosis, holdout={}))

    page = page_of(found, rig, tmp_path)

    assert set(SECTIONS) <= set(page.ids)
    assert all(link.startswith(("data:image/", "#")) for link in page.links)
    assert {link[1:] for link in page.links if link.startswith("#")} == set(SECTIONS)
    assert not {"script", "link", "iframe", "object"} & set(page.tags)
    html = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert not re.search(r"(url\(|@import|https?://)", html)
    for stage in found.stages:
        assert stage.label in page.text
        assert percent(stage.score.nrmse) in page.text
    assert ("kept aside" in page.text) == aside or "No record was kept aside" in page.text


def repeating_record(rig, n_periods=6, period=512):
    """An odd multisine, answered in proportion, with an even distortion of 1 % and a noise of 0.1 %."""
    rng = np.random.default_rng(4)
    lines = np.arange(3, 120, 2)
    phases = rng.uniform(0.0, 2.0 * np.pi, len(lines))
    force = np.cos(2.0 * np.pi * np.outer(np.arange(period) / period, lines) + phases).sum(axis=1)
    force = np.tile(force / force.std(), n_periods)
    even = force**2 - 1.0
    answer = force + 0.01 * even / even.std()
    record = made_up_record(rig, n_samples=len(force))
    responses = np.tile(answer, (len(rig.sensors), 1)) + 1e-3 * rng.standard_normal((len(rig.sensors), len(force)))
    return replace(record, excitation=force, responses=responses)


def test_the_budget_says_what_a_model_could_still_gain(rig):
    table = budget_table(made_up_diagnosis(rig, repeating_record(rig)), rig)

    (row,) = table.rows
    shares = dict(zip(table.causes, row["causes"], strict=True))
    assert _percent(shares["even"]) == pytest.approx(1.0, rel=0.05)
    assert shares["odd"] == "not above chance"
    calibrated, final = row["models"]
    assert _percent(calibrated["possible"]) == pytest.approx(24.0, rel=0.02)
    assert _percent(calibrated["nonlinear"]) == pytest.approx(0.24, rel=0.1)
    assert _percent(final["possible"]) == pytest.approx(0.71, rel=0.02)
    assert any("even distortion" in text for text in table.findings)


def _percent(text):
    value, unit = text.split()
    assert unit == "%"
    return float(value)


def test_records_that_do_not_repeat_have_a_budget_in_words_only(rig, diagnosis):
    table = budget_table(diagnosis, rig)

    assert table.rows == ()
    assert "sweep.csv" in " ".join(table.findings)


def test_the_verdict_names_the_effect_and_its_figures(rig, diagnosis, tmp_path):
    page = page_of(diagnosis, rig, tmp_path)

    assert "lacks one effect, squeeze_film at sleeve 2" in page.text
    assert "falls from 30 % to 0.71 %" in page.text
    for part in ("damping = 18.50 ± 0.40 N s/m", "97 %", "coulomb_friction", FRICTION.in_words(), "P4: dead"):
        assert part in page.text
    assert "point_mass at 0.950 m, point_mass at 1.150 m" in page.text


def test_a_group_says_what_its_list_leaves_out(rig, diagnosis, tmp_path):
    words = "This list is without both"
    assert words in page_of(diagnosis, rig, tmp_path).text
    assert words not in page_of(replace(diagnosis, indistinguishable=()), rig, tmp_path).text


def test_tables_scroll_by_themselves_on_a_narrow_screen(rig, diagnosis, tmp_path):
    path = write_report(diagnosis, rig, tmp_path, MADE)
    narrow = path.read_text().partition("@media (max-width: 48rem)")[2].partition("@media print")[0]
    assert "table { display: block; overflow-x: auto; }" in narrow


def test_an_unexplained_rig_says_where_the_force_acts(rig, diagnosis, tmp_path):
    page = page_of(unexplained(diagnosis), rig, tmp_path)

    assert "no effect of the library is sure to be it" in page.text
    assert "The unexplained force is largest at sleeve 2" in page.text


def test_names_and_findings_are_escaped_and_dollars_are_no_formulas(rig, tmp_path):
    record = made_up_record(rig, name='<i>"a$b$c"&.csv')
    found = replace(made_up_diagnosis(rig, record), findings=("<script>alert(1)</script>",), decisions=("1 < 2 & 3",))

    page = page_of(found, rig, tmp_path)

    assert '<i>"a$b$c"&.csv' in page.text
    assert "<script>alert(1)</script>" in page.text
    assert "1 < 2 & 3" in page.text
    assert "script" not in page.tags
    assert "<i>" not in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_an_oscillator_with_one_sensor_and_one_record(oscillator, tmp_path):
    found = made_up_diagnosis(oscillator)
    force = replace(found.missing_forces[0], place="mass")
    found = replace(
        found, missing_forces=(force,), rig_estimates=(Estimate("stiffness", 1200.0, 5.0, "N/m"),), holdout={}
    )

    page = page_of(unexplained(found), oscillator, tmp_path)

    assert "at the mass" in page.text
    assert "1200.0 ± 5.0 N/m" in page.text
    assert "+0.38 ± 0.21" in page.text


def test_the_next_experiment_stands_with_its_options(rig, tmp_path):
    page = page_of(made_up_diagnosis(rig), rig, tmp_path)

    assert "to tell them apart" in page.text
    assert "expected probability" in page.text
    assert all(words in page.text for words in ("a sweep of 2 N", "0.980", "a sweep of 1 N", "0.700", "1.07"))
    assert "next_experiment.toml" in page.text


def test_a_free_decay_has_no_frf_and_a_rig_without_tolerances_no_parameters(rig, tmp_path):
    certain = rig.model_copy(update={"tolerances": {}})
    record = replace(made_up_record(rig), excitation=None, moving_start=True)
    found = replace(made_up_diagnosis(certain, record), rig_estimates=(), missing_forces=(), where=(), updated_maps=())

    page = page_of(replace(found, next_experiment=Proposal("a time record", "to see more")), certain, tmp_path)

    assert "No record has a measured excitation" in page.text
    assert "No number of the rig was calibrated" in page.text
    assert "free decay" in page.text
    assert "estimated" in page.text
    assert "a time record" in page.text
    assert "No file of it" in page.text


def test_many_records_make_a_page_of_a_few_megabytes_that_says_what_it_leaves_out(whole_rig, tmp_path):
    records = [
        replace(r, excitation=r.excitation * (k + 1))
        for k, r in enumerate(made_up_record(whole_rig, name=f"run {k}.csv") for k in range(6))
    ]
    diagnosis = made_up_diagnosis(whole_rig, records[0])
    stages = tuple(
        replace(stage, score=Score(tuple(made_up_score(r, stage.score.nrmse).records[0] for r in records)))
        for stage in diagnosis.stages
    )
    maps = tuple(replace(diagnosis.where[0], record=r.name) for r in records)
    candidates = tuple(Candidate(FRICTION, 1e-5, 0.2, -50.0, refitted=False) for _ in range(40))
    many = replace(diagnosis, stages=stages, where=maps, updated_maps=maps, candidates=candidates)

    page = page_of(many, whole_rig, tmp_path)

    assert (tmp_path / "report.html").stat().st_size < 5e6
    assert shown_records(many) == ("run 5.csv", "run 3.csv", "run 2.csv", "run 0.csv")
    assert "Not shown: run 1.csv, run 4.csv." in page.text
    assert "28 less probable candidates" in page.text


def test_what_is_kept_for_what_was_not_judged_is_said_beside_the_probabilities(rig, diagnosis, tmp_path):
    page = page_of(diagnosis, rig, tmp_path)
    assert "5.0 % where the noise is reached, 20 % where more is left, 50 % where" in page.text.replace("\xa0", " ")


def test_modes_and_frfs_stand_beside_those_of_both_models(rig, tmp_path):
    names, found = tuple(sensor.name for sensor in rig.sensors), made_up_diagnosis(rig)
    shapes = np.ones((2, len(names)), complex)
    modes = ModeShapeRecord("m.uff", names, np.array([12.5, 70.0]), None, shapes)
    lines = np.arange(1.0, 40.0)
    frfs = FrfRecord("h.uff", lines, names, np.ones((len(names), len(lines)), complex))

    def at_rest(freq, error):
        nothing, each = np.full(2, np.nan), np.full(len(names), error)
        paired = PairedModes(np.array([freq, np.nan]), nothing, shapes, np.array([0.987, np.nan]))
        return (
            FrfScore(frfs, (1.0 + error) * frfs.values, "told", error, 0.01, each, each),
            ModesScore(modes, paired, "assumed", error, 0.05),
        )

    scores = (at_rest(12.0, 0.31), at_rest(12.3, 0.2), at_rest(12.4, 0.017))
    stages = [replace(stage, score=Score((), rest)) for stage, rest in zip(found.stages, scores, strict=True)]

    page = page_of(replace(found, stages=tuple(stages), holdout={}, where=(), updated_maps=()), rig, tmp_path)

    for part in ("12 Hz, MAC 0.987", "12.4 Hz, MAC 0.987", "none", "2 modes", "39 lines, 1 to 39 Hz", "1.7 %", "told"):
        assert part in page.text
    assert "small motion about rest" in page.text
    assert "FRF magnitude." in page.text


def test_provenance_holds_versions_hashes_seed_and_date(tmp_path):
    (tmp_path / "rig.toml").write_bytes(b"rig")
    (tmp_path / "a.csv").write_bytes(b"record")

    found = provenance(tmp_path / "rig.toml", [tmp_path / "a.csv"], 3, "testbed diagnose")

    assert found.files == (
        ("rig.toml", hashlib.sha256(b"rig").hexdigest()),
        ("a.csv", hashlib.sha256(b"record").hexdigest()),
    )
    assert [name for name, _ in found.versions] == ["clearance-testbed", "Python", "numpy", "scipy", "numba"]
    assert (found.seed, found.command) == (3, "testbed diagnose")
    assert re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\+00:00", found.date)


def test_the_page_shows_its_provenance_and_its_defaults(rig, diagnosis, tmp_path):
    page = page_of(diagnosis, rig, tmp_path)

    for part in (MADE.command, MADE.date, "ab" * 32, "numpy 2.0", "0.35 fs", "sleeves.clearance 3.0 %", "assumed"):
        assert part in page.text


def test_calibrated_numbers_are_told_in_tolerances(rig):
    found = rig_pulls(
        (Estimate("sleeves[0].clearance", 1.5e-4 * np.exp(0.03), 0.9e-6, "m"), Estimate("unknown", 1.0, 1.0, "")), rig
    )

    assert found.labels == ["clearance of sleeve 1"]
    np.testing.assert_allclose(found.pulls, [1.0])  # 3 % of 0.15 mm
    np.testing.assert_allclose(found.stds, [0.2 / np.exp(0.03)])


@pytest.mark.parametrize(
    ("estimate", "text"),
    [
        (Estimate("c", 18.46, 0.41, "N s/m"), "18.46 ± 0.41 N s/m"),
        (Estimate("E", 2.114e11, 6.3e8, "Pa"), "(2.1140 ± 0.0063)e11 Pa"),
        (Estimate("d", 1.537e-4, 1.3e-6, "m"), "(1.537 ± 0.013)e-4 m"),
        (Estimate("n", 2.0, 0.0, "-"), "2"),
        (Estimate("c", (1.0, 2.0), (0.1, 0.2), "N s/m"), "(1.00 ± 0.10, 2.00 ± 0.20) N s/m"),
        (Estimate("x", 0.0, 0.1, ""), "0.00 ± 0.10"),
        (Estimate("x", 5.0, np.inf, ""), "5"),
    ],
)
def test_an_estimate_has_two_digits_of_its_deviation(estimate, text):
    assert with_std(estimate) == text


@pytest.mark.parametrize(
    ("given", "text"),
    [
        (percent(0.2403), "24 %"), (percent(0.05), "5.0 %"), (percent(0.0071), "0.71 %"), (percent(0.0997), "10 %"),
        (percent(1.21), "121 %"), (percent(0.0), "0.0 %"), (chance(0.9999), "> 99.9 %"), (chance(1e-9), "< 0.01 %"),
        (chance(0.97), "97 %"), (number(2.1e11), "2.1e11"), (number(1e-4), "0.0001"), (number(1e5), "1e5"),
    ],
)  # fmt: skip
def test_numbers_read_as_an_engineer_writes_them(given, text):
    assert given == text


@pytest.mark.parametrize(
    ("nrmse", "more"), [(0.0071, ""), (0.014, "; what is left, 2 times the noise, is not explained")]
)
def test_the_headline_says_what_stays_unexplained(whole_rig, nrmse, more):
    diagnosis = made_up_diagnosis(whole_rig)
    last = diagnosis.stages[-1]
    score = made_up_score(last.score.records[0].record, nrmse)  # of a noise of 0.7 %
    told = headline(replace(diagnosis, stages=(*diagnosis.stages[:-1], replace(last, score=score))))

    assert told.endswith(f"the noise alone leaves 0.70 %{more}.")


def test_a_force_that_follows_the_acceleration_has_a_panel_for_it():
    shares = {"displacement": 0.1, "velocity": 0.2}
    still = Shape((*shares.items(), ("acceleration", 0.15)), (), (), (), 0.0)
    inert = Shape((*shares.items(), ("acceleration", 0.9)), (), (), (), 0.0)

    assert [name for name, _, _ in panels_of(still)] == ["displacement", "velocity", "time", "amplitude"]
    assert [name for name, _, _ in panels_of(inert)] == [
        "displacement",
        "velocity",
        "acceleration",
        "time",
        "amplitude",
    ]
