"""Tables 6 and 7 of the article, what stands beside them, and the slews, in Markdown."""

from collections.abc import Iterator, Sequence

from testbed.article.published import published_probability
from testbed.article.uncertain import ACCEPTABLE, BURNT, CONDITIONS, CONFIDENCE, STEPS, WALKERS
from testbed.outputs import Json

MILLI = 1e3


def condition_table(found: Json) -> Iterator[str]:
    """Table 6: mean, standard deviation and variation coefficient of four frequencies, with 95 % intervals.

    Args:
        found: as ``probability`` gives it.
    """
    theirs = published_probability()
    yield f"{found['samples']} rigs a condition; +- is half the 95 % interval of the estimate."
    yield ""
    yield "| random | | f1 [Hz] | f2 | f3 | f4 |"
    yield "|---|---|---|---|---|---|"
    for what, row in found["conditions"].items():
        name = f"{what}, {CONDITIONS[what]:.0%}" if what in CONDITIONS else "all three"
        for head, key, within in (("mean", "mean", "mean_within"), ("standard deviation", "std", "std_within")):
            pairs = zip(row[key], row[within], strict=True)
            cells = " | ".join(f"{value:.4f} +- {half:.4f}" for value, half in pairs)
            yield f"| {name} | {head} | {cells} |"
        yield f"| | variation | {' | '.join(f'{value:.3%}' for value in row['variation'])} |"
        if what in CONDITIONS:
            printed = getattr(theirs, f"{what}_variation")
            yield f"| | article's variation | {' | '.join(f'{value:.2%}' for value in printed)} |"


def posterior_table(found: Json) -> Iterator[str]:
    """The posterior of the updated numbers, and how they go together.

    Args:
        found: as ``probability`` gives it.
    """
    row = found["posterior"]
    yield "| number | posterior mean | standard deviation | assumed |"
    yield "|---|---|---|---|"
    for sleeve, (mean, std) in enumerate(zip(*row["stiffness"], strict=True), start=1):
        assumed = f"{CONDITIONS['stiffness']:.0%}"
        yield f"| stiffness of sleeve {sleeve} [N/m] | {mean:.5g} | {std:.2g} ({std / mean:.1%}) | {assumed} |"
    for sleeve, (mean, std) in enumerate(zip(*row["damping_factor"], strict=True), start=1):
        assumed = f"{CONDITIONS['damping']:.0%}"
        yield f"| damping of sleeve {sleeve} over the identified course | {mean:.4f} | {std / mean:.1%} | {assumed} |"
    mean, std = row["modulus"]
    yield f"| Young's modulus over the given one | {mean:.5f} | {std:.2g} ({std / mean:.2%}) | not varied |"
    yield ""
    largest, pair = max((abs(row["correlation"][i][j]), (i, j)) for i in range(len(row["numbers"])) for j in range(i))
    names = " and ".join(row["numbers"][i] for i in pair)
    freq, ratio = row["own_errors"]
    yield (
        f"The model's own error, inferred with the numbers: {freq:.2%} of a frequency and {ratio:.1%} of a damping "
        f"ratio. "
        f"The strongest correlation is that of {names}, {row['correlation'][pair[0]][pair[1]]:+.2f} ({largest:.0%} "
        f"of what it "
        f"can be). The sampler forgets a number in {row['steps_to_forget']:.0f} steps at most; {STEPS - BURNT} of "
        f"each of "
        f"its {WALKERS} walkers count, worth {row['independent']:.0f} independent samples."
    )


def difference_table(found: Json) -> Iterator[str]:
    """Table 7: computed against measured frequency, tap by tap, with Student's interval over the taps.

    Args:
        found: as ``probability`` gives it.
    """
    row, theirs = found["difference"], published_probability()
    yield (
        "| order | test [Hz] | computed [Hz] | mean difference | standard deviation | 95 % interval of the mean "
        f"| within +-{ACCEPTABLE:g} | coincidence | article: difference | standard deviation | interval | coincidence |"
    )
    yield "|" + "---|" * 12
    for order in range(4):
        low, high = row["interval"][order]
        both = [found["coincidence"][key][order] for key in ("posterior", "assumed")]
        posterior, assumed = (f"{share:.3f} +- {within:.3f}" for share, within in both)
        cells = [
            str(order + 1),
            f"{row['measured'][order]:.3f}",
            f"{row['computed'][order]:.3f}",
            f"{row['mean'][order]:+.5f}",
            f"{row['std'][order]:.5f}",
            f"({low:+.5f}, {high:+.5f})",
            f"{row['inside'][order]:.2%}",
            f"{posterior} ({assumed} assumed)",
            f"{theirs.difference[order]:+.4f}",
            f"{theirs.difference_std[order]:.4f}",
            f"({theirs.difference_low[order]:+.4f}, {theirs.difference_high[order]:+.4f})",
            f"{theirs.coincidence[order]:.4f}",
        ]
        yield f"| {' | '.join(cells)} |"
    least = min(row["inside"])
    verdict = "is reliable" if least >= CONFIDENCE else "is not reliable"
    yield ""
    yield f"{least:.1%} of the differences at least are acceptable, so at {CONFIDENCE:.0%} the model {verdict}."


def without_uncertainty(found: Json) -> Iterator[str]:
    """What one number without an interval leaves unsaid.

    Args:
        found: as ``probability`` gives it.
    """
    row = found["intervals"]
    heads = "posterior, 95 % | holds the test | assumed, 95 % | holds | times as wide"
    yield f"| order | test [Hz] | a model without uncertainty | off by | {heads} |"
    yield "|" + "---|" * 9
    for order in range(4):
        test, alone = row["test"][order], row["alone"][order]
        cells = [str(order + 1), f"{test:.3f}", f"{alone:.3f}", f"{alone / test - 1.0:+.3%}"]
        widths = []
        for key in ("posterior", "assumed"):
            low, high = row[key][order]
            widths.append(high - low)
            cells += [f"{low:.3f} to {high:.3f}", "yes" if low <= test <= high else "no"]
        yield f"| {' | '.join(cells)} | {widths[1] / widths[0]:.1f} |"
    emulator = found["emulator"]
    low, high = emulator["interval"]
    apart = (emulator["mean"] - emulator["alone"]) / (emulator["error"] * emulator["std"])
    yield ""
    yield (
        f"Of the struck response a model without uncertainty says {emulator['alone']:.2f} m/s^2 rms at the tip. With "
        f"the "
        f"assumed scatter it is {emulator['mean']:.2f} in the mean, {apart:+.1f} times the emulator's error away, "
        f"and 95 % "
        f"of the rigs lie within {low:.2f} and {high:.2f}. The test reads {emulator['measured']:.2f}."
    )


def emulator_words(found: Json) -> Iterator[str]:
    """How good the emulator is.

    Args:
        found: as ``probability`` gives it.
    """
    emulator = found["emulator"]
    yield (
        f"Shares of the variance by Sobol's method, of the frequencies from the model itself, of the struck response "
        f"from a Gaussian process. At {len(emulator['simulated'])} points that it has not seen the process is off by "
        f"{emulator['error']:.1%} of the response's standard deviation, and its 95 % intervals hold "
        f"{emulator['covered']:.0%} of the simulations. The intervals of its shares do not hold the emulator's own "
        f"error."
    )


def slew_table(rows: Sequence[Json]) -> Iterator[str]:
    """The tip's error with every course, in every simulator.

    Args:
        rows: one a clearance.
    """
    names = list(rows[0]["courses"])
    yield "Rms of the tip's error from the begin of the slew to half a second after its end, in um.\n"
    yield f"| clearance [mm] | simulator | {' | '.join(names)} |"
    yield "|" + "---|" * (2 + len(names))
    for row in rows:
        for engine in next(iter(row["courses"].values())):
            cells = " | ".join(f"{1e6 * row['courses'][name][engine]['rms']:.3g}" for name in names)
            yield f"| {MILLI * row['clearance']:g} | {engine} | {cells} |"
