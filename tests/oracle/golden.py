#!/usr/bin/env python3
"""Makes golden.json: points of patches by a program that shares nothing with the others, 80 digits of each number.

    python3 tests/oracle/golden.py > tests/oracle/golden.json   # needs mpmath

The equations are the paper's as printed, with the readings that docs/method.md tells. Every derivative is a central
difference at 80 digits, so that no closed form of one is shared either. The normals of the file, which are doubles, are
made unit vectors here, and so they must be where the file is read.
"""
import json
import random

from mpmath import cos, matrix, mp, mpf, pi, sin, sqrt

mp.dps = 80
STEP = mpf(10) ** -20  # its square is what a difference is off by; three nested ones leave 20 digits


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return matrix([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def unit(a):
    return a / sqrt(dot(a, a))


def slope(f, t):
    return (f(t + STEP) - f(t - STEP)) / (2 * STEP)


class Patch:
    def __init__(self, positions, normals):
        self.n = len(positions)
        self.positions = [matrix(p) for p in positions]
        self.normals = [unit(matrix(m)) for m in normals]

    def vertex(self, k):
        return self.positions[k % self.n]

    def normal(self, k):
        return self.normals[k % self.n]

    def length(self, k):
        e = self.vertex(k + 1) - self.vertex(k)
        return sqrt(dot(e, e))

    def C(self, k, t):
        """(6) with (7) to (9): the cubic Hermite curve of side k."""
        e = self.vertex(k + 1) - self.vertex(k)
        across = cross(e, (self.normal(k) + self.normal(k + 1)) / 2)
        t_s = self.length(k) * unit(cross(self.normal(k), across))
        t_e = self.length(k) * unit(cross(self.normal(k + 1), across))
        return ((2 * t**3 - 3 * t**2 + 1) * self.vertex(k) + (-2 * t**3 + 3 * t**2) * self.vertex(k + 1)
                + (t**3 - 2 * t**2 + t) * t_s + (t**3 - t**2) * t_e)

    def T(self, k, t):
        """(10) to (14): the cross tangent of side k, into the patch."""
        e = self.vertex(k + 1) - self.vertex(k)
        between = (1 - t) * self.normal(k) + t * self.normal(k + 1)
        n_c = unit(cross(slope(lambda s: self.C(k, s), t), cross(between, e)))
        v_int = (1 - t) * self.vertex(k - 1) + t * self.vertex(k + 2) - self.C(k, t)
        n_int = ((1 - t) * self.normal(k - 1) + t * self.normal(k + 2) + n_c) / 2
        return ((1 - t) * self.length(k - 1) + t * self.length(k + 1)) * unit(cross(n_c, cross(v_int, n_int)))

    def corner(self, k, u, v):
        """(2): the Gregory corner interpolator."""
        twist = u * v * (v * slope(lambda t: self.T(k, t), 0) - u * slope(lambda t: self.T(k - 1, t), 1)) / (u + v)
        return (-self.vertex(k) - v * self.T(k, 0) - u * self.T(k - 1, 1) + self.C(k, u) + v * self.T(k, u)
                + self.C(k - 1, 1 - v) + u * self.T(k - 1, 1 - v) - twist)

    def G(self, xi, eta):
        """(3) to (5), off the corners of the domain."""
        n = self.n
        d = [cos(pi / n) - cos((2 * k + 1) * pi / n) * xi - sin((2 * k + 1) * pi / n) * eta for k in range(n)]
        total, point = mpf(0), matrix([0, 0, 0])
        for k in range(n):
            w = mpf(1)
            for j in range(n):
                if j not in (k, (k - 1) % n):
                    w *= d[j] ** 2
            u = d[k - 1] / (d[k - 1] + d[(k + 1) % n])
            v = d[k] / (d[k - 2] + d[k])
            point += w * self.corner(k, u, v)
            total += w
        return point / total


def random_patch(rng, n, tilt):
    """A polygon that is almost regular, turned and moved; its normals within `tilt` of its axis, as numbers of double."""
    def random_unit():
        while True:
            a = [rng.uniform(-1, 1) for _ in range(3)]
            if 0.01 < sum(x * x for x in a) < 1:
                return unit(matrix(a))
    axis = random_unit()
    x = unit(cross(axis, random_unit()))
    y = cross(axis, x)
    middle = [rng.uniform(-1, 1) for _ in range(3)]
    jitter = min(0.2, 1.2 / n)
    positions, normals = [], []
    for k in range(n):
        a, b, c = (rng.uniform(-jitter, jitter) for _ in range(3))
        p = matrix(middle) + (cos(2 * pi * k / n) + a) * x + (sin(2 * pi * k / n) + b) * y + c * axis
        positions.append([float(value) for value in p])
        normals.append([float(value) for value in unit(axis + rng.uniform(0, tilt) * random_unit())])
    return positions, normals


def numbers(vector):
    return [float(value) for value in vector]


def golden(rng, n, tilt):
    positions, normals = random_patch(rng, n, tilt)
    patch = Patch(positions, normals)
    points = [(0.0, 0.0)]
    for _ in range(4):  # anywhere, and close to a side
        k, t, r = rng.randrange(n), rng.random(), rng.choice([0.3, 0.8, 0.999])
        a, b = 2 * pi * k / n, 2 * pi * (k + 1) / n
        points.append((float(r * ((1 - t) * cos(a) + t * cos(b))), float(r * ((1 - t) * sin(a) + t * sin(b)))))
    result = {"n": n, "positions": positions, "normals": normals, "xi_eta": points,
              "G": [], "G_xi": [], "G_eta": [], "normal": [], "t": [0.0, 0.25, 0.7, 1.0], "edges": []}
    for xi, eta in points:
        xi, eta = mpf(xi), mpf(eta)
        along_xi = slope(lambda s: patch.G(s, eta), xi)
        along_eta = slope(lambda s: patch.G(xi, s), eta)
        result["G"].append(numbers(patch.G(xi, eta)))
        result["G_xi"].append(numbers(along_xi))
        result["G_eta"].append(numbers(along_eta))
        result["normal"].append(numbers(unit(cross(along_xi, along_eta))))
    for k in range(n):
        edge = {"C": [], "dC": [], "T": [], "dT": []}
        for t in map(mpf, result["t"]):
            for name, value in (("C", patch.C(k, t)), ("dC", slope(lambda s: patch.C(k, s), t)),
                                ("T", patch.T(k, t)), ("dT", slope(lambda s: patch.T(k, s), t))):
                edge[name].append(numbers(value))
        result["edges"].append(edge)
    return result


def main():
    rng = random.Random(2016)
    patches = [golden(rng, n, tilt) for n, tilt in ((3, 0.5), (3, 0.2), (4, 0.5), (4, 0.1), (5, 0.5), (6, 0.4), (8, 0.4), (13, 0.3))]
    note = "made by tests/oracle/golden.py, which says how to read it"
    print('{"note": "%s", "patches": [\n%s\n]}' % (note, ",\n".join(map(json.dumps, patches))))


if __name__ == "__main__":
    main()
