"""Calling the engine's own C functions from compiled code, through their addresses."""

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import mujoco
from llvmlite import ir
from numba import cfunc, types
from numba.extending import intrinsic


@cache
def _library() -> ctypes.CDLL:
    """The MuJoCo library that this process has loaded."""
    folder = Path(mujoco.__file__).parent
    return ctypes.CDLL(str(next(file for kind in ("so", "d") for file in sorted(folder.glob(f"*mujoco*.{kind}*")))))


def engine_address(function: str) -> int:
    """Address of a function of the MuJoCo library.

    Args:
        function: its name, e.g. ``mj_step1``.
    """
    return int(ctypes.cast(getattr(_library(), function), ctypes.c_void_p).value or 0)


@contextmanager
def without_warnings() -> Iterator[None]:
    """Without the engine's warnings, which it would print and write into a file in the working folder."""
    handler = ctypes.c_void_p.in_dll(_library(), "mju_user_warning")
    before, handler.value = handler.value, _deaf().address
    try:
        yield
    finally:
        handler.value = before


@cache
def _deaf() -> Any:
    """A C function that takes a message and does nothing, whoever holds Python's lock."""
    return cfunc(types.void(types.voidptr))(lambda message: None)  # noqa: ARG005


def _call_engine(typing_context: Any, address: Any, model: Any, data: Any) -> tuple[Any, Any]:
    del typing_context, address, model, data  # only their types matter here
    signature = types.void(types.int64, types.int64, types.int64)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        del signature
        pointer = ir.IntType(8).as_pointer()
        function = ir.FunctionType(ir.VoidType(), [pointer, pointer])
        address, model, data = args
        builder.call(
            builder.inttoptr(address, function.as_pointer()),
            [builder.inttoptr(model, pointer), builder.inttoptr(data, pointer)],
        )
        return context.get_dummy_value()

    return signature, codegen


call_engine: Any = intrinsic(_call_engine)
"""``call_engine(address, model, data)`` calls ``void function(mjModel*, mjData*)``."""
