"""Results in files: one format for all, as NetCDF or as an .npz archive, that holds data and no code.

A result is a tree of dataclasses and tuples with arrays as leaves. The arrays are the variables of the file, under the
names of their fields (``growth_rate``; ``regions`` of a list: ``0.outlines.0.Omega``). The tree, as JSON, stands beside
them and says what they belong to. NetCDF has no complex numbers: ``multiplier`` is there as ``multiplier_real`` and
``multiplier_imag``. Floquet modes are computed again, from their system, when they are loaded; the file also has what
other programs may look for.
"""

from __future__ import annotations

import io
import json
import os
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from enum import Enum
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from floquet import FloquetModes, Monodromy, PlaneChart, Regions, StabilityChart, floquet_modes
from floquet.modes import FloquetMode
from floquet.running import replace_file
from perturb.expansion import Expansion

FORMAT = "floquet-charts result 1"
# Types are looked up in these packages alone: a file cannot name other code.
PACKAGES_OF_RESULTS = ("periodic", "plate", "beam", "perturb", "floquet", "compare")
TREE = "result"
# What variables of this name are: in words, and their unit.
DESCRIPTIONS = {
    "Omega": ("excitation frequency", "rad per unit of time of the system"),
    "eps": ("relative amplitude of the excitation", "1"),
    "growth_rate": ("largest real part of an exponent, log|mu| / T", "per unit of time of the system"),
    "multiplier": ("Floquet multiplier of largest modulus", "1"),
    "kind": ("-1 undecided, 0 stable, unstable at +1: 1, at -1: 2, by a complex pair: 3", "1"),
    "error": ("estimated error of log|mu|", "1"),
}
Arrays = dict[str, NDArray[Any]]


def save(path: str | os.PathLike[str], result: Any) -> None:
    """Write a result to a file, which is replaced only once the new one is complete.

    Parameters
    ----------
    path : str or path
        Ends in .nc (NetCDF, which needs xarray) or in .npz.
    result : object
        A chart, regions, a trace, curves, modes, a monodromy, verdicts, a stress field, a response, ...; or a list,
        a tuple or a dictionary of such.

    Raises
    ------
    ValueError
        If ``path`` has another ending, xarray is missing, or the result holds something that is no data.
    OSError
        If the file cannot be written.
    """
    target = _path(path)
    if target.suffix == ".npz" and isinstance(result, StabilityChart | PlaneChart):
        result.save(target)
        return
    arrays: Arrays = {}
    tree = json.dumps({"format": FORMAT, "content": _plant(result, "", arrays)}, ensure_ascii=False)
    buffer = io.BytesIO()
    if target.suffix == ".npz":
        np.savez_compressed(buffer, allow_pickle=False, **{TREE: np.array(tree)}, **arrays)
        replace_file(target, buffer.getvalue())
    else:
        replace_file(target, _netcdf(tree, arrays, ("eps", "Omega") if isinstance(result, StabilityChart) else ()))


def load(path: str | os.PathLike[str]) -> Any:
    """Return the result that `save`, or the `save` of a chart, wrote to a file.

    Raises
    ------
    ValueError
        If the file is none of these, or xarray is missing.
    OSError
        If there is no such file.
    """
    source = _path(path)
    with source.open("rb") as file:
        content = file.read()
    try:
        if source.suffix == ".npz":
            with np.load(io.BytesIO(content), allow_pickle=False) as archive:
                if TREE not in archive:
                    return (PlaneChart if "names" in archive else StabilityChart).load(source)
                arrays, tree = {name: archive[name] for name in archive}, str(archive[TREE])
        else:
            arrays, tree = _variables(content)
        document = json.loads(tree)
        if document["format"] != FORMAT:
            raise ValueError(f"its format is {document['format']!r}, not {FORMAT!r}")
        return _grow(document["content"], arrays)
    except OSError:
        raise
    except Exception as error:  # SciPy, NumPy and zipfile each have their own for a file that is another one
        why = str(error).partition("\n")[0]
        raise ValueError(f"{path}: not a saved result ({why}); give a file that save wrote") from None


def _path(path: Any) -> Path:
    if not isinstance(path, str | os.PathLike):
        raise ValueError(f"path = {path!r} is not a path; give a file name")
    found = Path(path)
    if found.suffix not in (".nc", ".npz"):
        raise ValueError(f"path = {str(path)!r} has no known ending; give a name that ends in .nc or .npz")
    if found.suffix == ".nc" and find_spec("xarray") is None:
        raise ValueError(f"{found} needs xarray; install it with: pip install 'floquet-charts[xarray]', or take .npz")
    return found


# ---- results that are more than their fields ----


class Recipe(NamedTuple):
    """How a result is taken apart, and made whole again."""

    parts: Callable[[Any], dict[str, Any]]
    whole: Callable[[dict[str, Any]], Any]


def _monodromy(parts: dict[str, Any]) -> Monodromy:
    """Return it with its multipliers, which it would otherwise integrate for."""
    multipliers = parts.pop("multipliers"), parts.pop("multiplier_errors")
    found = Monodromy(**parts, _solved=())
    vars(found)["_multipliers"] = multipliers
    return found


def _named(*names: str) -> Callable[[Any], dict[str, Any]]:
    return lambda value: {name: getattr(value, name) for name in names}


OF_MODES = ("exponents", "errors", "harmonics", "participation", "coefficients")
OF_A_MONODROMY = ("matrix", "growth_rate", "error", "log_modulus_error", "kind", "rigid")
RECIPES: dict[type, Recipe] = {
    Regions: Recipe(
        lambda value: {"regions": list(value), "Omega_range": value.Omega_range, "eps_range": value.eps_range},
        lambda parts: Regions(parts["regions"], parts["Omega_range"], parts["eps_range"]),
    ),
    FloquetModes: Recipe(
        _named("system", "Omega", "eps", *OF_MODES),
        lambda parts: floquet_modes(parts["system"], parts["Omega"], parts["eps"]),
    ),
    Monodromy: Recipe(_named(*OF_A_MONODROMY, "multipliers", "multiplier_errors"), _monodromy),
    Expansion: Recipe(_named("family", "modes"), lambda parts: Expansion(**parts)),
}


# ---- the tree ----


def _plant(value: Any, name: str, arrays: Arrays) -> Any:
    """Return ``value`` as JSON and put its arrays into ``arrays``, each under its place."""

    def inside(key: object, part: Any) -> Any:
        return _plant(part, f"{name}.{key}" if name else str(key), arrays)

    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, Enum):
        return {"type": _name(type(value)), "member": value.name}
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, complex):
        return {"complex": [value.real, value.imag]}
    if isinstance(value, np.ndarray) and value.dtype.kind in "fiubc":
        leaf = {"dtype": value.dtype.str, "shape": list(value.shape)}
        if value.size == 0:  # a dimension without length is no dimension of NetCDF
            return leaf
        arrays[name or "values"] = np.asarray(value)
        return leaf | {"array": name or "values"}
    if isinstance(value, FloquetMode):
        raise ValueError(f"{name or 'result'} is one mode, which needs the others; save the FloquetModes that it is of")
    if type(value) in RECIPES:
        parts = RECIPES[type(value)].parts(value)
        return {"type": _name(type(value)), "recipe": {key: inside(key, part) for key, part in parts.items()}}
    if is_dataclass(value) and not isinstance(value, type):
        names = [field.name for field in fields(value) if field.init]
        return {"type": _name(type(value)), "fields": {key: inside(key, getattr(value, key)) for key in names}}
    if isinstance(value, tuple) and hasattr(value, "_fields"):
        return {"type": _name(type(value)), "fields": {key: inside(key, getattr(value, key)) for key in value._fields}}
    if isinstance(value, list | tuple | set | frozenset):
        members = sorted(value) if isinstance(value, set | frozenset) else value
        return {type(value).__name__: [inside(i, part) for i, part in enumerate(members)]}
    if isinstance(value, dict):
        return {
            "dict": [[_plant(key, f"{name}.key{i}", arrays), inside(key, value[key])] for i, key in enumerate(value)]
        }
    raise ValueError(
        f"{name or 'result'} is a {type(value).__name__}, which is no data; save what you computed from it"
    )


def _grow(tree: Any, arrays: Arrays) -> Any:
    """Return the value of which `_plant` has made ``tree``."""
    if not isinstance(tree, dict):
        return tree
    if "complex" in tree:
        return complex(*tree["complex"])
    if "dtype" in tree:
        found = arrays[tree["array"]] if "array" in tree else np.empty(0)
        array = found.reshape(tree["shape"]).astype(tree["dtype"])
        array.setflags(write=False)
        return array
    if "dict" in tree:
        return {_grow(key, arrays): _grow(part, arrays) for key, part in tree["dict"]}
    for kind in (list, tuple, set, frozenset):
        if kind.__name__ in tree:
            return kind(_grow(part, arrays) for part in tree[kind.__name__])
    found_type = _type(tree["type"])
    if "recipe" in tree:
        return RECIPES[found_type].whole({key: _grow(part, arrays) for key, part in tree["recipe"].items()})
    if "member" in tree:
        return found_type[tree["member"]]
    return found_type(**{key: _grow(part, arrays) for key, part in tree["fields"].items()})


def _name(kind: type) -> str:
    return f"{kind.__module__}:{kind.__qualname__}"


def _type(name: str) -> Any:
    """Return the dataclass, named tuple or enumeration of a name, from our packages alone."""
    module, _, kind = name.partition(":")
    if module.split(".")[0] not in PACKAGES_OF_RESULTS:
        raise ValueError(f"{name!r} is no type of a result")
    found = getattr(import_module(module), kind)
    is_data = isinstance(found, type) and (is_dataclass(found) or hasattr(found, "_fields") or issubclass(found, Enum))
    if not (is_data or found in RECIPES) or found.__module__ != module:
        raise ValueError(f"{name!r} is no type of a result")
    return found


# ---- NetCDF ----


def _netcdf(tree: str, arrays: Arrays, chart: tuple[str, ...]) -> bytes:
    import xarray

    variables: dict[str, Any] = {}
    for name, array in arrays.items():
        dimensions: tuple[str, ...]
        if chart and "." not in name:
            dimensions = (name,) if name in chart else chart
        else:
            dimensions = tuple(f"{name}_{axis}" for axis in range(array.ndim))
        words, unit = DESCRIPTIONS.get(name.rpartition(".")[2], ("", ""))
        attributes = {"long_name": words, "units": unit} if words else {}
        parts: dict[str, Callable[[Any], Any]] = {"": np.asarray}
        if array.dtype.kind == "c":
            parts = {"_real": np.real, "_imag": np.imag}
        for suffix, part in parts.items():
            plain = part(array)
            if plain.dtype.kind in "bu":
                plain = plain.astype(np.int32)
            variables[name + suffix] = (dimensions, plain, attributes)
    data = xarray.Dataset(variables, attrs={"format": FORMAT, TREE: tree})
    return bytes(data.to_netcdf(engine="scipy"))


def _variables(content: bytes) -> tuple[Arrays, str]:
    import xarray

    with xarray.open_dataset(io.BytesIO(content), engine="scipy", decode_times=False) as data:
        arrays = {str(name): variable.to_numpy() for name, variable in data.variables.items()}
        tree = str(data.attrs[TREE])
    for name in [name for name in arrays if name.endswith("_real")]:
        stem = name.removesuffix("_real")
        if f"{stem}_imag" in arrays:
            whole = np.empty(arrays[name].shape, complex)
            whole.real, whole.imag = arrays[name], arrays[f"{stem}_imag"]
            arrays[stem] = whole
    return arrays, tree
