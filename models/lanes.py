"""Numbers side by side in the registers of a core, for compiled loops that run over a few of them at every step.

A loop over arrays is compiled to ask first whether what it writes overlaps what it reads, and to go through memory
between one such loop and the next: over sixteen numbers that costs more than the arithmetic. These are read once, stay
in registers, and are written once. Any processor can: the compiler divides them among registers as wide as it has.
They are added, subtracted, multiplied and compared number by number, or all with one number.
"""

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.errors import TypingError
from numba.extending import intrinsic, models, overload, register_model

LANES, EIGHT, FOUR = 16, 8, 4
"""Numbers in the vectors that ``lanes``, ``eight`` and ``four`` read; arrays are padded to hold whole ones."""

FAST = ("contract", "reassoc", "nsz", "arcp")
"""As in ``step_options.OPTIONS``: a product and a sum may become one operation, and sums be formed in any order."""

ALIGNMENT = 8
"""Bytes: a vector may begin at any number of an array."""


class SideBySide(types.Type):
    """The compiled type of so many of one thing side by side.

    Args:
        width: how many.

    Attributes:
        each: what the compiler knows one of them as.
    """

    each: Any

    def __init__(self, width: int) -> None:
        self.width = width
        super().__init__(name=f"{type(self).__name__}({width})")

    def stored(self) -> Any:
        """What the compiler knows all of them as."""
        return ir.VectorType(self.each, self.width)


class Vector(SideBySide):
    """Doubles."""

    each = ir.DoubleType()


class Mask(SideBySide):
    """Answers."""

    each = ir.IntType(1)


@register_model(Vector)
@register_model(Mask)
class _InRegisters(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: SideBySide) -> None:
        super().__init__(manager, kind, kind.stored())  # type: ignore[no-untyped-call]


def _index(index: Any) -> Any:
    """The type of an index: one for a row, or one for each dimension."""
    return types.UniTuple(types.intp, len(index)) if isinstance(index, types.BaseTuple) else types.intp


def _checked(array: Any) -> None:
    """Numbers side by side must lie side by side.

    Raises:
        TypingError: where they do not, or are no doubles.
    """
    if not isinstance(array, types.Array) or array.layout != "C" or array.dtype != types.float64:
        raise TypingError(f"{array}: vectors are read from and written to contiguous arrays of doubles")


def _place(context: Any, builder: Any, signature: Any, args: Any, vector: Vector) -> Any:
    """Where in an array an index points to, as the place of a vector."""
    array_type, index_type = signature.args[:2]
    array = context.make_array(array_type)(context, builder, args[0])
    index = cgutils.unpack_tuple(builder, args[1]) if isinstance(index_type, types.BaseTuple) else [args[1]]
    first = cgutils.get_item_pointer(context, builder, array_type, array, index)
    return builder.bitcast(first, vector.stored().as_pointer())


def _reader(width: int) -> Any:
    vector = Vector(width)

    def read(typing_context: Any, array: Any, index: Any) -> tuple[Any, Callable[..., Any]]:
        del typing_context
        _checked(array)

        def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            found = builder.load(_place(context, builder, signature, args, vector))
            found.align = ALIGNMENT
            return found

        return vector(array, _index(index)), codegen

    return intrinsic(read)


lanes: Any = _reader(LANES)
"""``lanes(array, index)``: the ``LANES`` numbers of a row from there on."""

eight: Any = _reader(EIGHT)
"""``eight(array, index)``: the ``EIGHT`` numbers of a row from there on."""

four: Any = _reader(FOUR)
"""``four(array, index)``: the ``FOUR`` numbers of a row from there on."""


def _put(typing_context: Any, array: Any, index: Any, vector: Any) -> tuple[Any, Callable[..., Any]]:
    del typing_context
    _checked(array)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        builder.store(args[2], _place(context, builder, signature, args, signature.args[2])).align = ALIGNMENT
        return context.get_dummy_value()

    return types.none(array, _index(index), vector), codegen


put: Any = intrinsic(_put)
"""Write a vector to where an index points to."""


def _four_of(typing_context: Any, array: Any, numbers: Any, first: Any) -> tuple[Any, Callable[..., Any]]:
    del typing_context, first
    _checked(array)
    if numbers.layout != "C" or numbers.dtype not in {types.int64, types.uint64}:
        raise TypingError(f"{numbers}: places are told by a contiguous array of 64-bit integers")
    vector = Vector(FOUR)

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        row, places = (
            context.make_array(kind)(context, builder, arg).data
            for kind, arg in zip(signature.args[:2], args[:2], strict=True)
        )
        found = ir.Constant(vector.stored(), ir.Undefined)
        for k in range(FOUR):
            place = builder.load(builder.gep(places, [builder.add(args[2], ir.Constant(args[2].type, k))]))
            number = builder.load(builder.gep(row, [place]))
            found = builder.insert_element(found, number, ir.Constant(ir.IntType(32), k))
        return found

    return vector(array, numbers, types.intp), codegen


four_of: Any = intrinsic(_four_of)
"""The numbers of a row at ``FOUR`` places, which another row tells from ``first`` on."""


def _total(typing_context: Any, vector: Any) -> tuple[Any, Callable[..., Any]]:
    del typing_context

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        del context
        kind, double = signature.args[0], ir.DoubleType()
        name = f"llvm.vector.reduce.fadd.v{kind.width}f64"
        summed = cgutils.get_or_insert_function(builder.module, ir.FunctionType(double, [double, kind.stored()]), name)
        return builder.call(summed, [ir.Constant(double, -0.0), args[0]], fastmath=FAST)

    return types.float64(vector), codegen


total: Any = intrinsic(_total)
"""Sum of a vector's numbers."""


def _at(typing_context: Any, vector: Any, number: Any) -> tuple[Any, Callable[..., Any]]:
    del typing_context, number

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        del context, signature
        return builder.extract_element(*args)

    return types.float64(vector, types.intp), codegen


at: Any = intrinsic(_at)
"""One of a vector's numbers, counted from 0."""


def _chosen(typing_context: Any, mask: Any, yes: Any, no: Any) -> tuple[Any, Callable[..., Any]]:
    del typing_context
    vector = Vector(mask.width)
    kinds = [each if isinstance(each, Vector) else types.float64 for each in (yes, no)]

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        del context
        wide = [_wide(builder, arg, kind, vector) for arg, kind in zip(args[1:], signature.args[1:], strict=True)]
        return builder.select(args[0], *wide)

    return vector(mask, *kinds), codegen


chosen: Any = intrinsic(_chosen)
"""The numbers of one vector where a mask says so, and those of another elsewhere; either may be one number."""


def _digits(typing_context: Any, mask: Any) -> tuple[Any, Callable[..., Any]]:
    del typing_context

    def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        del context
        return builder.zext(builder.bitcast(args[0], ir.IntType(signature.args[0].width)), ir.IntType(64))

    return types.int64(mask), codegen


digits: Any = intrinsic(_digits)
"""The number whose binary digits are a mask's answers, the first of them the last digit."""


def _wide(builder: Any, number: Any, kind: Any, vector: SideBySide) -> Any:
    """A vector or a mask as it is, and one number as a vector of it alone."""
    if isinstance(kind, SideBySide):
        return number
    nothing, first = ir.Constant(vector.stored(), ir.Undefined), ir.Constant(ir.IntType(32), 0)
    one = builder.insert_element(nothing, number, first)
    return builder.shuffle_vector(one, nothing, ir.Constant(ir.VectorType(ir.IntType(32), vector.width), None))


def _define(
    sign: Callable[..., Any],
    operate: Callable[..., Any],
    result: type[SideBySide],
    of: type[SideBySide] = Vector,
) -> None:
    """Say what an operator does with two vectors (or masks), or with one and a number."""

    def both(typing_context: Any, one: Any, other: Any) -> tuple[Any, Callable[..., Any]]:
        del typing_context
        kind = of(next(each.width for each in (one, other) if isinstance(each, of)))
        kinds = [each if isinstance(each, of) else types.float64 for each in (one, other)]

        def codegen(context: Any, builder: Any, signature: Any, args: Any) -> Any:
            del context
            pairs = zip(args, signature.args, strict=True)
            return operate(builder, *(_wide(builder, arg, each, kind) for arg, each in pairs))

        return result(kind.width)(*kinds), codegen

    done: Any = intrinsic(both)

    @overload(sign, strict=False)
    def _signed(one: Any, other: Any) -> Callable[..., Any] | None:
        if not isinstance(one, of) and not isinstance(other, of):
            return None

        def operated(one: Any, other: Any) -> Any:
            return done(one, other)

        return operated


_define(operator.add, lambda builder, x, y: builder.fadd(x, y, flags=FAST), Vector)
_define(operator.sub, lambda builder, x, y: builder.fsub(x, y, flags=FAST), Vector)
_define(operator.mul, lambda builder, x, y: builder.fmul(x, y, flags=FAST), Vector)
_define(operator.truediv, lambda builder, x, y: builder.fdiv(x, y, flags=FAST), Vector)
_define(operator.lt, lambda builder, x, y: builder.fcmp_ordered("<", x, y), Mask)
_define(operator.le, lambda builder, x, y: builder.fcmp_ordered("<=", x, y), Mask)
_define(operator.gt, lambda builder, x, y: builder.fcmp_ordered(">", x, y), Mask)
_define(operator.ge, lambda builder, x, y: builder.fcmp_ordered(">=", x, y), Mask)
_define(operator.and_, ir.IRBuilder.and_, Mask, Mask)
_define(operator.or_, ir.IRBuilder.or_, Mask, Mask)
