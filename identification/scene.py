"""What the model says about the motion at every place where an effect could sit."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from identification.evaluate import Evaluator
from identification.hypothesis import Hypothesis
from identification.lag import Lag, lag
from identification.lines import Lines, lines_left
from identification.rest_target import FrfTarget, ModesTarget
from identification.together import loudness
from models.arrays import FloatArray
from models.drive import drive_of
from models.effects.protocol import Effect, Place, Scene
from models.linear import frf, linearised, natural_modes
from models.modal import ModalModel, build_modal
from models.plant import Plant
from models.ports import Port
from models.record import Record
from models.rig import Beam, Excitation, Rig, Sensor
from models.simulate import Response, simulate

GRID = 12
"""Positions tried along the beam; the shortest wave in the band spans several."""


def places_of(kind: type[Effect], rig: Rig, channels: Collection[Place] | None = None) -> list[Place]:
    """Where an effect of this kind could sit on this rig, positions on a grid that a fit refines.

    What can sit anywhere is looked for at the sleeves' positions, from where a fit can move it.

    Args:
        kind: of effect.
        rig: with its sleeves and sensors.
        channels: sensors, and pairs of them, on which it may sit; by default every sensor, and no pair.
    """
    if channels is None:
        channels = each_sensor(rig)
    suspected = [place for place in channels if ("sensor" if place.other is None else "sensor pair") in kind.places]
    if not isinstance(rig.structure, Beam):
        return suspected if "sensor" in kind.places else [Place()]
    if not kind.places:
        return [Place()]
    places: list[Place] = []
    if "position" in kind.places:
        length = rig.structure.length
        grid = [float(x) for x in length * np.arange(1, GRID + 1) / GRID]
        places += [Place(position=x) for x in sorted({*grid, *(s.position for s in rig.sleeves)})]
    elif "sleeve" in kind.places:
        places += sleeves_of(rig)
    return places + suspected


def each_sensor(rig: Rig) -> list[Place]:
    """The sensors of a rig as places."""
    return [Place(sensor=sensor.name) for sensor in rig.sensors]


def sleeves_of(rig: Rig) -> list[Place]:
    """The sleeves of a rig as places."""
    return [Place(sleeve=s.name, position=s.position) for s in rig.sleeves]


def places_near(kind: type[Effect], rig: Rig, position: float) -> list[Place]:
    """Where an effect of this kind could sit at a position along the beam, m, at a sleeve close by, or all over."""
    if not kind.places:
        return [Place()]
    if "position" in kind.places:
        return [Place(position=position)]
    if "sleeve" in kind.places and isinstance(rig.structure, Beam):
        close = NEAR * rig.structure.length
        return [p for p in sleeves_of(rig) if p.position is not None and abs(p.position - position) < close]
    return []


NEAR = 0.08
"""Share of the length within which a sleeve and a position are hard to tell apart."""


def is_same_place(here: Place, there: Place, rig: Rig) -> bool:
    """Places closer together than a fit tells; a sleeve and its position are one.

    Args:
        here: a place.
        there: another.
        rig: whose length counts.
    """
    if here.position is None or there.position is None or not isinstance(rig.structure, Beam):
        return here == there
    if here.sleeve is not None and there.sleeve is not None:
        return here.sleeve == there.sleeve
    return abs(here.position - there.position) < SAME_PLACE * rig.structure.length


SAME_PLACE = 0.02
"""Share of the length within which two positions are one."""


def in_one_valley(here: Place, there: Place, apart: float) -> bool:
    """Whether two places are one, or lie along the beam, neither in a sleeve, no farther apart than a valley is wide.

    Args:
        here: a place.
        there: another.
        apart: m (``valley``).
    """
    if here.position is None or there.position is None or here.sleeve or there.sleeve:
        return here == there
    return abs(here.position - there.position) <= apart


def valley(rig: Rig) -> float:
    """Distance, m, within which two places of the grid lie in one valley.

    Args:
        rig: whose length counts.
    """
    return 1.5 * rig.structure.length / GRID if isinstance(rig.structure, Beam) else 0.0


@dataclass(frozen=True)
class Longer:
    """What longer records tell than those that are looked at, whose beginning does not.

    Attributes:
        lines: single ones that a model leaves.
        lags: name of a sensor -> by how much its channel is late.
    """

    lines: Lines
    lags: Mapping[str, Lag]

    @classmethod
    def told_by(cls, evaluator: Evaluator, hypothesis: Hypothesis) -> Self:
        """What records tell beside a model.

        Args:
            evaluator: with the records.
            hypothesis: the model.
        """
        return cls(lines_left(evaluator, hypothesis), _lags(_heard(evaluator, hypothesis)))


def scenes(
    evaluator: Evaluator, hypothesis: Hypothesis, places: Collection[Place], longer: Longer | None = None
) -> dict[Place, Scene]:
    """The scene at every place, from the motion that the hypothesis predicts there.

    FRFs and mode shapes know no level: without time records the motion is that under an excitation of 1 rms (N, m, m/s
    or m/s^2), spread over their lines.

    Args:
        evaluator: records to simulate.
        hypothesis: the model so far.
        places: where.
        longer: what records tell that are longer than these; the lines are read from these where it is not given.
    """
    plant = hypothesis.plant()
    at = {place: _watched_at(place, plant) for place in places}
    positions = sorted(set(at.values()), key=lambda p: p or 0.0)
    watched = replace(plant, sensors=tuple(_probes(positions)), effects=())
    if not evaluator.timed:
        return _scenes_at_rest(evaluator.at_rest, plant, watched, at)
    size = dict.fromkeys(positions, Size())
    force = 0.0
    for target in evaluator.timed:
        record = replace(hypothesis.at_zero(target.record), sensors=tuple(sensor.name for sensor in watched.sensors))
        response = simulate(watched, record, evaluator.settings, hypothesis.start_of(record.name))
        seen = drive_of(record, watched, 1, {}).seen
        base = np.zeros((2, 1)) if seen is None else seen[:2]  # the probes read absolute motion
        moved, speed = response.channels[0::2] - base[0], response.channels[1::2] - base[1]
        for i, position in enumerate(positions):
            size[position] = size[position].grown(
                Size(
                    displacement=float(np.ptp(moved[i])) / 2,
                    velocity=_rms(speed[i]),
                    ground_velocity=_rms(response.channels[2 * i + 1]),
                    penetration=_penetration(response, position, moved[i]),
                )
            )
        force = max(force, _force(record, response, response.channels[1::2]))
    duration = max(target.whole for target in evaluator.timed)
    lines = lines_left(evaluator, hypothesis) if longer is None else longer.lines
    common = _common(response.model, force or 1.0, duration)
    heard = _heard(evaluator, hypothesis)
    common = replace(common, lines=(lines.free + lines.driven)[:MOST_LINES], loudness=_loudness(heard))
    rest = _at_rest(response.model, positions)
    found = {place: _scene(place, common, plant, size[x], rest[x]) for place, x in at.items()}
    names = {place.sensor for place in at if place.sensor is not None and place.other is None}
    late = {Place(sensor=name): lag_of.seconds for name, lag_of in _told_lags(heard, names, longer).items()}
    return {place: replace(scene, lag=late.get(place, 0.0)) for place, scene in found.items()}


Heard = Sequence[tuple[Record, FloatArray]]
"""Records, each with its (n, N) channels as predicted."""


def _heard(evaluator: Evaluator, hypothesis: Hypothesis) -> Heard:
    pairs = zip(evaluator.timed, evaluator.responses(hypothesis), strict=True)
    return [(t.record, r.channels[:, : t.record.n_samples]) for t, r in pairs]


def _loudness(heard: Heard) -> float:
    """Rms of the measured channels over the model's, the median over all records; 1 where nothing moves."""
    told = np.concatenate([loudness(record.responses, model) for record, model in heard])
    return float(np.median(told)) if len(told) else 1.0


def _told_lags(heard: Heard, names: Collection[str], longer: Longer | None) -> dict[str, Lag]:
    """Name of a sensor -> by how much its channel is late, here or in longer records, wherever it is more alike."""
    told = _lags(heard, names)
    return told if longer is None else {name: max(own, longer.lags.get(name, own)) for name, own in told.items()}


def _lags(heard: Heard, names: Collection[str] | None = None) -> dict[str, Lag]:
    """Name of a sensor, one of these or any -> by how much its channel is late."""
    rows: dict[str, list[tuple[FloatArray, FloatArray, float]]] = {}
    for record, model in heard:
        for k, name in enumerate(record.sensors):
            if names is None or name in names:
                rows.setdefault(name, []).append((record.responses[k], model[k], record.fs))
    return {name: lag(pairs) for name, pairs in rows.items()}


def _watched_at(place: Place, plant: Plant) -> float | None:
    """Where motion is watched for a place, m: there, at its sensor, or for the whole beam at its free end."""
    if place.position is not None or not plant.structure.is_beam:
        return place.position
    at_sensor = [sensor.position for sensor in plant.sensors if sensor.name == place.sensor]
    return next((position for position in at_sensor if position is not None), plant.structure.length)


def _scenes_at_rest(
    targets: Sequence[FrfTarget | ModesTarget],
    plant: Plant,
    watched: Plant,
    at: Mapping[Place, float | None],
) -> dict[Place, Scene]:
    """The scenes under an excitation of 1 rms; of a rig without one, under a force at the free end."""
    if watched.excitation is None:
        end = watched.structure.length if watched.structure.is_beam else None
        watched = replace(watched, excitation=Excitation(quantity="force", position=end))
    positions = [watched.sensors[k].position for k in range(0, len(watched.sensors), 2)]
    names = [sensor.name for sensor in watched.sensors]
    square, duration = np.zeros(len(names)), 0.0
    for target in targets:
        linear = linearised(build_modal(watched, float(target.frequency.max())))
        motion = frf(linear, target.frequency, names, target.excitation_position)
        square = np.maximum(square, np.mean(np.abs(motion) ** 2, axis=1))
        duration = max(duration, 1.0 / float(np.median(np.diff(target.frequency))))
    largest, speed = CREST * np.sqrt(square[0::2]), np.sqrt(square[1::2])
    depth = {c.position: d for c, d in zip(watched.contacts, linear.model.rest.penetration.tolist(), strict=True)}
    force = 1.0 if watched.excitation is not None and watched.excitation.quantity == "force" else _carried(linear.model)
    rest = _at_rest(linear.model, positions)
    found, common = {}, _common(linear.model, force, duration)
    for place, position in at.items():
        i = positions.index(position)
        deepest = max(0.0, depth[position] + largest[i]) if position in depth else 0.0
        moves = float(speed[i])
        size = Size().grown(Size(float(largest[i]), moves, moves, float(deepest)))
        found[place] = _scene(place, common, plant, size, rest[position])
    return found


CREST = 3.0
"""Largest value of a random motion over its rms."""


def _carried(model: ModalModel) -> float:
    return float(np.sum(model.carried**2))


def _at_rest(model: ModalModel, positions: Sequence[float | None]) -> dict[float | None, float]:
    """Displacement at rest, m, at each position."""
    rest = model.rest
    load = -model.plant.structure.gravity * model.carried
    for law, force in zip(model.plant.laws, rest.law_forces, strict=True):
        load = load + force * model.rows(law.port.position, law.port.derivative)
    for contact, force in zip(model.plant.contacts, rest.contact_forces, strict=True):
        load = load + force * model.rows(contact.position)
    yielding = np.divide(load, model.omega**2, out=np.zeros_like(load), where=model.omega > 0.0)
    return {position: float(model.rows(position) @ yielding) for position in positions}


TINY = 1e-9
"""Motion assumed at least, m and m/s, so that trial values stay finite at a place that does not move."""


@dataclass(frozen=True)
class Size:
    """How large the motion at a place is, over all records; see ``Scene``."""

    displacement: float = TINY
    velocity: float = TINY
    ground_velocity: float = TINY
    penetration: float = 0.0

    def grown(self, other: "Size") -> "Size":
        """The larger of both in everything."""
        return Size(*(max(one, more) for one, more in zip(vars(self).values(), vars(other).values(), strict=True)))


def _rms(signal: FloatArray) -> float:
    return float(np.sqrt(np.mean(signal**2)))


def _probes(positions: Sequence[float | None]) -> Iterator[Sensor]:
    for position in positions:
        for quantity in ("displacement", "velocity"):
            yield Sensor(name=f"{quantity} {position}", position=position, quantity=quantity)


def _penetration(response: Response, position: float | None, moved: FloatArray) -> float:
    model = response.model
    deepest = 0.0
    for contact in model.plant.contacts:
        if contact.position == position:
            q = model.rest.position[model.ports.index(Port(contact.position))] + moved
            deepest = max(deepest, float(np.abs(q - contact.offset).max()) - contact.clearance)
    return deepest


def _force(record: Record, response: Response, speed: FloatArray) -> float:
    """Rms of the excitation as a force; without a measured force, of the structure's inertia."""
    excitation = response.model.plant.excitation
    if record.excitation is not None and excitation is not None and excitation.quantity == "force":
        return float(np.sqrt(np.mean(record.excitation**2)))
    acceleration = np.gradient(speed[-1]) * record.fs
    return float(_carried(response.model) * np.sqrt(np.mean(acceleration**2)))


def _common(model: ModalModel, force: float, duration: float) -> Scene:
    """What the scenes at all places have in common."""
    plant = model.plant
    modes = natural_modes(linearised(model), (), float(model.omega.max()) / (2.0 * np.pi))
    return Scene(
        place=Place(),
        contact=None,
        structure=plant.structure,
        displacement=TINY,
        velocity=TINY,
        force=force,
        penetration=0.0,
        duration=duration,
        driven_base=plant.excitation is not None and plant.excitation.quantity != "force",
        natural_freqs=tuple(float(f) for f in modes.natural_freqs[:N_MODES]),
    )


MOST_LINES = 4

N_MODES = 6
"""Natural frequencies that a scene tells."""


def _scene(place: Place, common: Scene, plant: Plant, size: Size, rest: float) -> Scene:
    sensor = next((sensor.position for sensor in plant.sensors if sensor.name == place.sensor), None)
    contact = next((contact for contact in plant.contacts if contact.sleeve == place.sleeve), None)
    return replace(common, place=place, contact=contact, sensor_position=sensor, rest=rest, **vars(size))
