"""The modal model block by block in bounded memory, so that what watches it can change its laws while it runs.

A block of force gives as many samples of the channels, ``latency`` samples late: the force between samples and the
recorder's filter both look ahead (docs/theory.md, section 6). Joined, the blocks are what ``simulate`` predicts from
the whole record, but for the little that the recorder's kernel loses where it is cut (``LiveRecorder``) and for the
ends: ``simulate`` continues the motion beyond the first and the last sample, here it rests before and goes on after.
"""

from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass, replace

import numpy as np

from models.arrays import FloatArray
from models.band_limit import STOP_EDGE
from models.drive import STILL, Drive
from models.effects.protocol import Measurement
from models.errors import DivergenceError, InputError
from models.live_band import CHANNEL_REACH, FORCE_REACH, LiveRecorder, continue_before, force_kernels, raise_block
from models.live_checks import check_change, check_live, check_rest, check_steps, damped
from models.modal import ModalModel, build_modal
from models.plant import Plant
from models.simulate import FORCE_TOLERANCE, load_of, output_rows, steps_per_sample
from models.step_tables import items_of, linear_of
from models.stepping import Items, Linear, Memory, Reading, march_on

LONGEST_BLOCK = 1024
"""Samples that are moved at once; a longer block is cut, so that memory stays bounded."""

SAME_REST = 1e-6
"""Share of the load by which forces at rest may differ: far above what the search for rest leaves, and nothing beside
what moves the beam."""

NO_TRACE = np.empty((0, 0))


@dataclass(frozen=True, eq=False)
class _Tables:
    """What no change of a law touches.

    Attributes:
        n_modes: as asked for.
        load: force by which the tolerance of the iteration is measured, N.
        linear: one step of the linear part.
        rows: what the sensors read of the state.
        recorder: from there to the channels.
    """

    n_modes: int | None
    load: float
    linear: Linear
    rows: Reading
    recorder: LiveRecorder


@dataclass(eq=False)
class _Motion:
    """What is carried from block to block; its size does not change.

    Attributes:
        state: (2n,) of the stepper.
        memory: of the stepper.
        force: (2 FORCE_REACH + 1,) the last samples given, N.
        fine: (n_sensors, n_kept) the last motion read out at every step.
        given: samples of force so far.
    """

    state: FloatArray
    memory: Memory
    force: FloatArray
    fine: FloatArray
    given: int = 0

    @property
    def reached(self) -> int:
        """Number of the last sample to which the model has moved; the first one, at rest, before it starts."""
        return max(self.given - 1 - FORCE_REACH, 0)


@dataclass(frozen=True, eq=False)
class LiveModel:
    """A modal model on its way: ``advance`` moves it, ``with_damping`` and ``changed`` continue its motion otherwise.

    Attributes:
        model: the modal model that moves, with the laws of the moment.
    """

    model: ModalModel
    _tables: _Tables
    _items: Items
    _motion: _Motion

    @classmethod
    def of(
        cls,
        plant: Plant,
        fs: float,
        *,
        peak: float,
        n_modes: int | None = None,
        steps: int | None = None,
        reach: int = CHANNEL_REACH,
    ) -> "LiveModel":
        """The plant at rest.

        Args:
            plant: the rig with its effects, driven by a force.
            fs: rate of force and channels, Hz.
            peak: largest force that is to come, N; sets the tolerance of the iteration, and with it the steps.
            n_modes: dynamic modes; None chooses them as ``simulate`` does.
            steps: of the integrator per sample; None chooses them as ``simulate`` does.
            reach: samples that a channel looks ahead, a part of the latency; see ``LiveRecorder`` for its cost.

        Raises:
            InputError: a plant that is not driven by a force, or that has an effect which looks beyond a block.
        """
        check_live(plant, fs)
        if not (np.isfinite(peak) and peak > 0.0 and 0 < reach <= LONGEST_BLOCK):
            raise InputError(
                f"peak = {peak:g} N, reach = {reach} samples",
                f"a load is more than 0, a reach from 1 to {LONGEST_BLOCK}",
                "say how large the force will be at most, and leave the reach out",
            )
        model = build_modal(plant, STOP_EDGE * fs, n_modes)
        load = load_of(model, Drive(np.array([peak]), None, STILL, None))
        factor = steps or steps_per_sample(model, fs, load)
        system, linear, _ = linear_of(model, Drive(np.zeros(1), None, STILL, None), 1.0 / (factor * fs))
        rows = output_rows(model, system, plant.sensors)
        from_rate = tuple(int(sensor.quantity == "acceleration") for sensor in plant.sensors)
        recorder, items = LiveRecorder(reach, factor, fs, from_rate), items_of(model)
        motion = _Motion(
            state=np.zeros(len(system.from_modal)),
            memory=Memory.fresh(len(model.ports), len(items.port)),
            force=np.zeros(2 * FORCE_REACH + 1),
            fine=np.zeros((len(rows), recorder.n_kept)),
        )
        return cls(model, _Tables(n_modes, load, linear, Reading.of(rows), recorder), items, motion)

    @property
    def fs(self) -> float:
        """Rate of force and channels, Hz."""
        return self._tables.recorder.fs

    @property
    def steps_per_sample(self) -> int:
        """Steps of the integrator per sample."""
        return self._tables.recorder.factor

    @property
    def latency(self) -> int:
        """Samples by which the channels lag behind the force that was given with them."""
        return FORCE_REACH + self._tables.recorder.reach

    @property
    def time(self) -> float:
        """Where the motion is, s after the first sample: the time at which a changed law begins to act."""
        return self._motion.reached / self.fs

    def advance(self, force: FloatArray) -> FloatArray:
        """Move on by a block, and record.

        Args:
            force: (n_samples,) measured force that follows the last block's, N, band-limited to 0.43 fs.

        Returns:
            (n_sensors, n_samples) channels, SI, in the order of the rig's sensors. Column j belongs to the sample
            ``latency`` before ``force[j]``; where that lies before the first one the model rested.

        Raises:
            InputError: a force that is not a row of finite numbers.
            DivergenceError: the motion left the finite numbers.
        """
        force = np.asarray(force, float)
        if force.ndim != 1 or force.size == 0 or not np.isfinite(force).all():
            raise InputError(
                f"a force of size {force.shape}, of which {np.count_nonzero(~np.isfinite(force))} are not finite",
                "a block is a row of one or more finite numbers, N",
                "pass the samples that follow the last block's",
            )
        for effect in self.model.plant.effects:
            force = effect.change_excitation(force)
        parts = [self._moved(force[i : i + LONGEST_BLOCK]) for i in range(0, len(force), LONGEST_BLOCK)]
        channels = np.hstack(parts) if len(parts) > 1 else parts[0]
        measurement = Measurement(tuple(sensor.name for sensor in self.model.plant.sensors), self.fs, {})
        for effect in self.model.plant.effects:
            channels = effect.change_channels(channels, measurement)
        return channels

    def with_damping(self, damping: Mapping[str, float]) -> "LiveModel":
        """The same motion, from ``time`` on with other dampings in the sleeves; the model itself stays as it is.

        Args:
            damping: of each sleeve that changes, by name, N s/m.

        Raises:
            InputError: a sleeve that the rig has not, or a law whose damping is no such number.
        """
        contacts = {contact.sleeve: contact for contact in self.model.plant.contacts}
        for name, value in damping.items():
            if name not in contacts:
                raise InputError(f"sleeve {name!r}", f"the rig has {', '.join(contacts)}", "use one of these names")
            contacts[name] = damped(contacts[name], value)
        return self.changed(replace(self.model.plant, contacts=tuple(contacts.values())))

    def changed(self, plant: Plant) -> "LiveModel":
        """The same motion, from ``time`` on with the laws and contacts of another plant; the model itself stays.

        Args:
            plant: the same structure, sensors and excitation, with laws and contacts of other numbers.

        Raises:
            InputError: a plant with other modes, ports or rest, or one that needs shorter steps.
        """
        tables, old = self._tables, self.model
        check_change(plant, old.plant)
        check_live(plant, self.fs)
        new = build_modal(plant, STOP_EDGE * self.fs, tables.n_modes)
        check_rest(new.port_forces(new.rest), old.port_forces(old.rest), SAME_REST * tables.load)
        needed, before = (steps_per_sample(model, self.fs, tables.load) for model in (new, old))
        check_steps(needed, max(before, self.steps_per_sample))
        model = replace(old, plant=plant)
        return replace(self, model=model, _items=items_of(model), _motion=deepcopy(self._motion))

    def _moved(self, force: FloatArray) -> FloatArray:
        """(n_sensors, n_samples) channels of the sensors themselves, for a block of the true force."""
        motion, tables, factor = self._motion, self._tables, self.steps_per_sample
        known, first = np.append(motion.force, force), motion.reached
        motion.given += len(force)
        fine = np.zeros((len(motion.fine), motion.fine.shape[1] + len(force) * factor))
        fine[:, : motion.fine.shape[1]] = motion.fine
        if motion.reached > first:
            if first == 0:
                continue_before(known, len(known) - motion.given)
            inputs = raise_block(known[first - motion.reached - 2 * FORCE_REACH - 1 :], force_kernels(factor))
            out = np.empty((len(fine), inputs.shape[1]))
            self._march(inputs, first * factor, out)
            fine[:, -(out.shape[1] - 1) :] = out[:, 1:]
        motion.force = known[-len(motion.force) :].copy()
        motion.fine = fine[:, -motion.fine.shape[1] :].copy()
        return tables.recorder.record(fine)

    def _march(self, inputs: FloatArray, past: int, out: FloatArray) -> None:
        motion, tables = self._motion, self._tables
        tolerance = FORCE_TOLERANCE * tables.load
        done = march_on(
            tables.linear, self._items, inputs, STILL, motion.state, motion.memory, past,
            tables.rows, out, NO_TRACE, tolerance,
        )  # fmt: skip
        if done < out.shape[1] - 1:
            raise DivergenceError(
                f"live: the motion grew without bound {(past + done) * tables.linear.h:.4f} s after the start; "
                "a passive structure stays finite; look for a negative stiffness or damping among the effects"
            )
