"""Which packages there are: found, so that a new room cannot be forgotten. All else is in pyproject.toml."""

from setuptools import find_packages, setup

ROOMS = ["periodic", "plate", "beam", "reduction", "perturb", "floquet", "compare", "floquet_charts"]

setup(
    # The folders scripts/ and cases/ would be too general as names of installed packages.
    package_dir={"floquet_scripts": "scripts", "floquet_cases": "cases"},
    packages=[
        "floquet_scripts",
        "floquet_cases",
        *find_packages(include=[*ROOMS, *(f"{room}.*" for room in ROOMS)]),
    ],
)
