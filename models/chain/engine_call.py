"""Calling the engine's own C functions from compiled code, through their addresses."""

import ctypes
from functools import cache
from pathlib import Path
from typing import Any

import mujoco
from llvmlite import ir
from numba import types
from numba.extending import intrinsic


@cache
def engine_address(function: str) -> int:
    """Address of a function of the MuJoCo library that this process has loaded.

    Args:
        function: its name, e.g. ``mj_step1``.
    """
    file = next(iter(sorted(Path(mujoco.__file__).parent.glob("*mujoco*.so*"))), None)
    file = file or next(iter(sorted(Path(mujoco.__file__).parent.glob("*mujoco*.d*"))))
    return int(ctypes.cast(getattr(ctypes.CDLL(str(file)), function), ctypes.c_void_p).value or 0)


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
