"""Which packages there are: found, so that a new room cannot be forgotten. All else is in pyproject.toml."""

from setuptools import find_packages, setup

ROOMS = ["periodic", "plate", "beam", "reduction", "perturb", "floquet", "compare", "floquet_charts"]

setup(
    # The folders scripts/, cases/ and examples/ would be too general as names of installed packages.
    package_dir={"floquet_scripts": "scripts", "floquet_cases": "cases", "floquet_examples": "examples"},
    packages=[
        "floquet_scripts",
        "floquet_cases",
        "floquet_examples",
        *(f"floquet_examples.{problem}" for problem in find_packages("examples")),
        *find_packages(include=[*ROOMS, *(f"{room}.*" for room in ROOMS)]),
    ],
)
