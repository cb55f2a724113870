"""Sixteen numbers at once: a small Numba type for the SIMD registers of the machine.

A lane array has shape (..., 16): one entry of sixteen independent problems, side by side. A kernel on lanes reads like
its scalar textbook form, and solves all sixteen problems in little more time than one. Each function of the first part
is plain NumPy on arrays of shape (16,); so it runs with NUMBA_DISABLE_JIT=1. The second part tells Numba how to compile
the same functions with LLVM's type ``<16 x double>``. Every machine supports it: as two AVX-512 registers, four AVX
registers or eight NEON registers.
"""

from __future__ import annotations

import inspect
import operator
from typing import Any

import numpy as np
from llvmlite import ir
from llvmlite.binding import get_host_cpu_features
from numba import types
from numba.core import cgutils
from numba.core.typing import signature
from numba.core.typing.templates import ConcreteTemplate, infer_global
from numba.extending import lower_builtin, models, register_model, type_callable

from periodic.checks import FloatArray

# Problems side by side. They fill two of the widest registers: one works while the other waits for a root or quotient.
LANE_COUNT = 16
VECTOR_TYPE = ir.VectorType(ir.DoubleType(), LANE_COUNT)
LANE_COUNT_IR = ir.Constant(ir.IntType(64), LANE_COUNT)
ENTRY_BYTES = 8  # of a float64; the alignment of rows, which begin anywhere
ENTRY_ALIGNMENT = ir.Constant(ir.IntType(32), ENTRY_BYTES)
# Entries of the longest row that is loaded as lanes: up to here that is faster than a call of BLAS. It is zero on
# machines without an instruction that loads a part of a register.
MAX_LANE_ROW = LANE_COUNT if get_host_cpu_features().get("avx") else 0


# ---- the functions that kernels use, in plain NumPy ----


def load(array: FloatArray, i: int, j: int) -> FloatArray:
    """Return the lanes at row i, column j of a C-contiguous array (rows, columns, 16)."""
    return array[i, j].copy()


def store(array: FloatArray, i: int, j: int, value: FloatArray) -> None:
    """Write the lanes at row i, column j."""
    array[i, j] = value


def load_row(matrices: FloatArray, k: int, i: int) -> FloatArray:
    """Return row i of matrix k of a C-contiguous array (matrices, rows, columns <= 16), filled up with zeros."""
    row = np.zeros(LANE_COUNT)
    row[: matrices.shape[2]] = matrices[k, i]
    return row


def store_row(matrices: FloatArray, k: int, i: int, value: FloatArray) -> None:
    """Write as many of the lanes as there are columns to row i of matrix k of such an array."""
    matrices[k, i] = value[: matrices.shape[2]]


def broadcast(value: float) -> FloatArray:
    """Return lanes that all hold ``value``."""
    return np.full(LANE_COUNT, value)


def fma(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Return a b + c, rounded once if the machine can."""
    return a * b + c


def square_root(a: FloatArray) -> FloatArray:
    """Return the square root of every lane."""
    return np.sqrt(a)


def magnitude(a: FloatArray) -> FloatArray:
    """Return the absolute value of every lane."""
    return np.abs(a)


def pick_le(a: FloatArray, b: FloatArray, yes: FloatArray, no: FloatArray) -> FloatArray:
    """Return ``yes`` in the lanes where a <= b, else ``no``."""
    return np.where(a <= b, yes, no)


def highest(a: FloatArray) -> float:
    """Return the largest of the lanes, none of them NaN."""
    return float(a.max())


# ---- the same functions for the compiler ----


class LanesType(types.Type):
    """Numba's type for sixteen float64 numbers side by side."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")


LANES_TYPE = LanesType()


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Any) -> None:
        super().__init__(dmm, fe_type, VECTOR_TYPE)


def _typed(function: Any, result: types.Type) -> None:
    """Declare the type that ``function`` returns for any arguments."""

    def typer(*arguments: Any) -> types.Type:
        return result

    typer.__signature__ = inspect.signature(function)  # type: ignore[attr-defined]
    type_callable(function)(lambda context: typer)


for _named in (load, load_row, broadcast, fma, square_root, magnitude, pick_le):
    _typed(_named, LANES_TYPE)
_typed(store, types.none)
_typed(store_row, types.none)
_typed(highest, types.float64)


@infer_global(operator.add)
@infer_global(operator.sub)
@infer_global(operator.mul)
@infer_global(operator.truediv)
class _Binary(ConcreteTemplate):
    cases = [signature(LANES_TYPE, LANES_TYPE, LANES_TYPE)]  # noqa: RUF012


@infer_global(operator.neg)
class _Unary(ConcreteTemplate):
    cases = [signature(LANES_TYPE, LANES_TYPE)]  # noqa: RUF012


def _pointer(context: Any, builder: Any, sig: Any, args: Any, length: Any) -> Any:
    """Return the address of args[0][args[1], args[2]] as lanes; ``length`` is the length of the array's last axis."""
    view = context.make_array(sig.args[0])(context, builder, args[0])
    i, j = (context.cast(builder, args[k], sig.args[k], types.intp) for k in (1, 2))
    columns = cgutils.unpack_tuple(builder, view.shape)[1]
    entry = builder.add(builder.mul(i, columns), j)
    return builder.bitcast(builder.gep(view.data, [builder.mul(entry, length)]), VECTOR_TYPE.as_pointer())


@lower_builtin(load, types.Array, types.Integer, types.Integer)
def _load(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.load(_pointer(context, builder, sig, args, LANE_COUNT_IR), align=ENTRY_BYTES)


@lower_builtin(store, types.Array, types.Integer, types.Integer, LanesType)
def _store(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    builder.store(args[3], _pointer(context, builder, sig, args, LANE_COUNT_IR), align=ENTRY_BYTES)
    return context.get_dummy_value()


def _row(context: Any, builder: Any, sig: Any, args: Any) -> tuple[Any, Any]:
    """Return the address of a row, and a mask of the lanes that lie in it."""
    view = context.make_array(sig.args[0])(context, builder, args[0])
    length = cgutils.unpack_tuple(builder, view.shape)[2]
    numbers = ir.Constant(ir.VectorType(length.type, LANE_COUNT), list(range(LANE_COUNT)))
    inside = builder.icmp_signed("<", numbers, _repeated(builder, length))
    return _pointer(context, builder, sig, args, length), inside


def _masked(builder: Any, name: str, result: Any, *args: Any) -> Any:
    """Call LLVM's masked load or store."""
    type_ = ir.FunctionType(result, [arg.type for arg in args])
    function = cgutils.get_or_insert_function(builder.module, type_, f"llvm.masked.{name}.v{LANE_COUNT}f64.p0")
    return builder.call(function, args)


@lower_builtin(load_row, types.Array, types.Integer, types.Integer)
def _load_row(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    address, inside = _row(context, builder, sig, args)
    return _masked(
        builder, "load", VECTOR_TYPE, address, ENTRY_ALIGNMENT, inside, ir.Constant(VECTOR_TYPE, [0.0] * LANE_COUNT)
    )


@lower_builtin(store_row, types.Array, types.Integer, types.Integer, LanesType)
def _store_row(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    address, inside = _row(context, builder, sig, args)
    _masked(builder, "store", ir.VoidType(), args[3], address, ENTRY_ALIGNMENT, inside)
    return context.get_dummy_value()


def _repeated(builder: Any, value: Any) -> Any:
    """Return a vector that holds the scalar ``value`` in every lane."""
    vector = ir.Constant(ir.VectorType(value.type, LANE_COUNT), ir.Undefined)
    lane = builder.insert_element(vector, value, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(lane, lane, ir.Constant(ir.VectorType(ir.IntType(32), LANE_COUNT), [0] * LANE_COUNT))


@lower_builtin(broadcast, types.Number)
def _spread(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return _repeated(builder, context.cast(builder, args[0], sig.args[0], types.float64))


def _instruction(function: Any, name: str) -> None:
    count = 1 if name == "fneg" else 2

    @lower_builtin(function, *[LanesType] * count)
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return getattr(builder, name)(*args)


for _operation, _name in {
    operator.add: "fadd",
    operator.sub: "fsub",
    operator.mul: "fmul",
    operator.truediv: "fdiv",
    operator.neg: "fneg",
}.items():
    _instruction(_operation, _name)


def _call(function: Any, name: str, count: int) -> None:
    @lower_builtin(function, *[LanesType] * count)
    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        type_ = ir.FunctionType(VECTOR_TYPE, [VECTOR_TYPE] * count)
        return builder.call(
            cgutils.get_or_insert_function(builder.module, type_, f"llvm.{name}.v{LANE_COUNT}f64"), args
        )


_call(fma, "fmuladd", 3)
_call(square_root, "sqrt", 1)
_call(magnitude, "fabs", 1)


@lower_builtin(highest, LanesType)
def _highest(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    type_ = ir.FunctionType(ir.DoubleType(), [VECTOR_TYPE])
    return builder.call(
        cgutils.get_or_insert_function(builder.module, type_, f"llvm.vector.reduce.fmax.v{LANE_COUNT}f64"), args
    )


@lower_builtin(pick_le, LanesType, LanesType, LanesType, LanesType)
def _pick_le(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    a, b, yes, no = args
    return builder.select(builder.fcmp_ordered("<=", a, b), yes, no)
