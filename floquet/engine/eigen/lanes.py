"""Sixteen numbers at once: a small Numba type for the SIMD registers of the machine.

A lane array has shape (..., 16): entry i of sixteen independent problems side by side. Kernels written on `Lanes` read
like their scalar textbook form and run on all problems for little more than one. Each function below is plain NumPy on
arrays of shape (16,), and that is how it runs with NUMBA_DISABLE_JIT=1; the lowering underneath says the same to LLVM
on its ``<16 x double>``, which every machine supports (two AVX-512 registers, four AVX, eight NEON).
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

# Two registers of the widest kind: while one waits for a square root or a quotient, the other works.
WIDTH = 16
VECTOR = ir.VectorType(ir.DoubleType(), WIDTH)
ALL = ir.Constant(ir.IntType(64), WIDTH)
ALIGNMENT = ir.Constant(ir.IntType(32), 8)  # bytes, of an entry
# Rows of at most so many entries are better loaded as lanes than given to BLAS; none, where no instruction loads a part
# of a register.
ROW = WIDTH if get_host_cpu_features().get("avx") else 0


# ---- what kernels use, in plain NumPy ----


def load(array: FloatArray, i: int, j: int) -> FloatArray:
    """Return the lanes at row i, column j of a C-contiguous array (rows, columns, 16)."""
    return array[i, j].copy()


def store(array: FloatArray, i: int, j: int, value: FloatArray) -> None:
    """Write the lanes at row i, column j."""
    array[i, j] = value


def load_row(matrices: FloatArray, k: int, i: int) -> FloatArray:
    """Return row i of matrix k of a C-contiguous array (matrices, rows, columns), columns <= 16, zeros after it."""
    row = np.zeros(WIDTH)
    row[: matrices.shape[2]] = matrices[k, i]
    return row


def store_row(matrices: FloatArray, k: int, i: int, value: FloatArray) -> None:
    """Write the first of the lanes to row i of matrix k of such an array, as many as there are columns."""
    matrices[k, i] = value[: matrices.shape[2]]


def spread(value: float) -> FloatArray:
    """Return lanes that all hold ``value``."""
    return np.full(WIDTH, value)


def fma(a: FloatArray, b: FloatArray, c: FloatArray) -> FloatArray:
    """Return a b + c, rounded once where the machine can."""
    return a * b + c


def root(a: FloatArray) -> FloatArray:
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


# ---- the same for the compiler ----


class LanesType(types.Type):
    """Numba's type of sixteen float64 side by side."""

    def __init__(self) -> None:
        super().__init__(name="Lanes")


LANES = LanesType()


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, dmm: Any, fe_type: Any) -> None:
        super().__init__(dmm, fe_type, VECTOR)


def _typed(function: Any, result: types.Type) -> None:
    """Declare the type that ``function`` returns, whatever its arguments."""

    def typer(*arguments: Any) -> types.Type:
        return result

    typer.__signature__ = inspect.signature(function)  # type: ignore[attr-defined]
    type_callable(function)(lambda context: typer)


for _named in (load, load_row, spread, fma, root, magnitude, pick_le):
    _typed(_named, LANES)
_typed(store, types.none)
_typed(store_row, types.none)
_typed(highest, types.float64)


@infer_global(operator.add)
@infer_global(operator.sub)
@infer_global(operator.mul)
@infer_global(operator.truediv)
class _Binary(ConcreteTemplate):
    cases = [signature(LANES, LANES, LANES)]  # noqa: RUF012


@infer_global(operator.neg)
class _Unary(ConcreteTemplate):
    cases = [signature(LANES, LANES)]  # noqa: RUF012


def _pointer(context: Any, builder: Any, sig: Any, args: Any, length: Any) -> Any:
    """Return the address of the entries [args[1], args[2]] of the array args[0], so many on its last axis, as lanes."""
    view = context.make_array(sig.args[0])(context, builder, args[0])
    i, j = (context.cast(builder, args[k], sig.args[k], types.intp) for k in (1, 2))
    columns = cgutils.unpack_tuple(builder, view.shape)[1]
    entry = builder.add(builder.mul(i, columns), j)
    return builder.bitcast(builder.gep(view.data, [builder.mul(entry, length)]), VECTOR.as_pointer())


@lower_builtin(load, types.Array, types.Integer, types.Integer)
def _load(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.load(_pointer(context, builder, sig, args, ALL), align=8)


@lower_builtin(store, types.Array, types.Integer, types.Integer, LanesType)
def _store(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    builder.store(args[3], _pointer(context, builder, sig, args, ALL), align=8)
    return context.get_dummy_value()


def _row(context: Any, builder: Any, sig: Any, args: Any) -> tuple[Any, Any]:
    """Return the address of a row, and which lanes are in it."""
    view = context.make_array(sig.args[0])(context, builder, args[0])
    length = cgutils.unpack_tuple(builder, view.shape)[2]
    numbers = ir.Constant(ir.VectorType(length.type, WIDTH), list(range(WIDTH)))
    inside = builder.icmp_signed("<", numbers, _repeated(builder, length))
    return _pointer(context, builder, sig, args, length), inside


def _masked(builder: Any, name: str, result: Any, *args: Any) -> Any:
    """Call LLVM's load or store of some lanes."""
    kind = ir.FunctionType(result, [arg.type for arg in args])
    function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.masked.{name}.v{WIDTH}f64.p0")
    return builder.call(function, args)


@lower_builtin(load_row, types.Array, types.Integer, types.Integer)
def _load_row(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    address, inside = _row(context, builder, sig, args)
    return _masked(builder, "load", VECTOR, address, ALIGNMENT, inside, ir.Constant(VECTOR, [0.0] * WIDTH))


@lower_builtin(store_row, types.Array, types.Integer, types.Integer, LanesType)
def _store_row(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    address, inside = _row(context, builder, sig, args)
    _masked(builder, "store", ir.VoidType(), args[3], address, ALIGNMENT, inside)
    return context.get_dummy_value()


def _repeated(builder: Any, value: Any) -> Any:
    """Return a vector that holds the scalar ``value`` in every lane."""
    vector = ir.Constant(ir.VectorType(value.type, WIDTH), ir.Undefined)
    lane = builder.insert_element(vector, value, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(lane, lane, ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH))


@lower_builtin(spread, types.Number)
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
        kind = ir.FunctionType(VECTOR, [VECTOR] * count)
        return builder.call(cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.v{WIDTH}f64"), args)


_call(fma, "fmuladd", 3)
_call(root, "sqrt", 1)
_call(magnitude, "fabs", 1)


@lower_builtin(highest, LanesType)
def _highest(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    kind = ir.FunctionType(ir.DoubleType(), [VECTOR])
    return builder.call(
        cgutils.get_or_insert_function(builder.module, kind, f"llvm.vector.reduce.fmax.v{WIDTH}f64"), args
    )


@lower_builtin(pick_le, LanesType, LanesType, LanesType, LanesType)
def _pick_le(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    a, b, yes, no = args
    return builder.select(builder.fcmp_ordered("<=", a, b), yes, no)
