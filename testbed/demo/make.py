"""``python -m testbed.demo.make``: carry out the virtual tests whose records ship with the project.

The rig file beside this one is what the rig's owner knows. What was tested is another rig: its toleranced numbers are a
little off, and grease that nobody mentioned fills one sleeve. That truth is written to a file of its own.
"""

import argparse
from pathlib import Path

import numpy as np
import tomlkit

from models.arrays import FloatArray
from models.effects import EFFECTS, build_effect, entry_of
from models.effects.protocol import Effect
from models.rig import EffectEntry, Rig
from models.rig_file import read_rig
from testbed.records.write import write_record
from testbed.virtual import Noise, logarithmic_sweep, perturbed, random_phase_multisine, virtual_record

HERE = Path(__file__).parent
SEED = 20
FS = 2048.0
N_SAMPLES = 16384
NOISE = Noise(response=0.005, excitation=0.005)
HIDDEN = EffectEntry(kind="squeeze_film", sleeve="sleeve 2", damping=1.5)
"""Its size leaves the calibrated model at some 14 times the noise; ``testbed demo`` shows it."""


def main() -> None:
    """Write the records and the truth."""
    parser = argparse.ArgumentParser(prog="python -m testbed.demo.make", description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--out", type=Path, default=HERE, help="folder to write records/ and truth.toml to")
    make(parser.parse_args().out)


def make(folder: Path) -> None:
    """Write ``records/*.uff`` and ``truth.toml``.

    Args:
        folder: where to.
    """
    rig, rng = read_rig(HERE / "rig.toml"), np.random.default_rng(SEED)
    built, hidden = perturbed(rig, rng), build_effect(HIDDEN, rig, EFFECTS)
    (folder / "records").mkdir(parents=True, exist_ok=True)
    for name, excitation in excitations(rng).items():
        record = virtual_record(built, [hidden], excitation, FS, NOISE, rng, name)
        write_record(record, rig, folder / "records" / name)
    (folder / "truth.toml").write_text(tomlkit.dumps(truth(built, hidden)), encoding="utf-8")


def excitations(rng: np.random.Generator) -> dict[str, FloatArray]:
    """Force of each test, N, by the name of its file."""

    def multisine(rms: float) -> FloatArray:
        return random_phase_multisine(rng, FS, N_SAMPLES, 4, 5.0, 300.0, rms)

    return {
        "multisine_3N.uff": multisine(3.0),
        "sweep_10N.uff": logarithmic_sweep(FS, N_SAMPLES, 5.0, 300.0, 10.0),
        "multisine_6N_holdout.uff": multisine(6.0),
    }


def truth(built: Rig, hidden: Effect) -> tomlkit.TOMLDocument:
    """What was really tested, for whoever wants to see how close a diagnosis came.

    Args:
        built: the rig with its true numbers.
        hidden: what its file lacks.
    """
    document = tomlkit.document()
    document.add(
        tomlkit.comment("What the virtual tests were made with. No program but a test of the diagnosis reads it.")
    )
    document.add("seed", tomlkit.item(SEED))
    document.add("noise", tomlkit.item({"response": NOISE.response, "excitation": NOISE.excitation}))
    document.add("parameters", tomlkit.item({p.path: float(f"{p.value:.8g}") for p in built.parameters()}))
    document.add("effects", tomlkit.item([entry_of(hidden).model_dump(exclude_none=True)]))
    return document


if __name__ == "__main__":
    main()
