"""A plate and a moving web from finite elements, as sparse files: ten thousand or a hundred thousand coordinates.

    python examples/finite_element_plate.py plate            # 99,856 coordinates, a folder of .npz files
    floquet-charts explore --system plate --Omega 30 120 --eps 20 --html

    python examples/finite_element_plate.py web --elements 50 --speed 2    # 10,200 coordinates, gyroscopic

The plate is square and simply supported, its exact frequencies are pi^2 (m^2 + k^2); the web is supported at its two
ends and free at its sides, as in the paper of Young, Huang and Chiu. Elements are conforming rectangles of Bogner, Fox
and Schmit: products of cubic Hermite polynomials, so that all matrices are Kronecker products of those of beams. The
tension N_xx pulsates as eps cos(Omega t), most at mid-height. Lengths by the width b, time by sqrt(rho h b^4 / D).
"""

import argparse
from pathlib import Path

import numpy as np
import scipy.sparse as sp

POISSON = 0.3


def beams(elements):
    """(u, v), (u', v'), (u'', v''), (u, v'') and (u, v') of cubic elements over a unit length, ends free."""
    x, weights = np.polynomial.legendre.leggauss(4)
    x, weights, h = (x + 1) / 2, weights / 2, 1 / elements
    N = np.array([1 - 3 * x**2 + 2 * x**3, h * (x - 2 * x**2 + x**3), 3 * x**2 - 2 * x**3, h * (x**3 - x**2)])
    D = np.array([-6 * x + 6 * x**2, h * (1 - 4 * x + 3 * x**2), 6 * x - 6 * x**2, h * (3 * x**2 - 2 * x)]) / h
    B = np.array([-6 + 12 * x, h * (-4 + 6 * x), 6 - 12 * x, h * (6 * x - 2)]) / h**2
    middle = np.sin(np.pi * (np.arange(elements)[:, None] + x) * h)  # the load's distribution

    def whole(u, v, load=None):
        factor = np.ones((elements, len(x))) if load is None else load
        e = h * np.einsum("ax,bx,x,ex->eab", u, v, weights, factor)
        i = np.broadcast_to(2 * np.arange(elements)[:, None, None] + np.arange(4)[:, None], e.shape)
        return sp.coo_array((e.ravel(), (i.ravel(), i.transpose(0, 2, 1).ravel()))).tocsr()

    return {
        "00": whole(N, N),
        "11": whole(D, D),
        "22": whole(B, B),
        "02": whole(N, B),
        "01": whole(N, D),
        "load": whole(N, N, middle),
    }


def held(matrix):
    """The matrix without the displacements of the two ends."""
    free = np.setdiff1d(np.arange(matrix.shape[0]), [0, matrix.shape[0] - 2])
    return matrix[free][:, free]


def plate(elements, *, free_sides=False, speed=0.0, tension=0.0):
    """Return the matrices of a square plate by their names in files."""
    x = {name: held(matrix) for name, matrix in beams(elements).items()}
    y = beams(elements) if free_sides else x
    bending = (
        sp.kron(x["22"], y["00"])
        + sp.kron(x["00"], y["22"])
        + POISSON * (sp.kron(x["02"], y["02"].T) + sp.kron(x["02"].T, y["02"]))
        + 2 * (1 - POISSON) * sp.kron(x["11"], y["11"])
    )
    slope = sp.kron(x["11"], y["00"])
    matrices = {
        "M": sp.kron(x["00"], y["00"]),
        "K": bending + (tension - speed**2) * slope,
        "K1c": sp.kron(x["11"], y["load"]),
    }
    if speed:
        matrices["G"] = speed * sp.kron(x["01"] - x["01"].T, y["00"])
    return {name: matrix.tocsr() for name, matrix in matrices.items()}


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, help="where to write; 'web' in its name makes the moving web")
    parser.add_argument("--elements", type=int, default=158, help="along each side (158)")
    parser.add_argument("--speed", type=float, default=0.0, help="transport speed of the web (0)")
    options = parser.parse_args()
    web = "web" in options.folder.name
    matrices = plate(options.elements, free_sides=web, speed=options.speed, tension=10.0 if web else 0.0)
    options.folder.mkdir(parents=True, exist_ok=True)
    for name, matrix in matrices.items():
        sp.save_npz(options.folder / f"{name}.npz", matrix)
    print(f"{options.folder}: {', '.join(matrices)}, {matrices['M'].shape[0]} coordinates")
