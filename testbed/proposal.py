"""The next experiment as JSON, as rows of a table and as files that ``testbed simulate`` runs."""

import os
import shlex
from collections.abc import Mapping
from pathlib import Path

import tomlkit

from identification.next_experiment.planned import SEED, PlannedTest
from identification.next_experiment.proposal import Option, Proposal
from identification.next_experiment.words import sigmas
from models.effects import Effect, entry_of
from models.rig_file import write_rig
from testbed.outputs import Json

EXPERIMENT, RIG = "next_experiment.toml", "next_rig.toml"


def proposal_json(proposal: Proposal) -> Json:
    """``next_experiment`` of ``diagnosis.json``; a test that nothing was weighed for has words and an excitation only.

    Args:
        proposal: of a finished diagnosis.
    """
    content: Json = {"do": proposal.do, "why": proposal.why}
    if proposal.best is not None:
        content |= {**_promise(proposal.best), "present_probability": proposal.present_probability}
    if proposal.test is not None:
        content |= _test(proposal.test)
    if proposal.options:
        content["options"] = [
            {"do": option.test.words, **_promise(option), **_test(option.test)} for option in proposal.options
        ]
    return content


def _promise(option: Option) -> Json:
    promise = {"expected_probability": option.expected_probability, "separation": option.separation}
    return {**promise, "confirmed": option.confirmed}


def _test(test: PlannedTest) -> Json:
    more = {} if test.sensor is None else {"sensor": test.sensor}
    return {"minutes": test.minutes, "excitation": dict(test.excitation), **more}


HEADS = ("test", "minutes", "expected probability", "separation", "largest reading")


def option_rows(proposal: Proposal) -> list[tuple[str, ...]]:
    """The affordable tests as finished texts, the best first, under ``HEADS``.

    Args:
        proposal: of a finished diagnosis.
    """
    return [
        (
            option.test.words,
            f"{option.test.minutes:.3g}",
            f"{'' if option.confirmed else 'up to '}{option.expected_probability:.3f}",
            sigmas(option.separation),
            f"{option.reach:.2g} x",
        )
        for option in proposal.options
    ]


def excitation_rows(proposal: Proposal) -> list[tuple[str, str]]:
    """Keys and values of the ``[excitation]`` table of the proposed test.

    Args:
        proposal: of a finished diagnosis.
    """
    table = {} if proposal.test is None else proposal.test.excitation
    return [(key, value if isinstance(value, str) else f"{value:.4g}") for key, value in table.items()]


def write_experiment(proposal: Proposal, like: Path, folder: Path, home: Path | None = None) -> None:
    """Write ``next_experiment.toml``, and the rig with its new sensor where the test asks for one.

    Args:
        proposal: of a finished diagnosis; without a test nothing is written.
        like: the owner's rig file.
        folder: of the results.
        home: where these will lie in the end, if not there; the command in the file runs in it.

    Raises:
        InputError: the folder cannot be written.
    """
    if proposal.test is None:
        return
    rig = RIG if proposal.rig is not None else _seen_from(home or folder, like)
    (folder / EXPERIMENT).write_text(_experiment(proposal, proposal.test, rig), encoding="utf-8")
    if proposal.rig is not None:
        write_rig(proposal.rig, folder / RIG, like=like)


def stale(proposal: Proposal) -> tuple[str, ...]:
    """Names of the files that an earlier run may have left and this proposal does not write.

    Args:
        proposal: of a finished diagnosis.
    """
    missing = {EXPERIMENT: proposal.test is None, RIG: proposal.rig is None}
    return tuple(name for name, is_missing in missing.items() if is_missing)


def _seen_from(folder: Path, file: Path) -> str:
    """The path of a file for whoever works in a folder; the whole path where no relative one leads there."""
    try:
        return os.path.relpath(file.resolve(), folder.resolve())
    except ValueError:
        return str(file.resolve())


def _experiment(proposal: Proposal, test: PlannedTest, rig: str) -> str:
    """The text of an experiment file (docs/experiments.md)."""
    anywhere = " --format h5" if "position" in test.excitation and not test.is_held else ""
    command = f"testbed simulate {shlex.quote(rig)} {EXPERIMENT}{anywhere} --out next_records"
    document = tomlkit.document()
    for line in (f"The next experiment: {proposal.do}.", f"To try it on the model, in this folder: {command}"):
        document.add(tomlkit.comment(line))
    document.add("fs", tomlkit.item(test.fs))
    document.add("seed", tomlkit.item(SEED))
    document.add("excitation", tomlkit.item(dict(test.excitation)))
    document.add("sensors", tomlkit.item(_sensors(proposal.noise or {}, test.fs, held=test.is_held)))
    text = tomlkit.dumps(document)
    if proposal.rivals:
        text += "\n# To see what it would show, simulate it with one of what it tells apart:\n"
        tables = [tomlkit.dumps({"truth": {"effects": [_table(effect)]}}) for effect in proposal.rivals]
        text += "#\n".join("".join(f"# {line}\n" for line in table.strip().splitlines()) for table in tables)
    return text


def _sensors(noise: Mapping[str, float], fs: float, *, held: bool) -> Json:
    """Noise of the records so far as a density, SI / sqrt(Hz): white noise up to fs / 2."""
    return {
        name: {"noise_density": float(f"{sigma * (2.0 / fs) ** 0.5:.3g}")}
        for name, sigma in noise.items()
        if sigma > 0.0 and not (held and name == "excitation")
    }


def _table(effect: Effect) -> Json:
    content: Json = entry_of(effect).model_dump(exclude_none=True)
    return {key: list(value) if isinstance(value, tuple) else value for key, value in content.items()}
