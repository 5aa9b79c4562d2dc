"""Writes svk_fibre_body.csv: a St Venant-Kirchhoff solid with fibres, in plain Python.

The stress is C : E with the full fourth-order stiffness, which is the inverse of the compliance in Voigt's
notation, turned into the direction of each tetrahedron; no invariants of the fibre are used.
python3 data/reference_solutions/svk_fibre.py
"""
import math
from itertools import product
from pathlib import Path

FOLDER = Path(__file__).parent
E_L, E_T, NU_LT, NU_TT, G_LT = 9e4, 3e4, 0.4, 0.35, 2e4
BODY_FORCE = (0.0, 0.0, -8000.0)  # [N/m³]
VOIGT = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
R3 = range(3)


def direction(x):  # of the fibre, not of unit length
    return (1.0, 10 * x[0], 50 * x[2])


def solve(matrix, right):
    """Gaussian elimination with partial pivoting."""
    n = len(matrix)
    rows = [row[:] + [b] for row, b in zip(matrix, right)]
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        top = rows[k]
        for i in range(k + 1, n):
            if factor := rows[i][k] / top[k]:
                row = rows[i]
                rows[i] = row[:k] + [a - factor * b for a, b in zip(row[k:], top[k:])]
    x = [0.0] * n
    for k in reversed(range(n)):
        x[k] = (rows[k][n] - sum(rows[k][j] * x[j] for j in range(k + 1, n))) / rows[k][k]
    return x


def inverse(matrix):
    n = len(matrix)
    columns = [solve(matrix, [float(i == j) for i in range(n)]) for j in range(n)]
    return [[columns[j][i] for j in range(n)] for i in range(n)]


def stiffness_along_x():
    """C[i][j][k][l] of a fibre along x."""
    shear = [2 * (1 + NU_TT) / E_T, 1 / G_LT, 1 / G_LT]
    compliance = [[0.0] * 6 for _ in range(6)]
    compliance[0][:3] = [1 / E_L, -NU_LT / E_L, -NU_LT / E_L]
    compliance[1][:3] = [-NU_LT / E_L, 1 / E_T, -NU_TT / E_T]
    compliance[2][:3] = [-NU_LT / E_L, -NU_TT / E_T, 1 / E_T]
    for i in R3:
        compliance[3 + i][3 + i] = shear[i]
    voigt = inverse(compliance)
    row = {pair: i for i, (a, b) in enumerate(VOIGT) for pair in ((a, b), (b, a))}
    return {(i, j, k, l): voigt[row[i, j]][row[k, l]] for i, j, k, l in product(R3, repeat=4)}


def turned(C, a):
    """With the x axis of C along a."""
    length = math.sqrt(sum(x * x for x in a))
    e = [x / length for x in a]
    other = [0.0, 0.0, 1.0] if abs(e[2]) < 0.9 else [1.0, 0.0, 0.0]
    f = cross(e, other)
    length = math.sqrt(sum(x * x for x in f))
    f = [x / length for x in f]
    Q = [e, f, cross(e, f)]  # rows: the material's axes
    for axis in range(4):  # one index at a time
        turned_one = {}
        for index in product(R3, repeat=4):
            turned_one[index] = sum(Q[p][index[axis]] * C[index[:axis] + (p,) + index[axis + 1:]] for p in R3)
        C = turned_one
    return C


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def read_mesh():
    lines = (FOLDER / "beam_coarse.msh").read_text().split("\n")
    at = lines.index("$Nodes")
    points = [[float(x) for x in line.split()[1:]] for line in lines[at + 2 : at + 2 + int(lines[at + 1])]]
    at = lines.index("$Elements")
    rows = [[int(x) for x in line.split()] for line in lines[at + 2 : at + 2 + int(lines[at + 1])]]
    return points, [[v - 1 for v in row[-4:]] for row in rows if row[1] == 4]


class Tet:
    def __init__(self, corners, points, C):
        self.corners = corners
        x0 = points[corners[0]]
        edges = [[points[v][i] - x0[i] for i in R3] for v in corners[1:]]
        rows = inverse(edges)  # columns: the gradients of corners 1, 2, 3
        gradients = [[rows[i][c] for i in R3] for c in R3]
        self.gradients = [[-sum(g[i] for g in gradients) for i in R3]] + gradients
        self.volume = abs(sum(a * b for a, b in zip(edges[0], cross(edges[1], edges[2])))) / 6
        middle = [sum(points[v][i] for v in corners) / 4 for i in R3]
        self.C = turned(C, direction(middle))

    def forces_and_stiffness(self, u):
        g = self.gradients
        F = [[float(i == j) + sum(u[v][i] * g[c][j] for c, v in enumerate(self.corners)) for j in R3] for i in R3]
        E = [[(sum(F[k][i] * F[k][j] for k in R3) - (i == j)) / 2 for j in R3] for i in R3]
        C, V = self.C, self.volume
        S = [[sum(C[i, j, k, l] * E[k][l] for k in R3 for l in R3) for j in R3] for i in R3]
        P = [[sum(F[i][k] * S[k][j] for k in R3) for j in R3] for i in R3]
        force = [[-V * sum(P[i][j] * a[j] for j in R3) for i in R3] for a in g]
        K = {}
        for a, b in product(range(4), repeat=2):
            inner = [
                [sum(C[i, j, k, l] * g[a][j] * g[b][k] for j in R3 for k in R3) for l in R3] for i in R3
            ]  # B_il = C_ijkl a_j b_k
            geometric = sum(g[a][i] * S[i][j] * g[b][j] for i in R3 for j in R3)
            for p, q in product(R3, repeat=2):
                material = sum(F[p][i] * inner[i][l] * F[q][l] for i in R3 for l in R3)
                K[a, p, b, q] = V * (material + (geometric if p == q else 0.0))
        return force, K


def equilibrium(points, tets, held, share, u):
    """Newton's method for a share of the load, from u."""
    free = [v for v in range(len(points)) if v not in held]
    place = {(v, i): 3 * n + i for n, v in enumerate(free) for i in R3}
    for _ in range(30):
        residual = [0.0] * len(place)
        matrix = [[0.0] * len(place) for _ in place]
        for tet in tets:
            force, K = tet.forces_and_stiffness(u)
            for a, i in product(range(4), R3):
                row = place.get((tet.corners[a], i))
                if row is None:
                    continue
                residual[row] += force[a][i] + share * BODY_FORCE[i] * tet.volume / 4
                for b, j in product(range(4), R3):
                    column = place.get((tet.corners[b], j))
                    if column is not None:
                        matrix[row][column] += K[a, i, b, j]
        step = solve(matrix, residual)
        for (v, i), at in place.items():
            u[v][i] += step[at]
        size = max(abs(x) for x in step)
        print(f"share {share:4.2f}, step {size:.2e} m", flush=True)
        if size < 1e-13:
            return
    raise SystemExit("no equilibrium was found")


def main():
    points, corners = read_mesh()
    C = stiffness_along_x()
    tets = [Tet(c, points, C) for c in corners]
    held = {v for v, x in enumerate(points) if x[0] == 0}
    u = [[0.0] * 3 for _ in points]
    for share in (0.25, 0.5, 0.75, 1.0):
        equilibrium(points, tets, held, share, u)
    lines = ["ux_m,uy_m,uz_m"] + [",".join(repr(x) for x in row) for row in u]
    (FOLDER / "svk_fibre_body.csv").write_text("\n".join(lines) + "\n")


main()
