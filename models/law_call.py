"""Calling a compiled law through its address from compiled code."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


def _call_law(
    typing_context: Any, address: Any, t: Any, q: Any, v: Any, z: Any, values: Any, offset: Any
) -> tuple[Any, Any]:
    del typing_context, address, t, q, v, z, values, offset  # only their types matter here
    double = types.float64
    signature = double(types.int64, double, double, double, double, types.float64[::1], types.int64)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        address, t, q, v, z, values, offset = args
        array = context.make_array(signature.args[5])(context, builder, values)
        first = builder.gep(array.data, [offset])
        real = ir.DoubleType()
        law_type = ir.FunctionType(real, [real, real, real, real, first.type])
        law = builder.inttoptr(address, law_type.as_pointer())
        return builder.call(law, [t, q, v, z, first])

    return signature, codegen


call_law: Any = intrinsic(_call_law)
"""``call_law(address, t, q, v, z, values, offset)`` is ``law(t, q, v, z, &values[offset])`` for a ``law_address``."""
