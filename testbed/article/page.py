"""``article.json`` and the page beside it."""

from collections.abc import Iterator
from dataclasses import asdict

from models.effects import entry_of
from models.rig import EffectEntry
from testbed.article.bars import bars_of
from testbed.article.compared import rows_of
from testbed.article.judging import FOURTH
from testbed.article.rig import CALIBRATED_AT, CLAMP_GROUP, DENSITY, DIAMETER, SLEEVES_AT, YOUNGS_MODULUS
from testbed.article.strikes import EXCITED, LEVELS
from testbed.article.study import ArticleStudy
from testbed.article.tables import (
    bars_table,
    fourth_order,
    frequency_summary,
    frequency_tables,
    response_summary,
    response_tables,
)
from testbed.article.truth import NOISE, SEED, truth_of
from testbed.article.uncertain_tables import (
    condition_table,
    difference_table,
    emulator_words,
    posterior_table,
    slew_table,
    without_uncertainty,
)
from testbed.outputs import Json

MILLI = 1e3

WHAT = """\
The article (Actuators 14 (2025) 58) measured a cantilever that rests in two sleeves at six clearances. Its data are not
public, so its study is built again as a virtual experiment, here at {clearances} of its clearances: {engines} stand for
the test bench, the reduced modal model is the model. Tables and figures of the article have their counterparts here,
the article's values beside ours. They are not the same rig and not the same grease, so sizes cannot be compared; how
far each model gets can.
"""

WHY = """\
As long as both sleeves carry the rod, its natural frequencies do not depend on the clearance: the contact is a linear
spring, and a gap on the far side is not felt by small motion. From 1 mm on the rod sags less than the first sleeve lets
it and lies in the second alone: all frequencies fall, the second most. The article says in words that frequencies fall
with clearance, while its tables let the third and fourth rise. A wider gap alone does that in neither state; what the
article changed between its tests are contact rings, whose own stiffness need not have stayed the same.
"""

STRUCK = f"""\
Random-phase multisines from {EXCITED[0]:g} to {EXCITED[1]:g} Hz, of {LEVELS["table"]:g} m/s^2 rms of the table or
{LEVELS["force"]:g} N rms of the shaker, by the modal model. A sleeve that carries the rod is struck when the rod comes
back to it.
"""

SINES = """\
All periodic motions of the modal model under the shaker's sine, by harmonic balance with continuation; dotted ones are
unstable, and dashed is where a phase-locked test would settle. While the rod stays on its walls the resonance keeps
its place. From the level at which a wall is left it bends to lower frequencies, and back once both sleeves are struck
in every period; the wider the clearance, the further. Circles are motions stepped from rest to steady state by three
engines, chosen as the most distorted ones that a curve has alone at their frequency.
"""

COMPARED = """\
First harmonics at all eight points: harmonic balance against the modal model begun on the curve, and against each
engine begun at rest. Where it stays on the curve and all engines come to the same other motion, that one attracts
the rod from rest beside the curve's.\
"""

SIMILARITY = """\
An arm and this rig have the same motion in units of their own length and of `sqrt(rho A L^4 / (E I))` if these numbers
are the same: contact stiffness `k L^3 / (E I)`, rotational stiffness of the clamp `k L / (E I)`, mass of the tip over
that of the beam, damping ratios, places as shares of the length; and, since a gap makes the motion depend on its size,
the clearance over the sag `rho A g L^4 / (8 E I)` of the beam alone and the exciting force over its weight. An arm in
orbit has no sag: there the clearance over the amplitude of the motion takes its place.
"""


TRUTH = f"""\
On the bench stands another rig than its owner describes: rod and contacts are off within their tolerances, and the
sleeves hold grease, which he does not mention: a squeeze film in both, a contact damping that falls as the grease
runs off, and friction in the second. All of it was drawn with seed {SEED} before any model ran. Sensors add
{NOISE.response:.1%} of noise. Each clearance has two tests of two records: soft taps after which closed sleeves stay
closed, and the multisine above. The shaker's force is what models are updated and diagnosed with; the table's motion
judges them and teaches nothing.
"""

MODELS_ARE = """\
- **initial**: the rig as its owner describes it, Kelvin-Voigt contacts with constant damping.
- **updated**: Young's modulus and contact stiffnesses from the frequencies, and c(t) of each closed sleeve from the
  damping ratios that the identifier reads after every soft tap.
- **diagnosed**: what the loop adds by itself to the initial model, told that sleeves may be alike and {told}. It looks
  at 0.5 mm; what it finds there is fitted anew to the force test of every other clearance.
"""

SEEN_ALIKE = """\
Measured and computed signals go through the same estimators: modes by fitting decays between taps, FRFs by H1 over the
periods of the multisine, up to 200 Hz. CSAC and CSF per point are over a sliding band; in the figures they are over all
eight points at each frequency. RMSE is of the complex difference, in (m/s^2)/(m/s^2); the article's unit is not told.
"""

FOURTH_ORDER = f"""\
The article leaves open how much of its fourth order's error is identification's. Here the updated model is made again
by an identifier without error: true stiffnesses and the dampings that small motion really has, on the rig as given;
then with all other numbers of the rig true as well; and the perfect model has all that is hidden. Errors are
relative, of the FRF between {FOURTH[0]:g} and {FOURTH[1]:g} Hz, mean of the points.
"""

PROBABLE = """\
Natural frequencies at 0.5 mm. In each condition both sleeves' stiffness, damping or clearance are normal about the
updated model's numbers. A clearance moves no frequency as long as both sleeves carry the rod; where a wide one lets the
first sleeve go, all jump, which is why its distribution has a tail.
"""

BEYOND = """\
The assumed distributions are the article's kind: normals, whatever the tests say. The posterior is what the taps leave
of the owner's tolerances: stiffness, modulus and a factor on each identified course of damping, together with the
model's own error, which is not told beforehand. Each tap of the table test is then held against the model at that tap's
own time.
"""

SLEWS = """\
The base moves the tip by 60 mm within a quarter of a second. Without a model the base does what the tip should; with
one, it does what makes the model's tip follow. The rig itself never takes part, so the tip's error is the model's.
"""


def article_json(study: ArticleStudy) -> Json:
    """The content of ``article.json``.

    Args:
        study: finished.
    """
    geometry, rows = study.geometry, [rows_of(found) for found in study.compared]
    return {
        "geometry": {**asdict(geometry), "rate": geometry.rate, "sag": geometry.sag},
        "at_rest": [{**vars(rest), "errors": rest.errors} for rest in study.rests],
        "tests": [vars(test) for test in study.tests],
        "sines": study.sines,
        "clearances": rows,
        "models": {
            f"{clearance:g}": {
                "identified": three.identified,
                "found": [entry.model_dump(exclude_none=True) for entry in three.found],
                "diagnosis": three.diagnosis,
            }
            for clearance, three in study.models.items()
        },
        "bars": {engine: [vars(bar) for bar in bars_of(rows, engine)] for engine in study.extent.judges},
        "probability": study.probability,
        "slews": [_errors_alone(row) for row in study.slews],
    }


def _errors_alone(row: Json) -> Json:
    """A slew without its courses."""
    return {
        "clearance": row["clearance"],
        "courses": {
            name: {
                engine: {key: one[key] for key in ("rms", "largest", "after")}
                for engine, one in course["engines"].items()
            }
            for name, course in row["courses"].items()
        },
    }


def page_of(study: ArticleStudy, content: Json, command: str) -> str:
    """The page, in Markdown.

    Args:
        study: finished.
        content: of ``article.json``.
        command: that makes it again.
    """
    rows, printed = content["clearances"], study.printed
    names = [f"{1e3 * clearance:g}-mm" for clearance in study.extent.clearances]
    points = [sensor.name for sensor in study.geometry.rig(CALIBRATED_AT, "table").sensors]
    lines = [
        "# The article's case study",
        "",
        f"Made by `{command}`.",
        "",
        WHAT.format(engines=" and ".join(study.extent.judges), clearances=len(study.extent.clearances)),
        "## The rig",
        "",
        *_geometry(study),
        "",
        SIMILARITY,
        "## What the clearance does at rest",
        "",
        "![Natural frequencies against clearance](figures/frequencies.png)",
        "",
        *_rests(study),
        "",
        WHY,
        "## Both sleeves are struck",
        "",
        STRUCK,
        *_tests(study),
        "",
        "## Under sines",
        "",
        SINES,
        "![Tip under sines at three levels](figures/sines.png)",
        "",
        *_sines(study),
        "",
        *_speed(study),
        "",
        "## The virtual test bench",
        "",
        TRUTH,
        "## Three models",
        "",
        MODELS_ARE.format(told="nothing else" if study.extent.most_effects else "to calibrate alone"),
        "![Identified damping of the sleeves](figures/damping.png)",
        "",
        *_found(study),
        "",
        "### What was asked for and what was reached",
        "",
        *bars_table(rows),
        "",
        "### Natural frequencies and mode shapes (tables 2 and A1 to A6)",
        "",
        SEEN_ALIKE,
        *frequency_tables(rows, printed),
        "### Their errors over all clearances (table 3), initial -> updated -> diagnosed",
        "",
        *frequency_summary(rows, printed),
        "",
        "### FRFs (figures 8, 10, A1 to A6, A19)",
        "",
        *(line for name in names for line in (f"![FRFs at {name}](figures/frf_{name}.png)", "")),
        "![The tests at all clearances](figures/clearances.png)",
        "",
        "![The tests at the other points](figures/clearances_others.png)",
        "",
        "### Errors of the FRF at eight points (tables 4 and A7 to A12)",
        "",
        *response_tables(rows, printed, points),
        "### Their change over all clearances (table 5), initial -> updated, initial -> diagnosed",
        "",
        *response_summary(rows, printed),
        "",
        "### Correlation over frequency (figures 9 and A7 to A18)",
        "",
        *(
            line
            for name in names
            for what in ("csf", "csac")
            for line in (f"![{what.upper()} at {name}](figures/{what}_{name}.png)", "")
        ),
        "### The fourth order: identification's share and the model's",
        "",
        FOURTH_ORDER,
        *fourth_order(rows),
        "",
        "## Probability",
        "",
        PROBABLE,
        *condition_table(study.probability),
        "",
        BEYOND,
        *posterior_table(study.probability),
        "",
        "![Coincidence](figures/coincidence.png)",
        "",
        *difference_table(study.probability),
        "",
        *without_uncertainty(study.probability),
        "",
        "![Shares of the variance](figures/shares.png)",
        "",
        *emulator_words(study.probability),
        "",
        "![Emulator against simulation](figures/emulator.png)",
        "",
        "## Feed-forward control",
        "",
        SLEWS,
        *slew_table(content["slews"]),
        "",
        *(f"![Slews by {engine}](figures/slews_{engine}.png)" for engine in study.extent.judges),
        "",
    ]
    return "\n".join(lines)


def _found(study: ArticleStudy) -> Iterator[str]:
    """What the loop said, and what it found at each clearance."""
    told = next(three.diagnosis for three in study.models.values() if three.diagnosis is not None)
    yield f"The loop's verdict at {MILLI * CALIBRATED_AT:g} mm: `{told['verdict']}`. What it found and what is hidden:"
    yield ""
    yield "| clearance [mm] | effect | found | hidden |"
    yield "|---|---|---|---|"
    for clearance, three in study.models.items():
        hidden = {
            (entry.kind, str(entry.sleeve)): entry
            for entry in map(entry_of, truth_of(study.geometry, clearance, "force", "modal").hidden)
        }
        found = {(entry.kind, entry.sleeve or f"{entry.position or 0.0:.3f} m"): entry for entry in three.found}
        for kind, place in dict.fromkeys([*found, *hidden]):
            numbers = (_numbers(entries.get((kind, place))) for entries in (found, hidden))
            yield f"| {MILLI * clearance:g} | `{kind}`, {place} | {' | '.join(numbers)} |"


def _numbers(entry: EffectEntry | None) -> str:
    if entry is None:
        return "-"
    settings = {key: value for key, value in entry.settings.items() if isinstance(value, int | float | tuple)}
    return ", ".join(
        f"{key} {' '.join(f'{v:.3g}' for v in value) if isinstance(value, tuple) else f'{value:.3g}'}"
        for key, value in settings.items()
    )


def _geometry(study: ArticleStudy) -> Iterator[str]:
    geometry = study.geometry
    first, second = geometry.contact_groups
    yield "| | | |"
    yield "|---|---|---|"
    yield f"| section, material | assumed | {1e3 * DIAMETER:g} mm, {YOUNGS_MODULUS / 1e9:g} GPa, {DENSITY:g} kg/m^3 |"
    yield f"| sleeves, as shares of the length | assumed | {SLEEVES_AT[0]:g} and {SLEEVES_AT[1]:g} |"
    yield f"| clamp, k L / (E I) | assumed | {CLAMP_GROUP:g} |"
    yield f"| length | calibrated | {geometry.length:.4f} m, E I / (rho A L^4) = {geometry.rate:.2f} 1/s^2 |"
    yield f"| contacts, k L^3 / (E I) | calibrated | {first:.2f} and {second:.2f} |"
    yield f"| tip mass over the rod's | calibrated | {geometry.tip_share:.4f} |"
    yield f"| sag of the beam alone | follows | {MILLI * geometry.sag:.2f} mm |"


def _rests(study: ArticleStudy) -> Iterator[str]:
    yield f"Calibrated at {MILLI * CALIBRATED_AT:g} mm; in brackets the difference to what the article measured."
    yield ""
    yield "| clearance [mm] | f1 [Hz] | f2 | f3 | f4 | depth in sleeve 1 [mm] | in sleeve 2 |"
    yield "|---|---|---|---|---|---|---|"
    for rest in study.rests:
        freqs = " | ".join(
            f"{f:.2f} ({100.0 * error:+.2f} %)" for f, error in zip(rest.natural_freqs, rest.errors, strict=True)
        )
        depths = " | ".join(f"{MILLI * depth:+.3f}" for depth in rest.penetrations)
        yield f"| {MILLI * rest.clearance:g} | {freqs} | {depths} |"


def _tests(study: ArticleStudy) -> Iterator[str]:
    yield "| clearance [mm] | test | strikes per second, sleeve 1 | sleeve 2 | time closed | | largest force [N] | |"
    yield "|---|---|---|---|---|---|---|---|"
    for test in study.tests:
        cells = [
            *(f"{rate:.1f}" for rate in test.per_second),
            *(f"{share:.0%}" for share in test.closed_share),
            *(f"{force:.0f}" for force in test.largest_force),
        ]
        yield f"| {MILLI * test.clearance:g} | {test.drive} | {' | '.join(cells)} |"


def _sines(study: ArticleStudy) -> Iterator[str]:
    yield COMPARED
    yield ""
    heads = "clearance [mm] | force [N] | largest [m/s^2] | at [Hz] | unstable | compared at [Hz] | distortion"
    engines = _engines(study)
    yield f"| {heads} | begun on it | {' | '.join(engines.values())} |"
    yield "|---" * (8 + len(engines)) + "|"
    for row in study.sines:
        for level in row["levels"]:
            curve, check = level["curves"][0], level["check"]
            top = max(range(len(curve["peak"])), key=curve["peak"].__getitem__)
            unstable = 1.0 - sum(curve["stable"]) / len(curve["stable"])
            cells = [f"{MILLI * row['clearance']:g}", f"{level['amplitude']:g}", f"{curve['peak'][top]:.3g}"]
            cells += [f"{curve['frequency'][top]:.3f}", f"{unstable:.0%}"]
            if check is None:
                cells += ["none is alone and settles within half a minute", *[""] * (2 + len(engines))]
            else:
                errors = (check["errors"][engine] for engine in engines)
                cells += [
                    f"{check['freq']:.3f}",
                    f"{check['distortion']:.0%}",
                    f"{check['stays']:.2%}",
                    *(f"{error:.2%}" for error in errors),
                ]
            yield f"| {' | '.join(cells)} |"


def _speed(study: ArticleStudy) -> Iterator[str]:
    levels = [level for row in study.sines for level in row["levels"]]
    points = sum(len(curve["frequency"]) for level in levels for curve in level["curves"])
    each = sum(level["seconds"] for level in levels) / points
    checks = [level["check"] for level in levels if level["check"] is not None]
    if not checks:
        return
    times = [
        f"{sum(check['seconds'][engine] for check in checks) / len(checks) / each:.0f} times as long by {name}"
        for engine, name in _engines(study).items()
    ]
    yield (
        f"A point of a curve with its stability takes {1e3 * each:.1f} ms of processor; stepping {_mean(checks):.1f} s "
        f"of motion to a steady state takes {', '.join(times)}, and shows no unstable motion."
    )


def _engines(study: ArticleStudy) -> dict[str, str]:
    """Those that stepped the sines, by what they are called."""
    called = {"modal": "our compiled stepper", "mujoco": "MuJoCo", "exudyn": "Exudyn"}
    return {engine: called[engine] for engine in ("modal", *study.extent.judges)}


def _mean(checks: list[Json]) -> float:
    return float(sum(check["until_steady"] for check in checks) / len(checks))
