"""Calling a compiled law through its address from compiled code."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


@intrinsic
def call_law(  # noqa: PLR0913
    typing_context: Any, address: Any, t: Any, q: Any, v: Any, z: Any, values: Any, offset: Any
) -> Any:
    """``law(t, q, v, z, &values[offset])`` for the law at ``address`` (see ``models.law.law_address``)."""
    del typing_context
    double = types.float64
    signature = double(types.int64, double, double, double, double, types.float64[::1], types.int64)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        address, t, q, v, z, values, offset = args
        array = context.make_array(signature.args[5])(context, builder, values)
        first = builder.gep(array.data, [offset])
        real = ir.DoubleType()
        law_type = ir.FunctionType(real, [real, real, real, real, first.type])
        law = builder.inttoptr(address, cgutils.voidptr_t if law_type is None else law_type.as_pointer())
        return builder.call(law, [t, q, v, z, first])

    return signature, codegen
