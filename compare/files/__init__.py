"""Files of users, read and written: cases, matrices, results.

A case file (TOML) becomes a checked `Case`, and its variants become plates:

>>> from compare.files import load_case, shipped_cases
>>> case = load_case(shipped_cases()[0])
>>> case.name, case.compare, [plate.speed for plate in case.systems().values()]
('fig2', 'within', [3.0])

Matrices of your own become a system, from .npz, MATLAB .mat or a folder of Matrix Market files, and go back to the last
bit; a Python file may define what they cannot hold:

>>> import tempfile
>>> from pathlib import Path
>>> from compare.files import load_system, save_system
>>> from periodic.examples import mathieu
>>> with tempfile.TemporaryDirectory() as folder:
...     save_system(Path(folder) / "mine.npz", mathieu(2.5))
...     print(load_system(Path(folder) / "mine.npz").stiffness)
[[2.5]]

A result of any sort goes into a file of one format and comes back; `save` and `load` are handed on by `compare`.

Studies are written into `staged` folders, which replace an old result only by a complete new one. Every fault of a file
is a ValueError that names the file and what is wrong in it. Only Python files are executed.
"""

from compare.files.cases import (
    MAX_CHART_POINTS,
    STANDARD_REGIONS,
    Case,
    Load,
    Plate,
    load_case,
    shipped_cases,
)
from compare.files.matrices import load_system, save_system
from compare.files.names import MATRIX_NAMES
from compare.files.publish import staged
from compare.files.python_file import python_function
from compare.files.results import load, save
from compare.files.spelling import did_you_mean

__all__ = [
    "MATRIX_NAMES",
    "MAX_CHART_POINTS",
    "STANDARD_REGIONS",
    "Case",
    "Load",
    "Plate",
    "did_you_mean",
    "load",
    "load_case",
    "load_system",
    "python_function",
    "save",
    "save_system",
    "shipped_cases",
    "staged",
]
