"""Parts as CAD has them, for benches: points and faces. The named ones, and random ones of ten kinds."""

import math
import random


def prism(outline, height):
    """An extruded polygon, anticlockwise."""
    n = len(outline)
    faces = [list(range(n))[::-1], list(range(n, 2 * n))]
    faces += [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    return [(x, y, z) for z in (0, height) for x, y in outline], faces


def ring(radius, sides):
    return [(radius * math.cos(2 * math.pi * k / sides), radius * math.sin(2 * math.pi * k / sides)) for k in range(sides)]


def slab(length, width, height, radius, rim, corner):
    """A slab with round corners and a half round rim in triangles, as CAD exports it: long strips beside fine arcs."""
    around, points, faces = 4 * (corner + 1), [], []
    for i in range(rim + 1):
        up = math.pi * (i / rim - 0.5)
        out = radius - height / 2 * (1 - math.cos(up))
        for k in range(around):
            quarter, step = divmod(k, corner + 1)
            turn = math.pi / 2 * (quarter + step / corner)
            points.append(((length / 2 - radius) * (1 if quarter in (0, 3) else -1) + out * math.cos(turn),
                           (width / 2 - radius) * (1 if quarter < 2 else -1) + out * math.sin(turn), height / 2 * math.sin(up)))
    for i in range(rim):
        for k in range(around):
            a, b, c, d = (r * around + j % around for r, j in ((i, k), (i, k + 1), (i + 1, k + 1), (i + 1, k)))
            faces += [[a, b, c], [a, c, d]]
    for cap in (list(range(around))[::-1], range(rim * around, (rim + 1) * around)):
        faces += [[cap[0], cap[k], cap[k + 1]] for k in range(1, around - 1)]
    return points, faces


def frustum(outline, height, narrow):
    """An extruded polygon, one end of which is smaller."""
    points, faces = prism(outline, height)
    n = len(outline)
    return [(x * narrow, y * narrow, z) if i >= n else (x, y, z) for i, (x, y, z) in enumerate(points)], faces


def turned(profile, sides, closed):
    """A profile of (radius, z) turned round the axis; closed, or from the axis to the axis."""
    points, rings, faces = [], [], []
    for radius, z in profile:
        first = len(points)
        rings.append([first + (k if radius else 0) for k in range(sides)])
        points += [(radius * math.cos(2 * math.pi * k / sides), radius * math.sin(2 * math.pi * k / sides), z)
                   for k in range(sides if radius else 1)]
    for low, high in zip(rings, rings[1:] + rings[:1] if closed else rings[1:]):
        for k in range(sides):
            face = list(dict.fromkeys((low[k], low[(k + 1) % sides], high[(k + 1) % sides], high[k])))
            faces += [face] if len(face) > 2 else []
    return points, faces


def spiral(count, turns, thick, height):
    """A wound band: four rows of points, and the walls between them."""
    steps = [turns * i / (count - 1) for i in range(count)]
    points = [((5 + out + 4 * t) * math.cos(2 * math.pi * t), (5 + out + 4 * t) * math.sin(2 * math.pi * t), z)
              for z in (0, height) for out in (thick, 0) for t in steps]
    rows = (0, count, 3 * count, 2 * count)  # outside, inside, inside and outside above
    faces = [[a + i, b + i, b + i + 1, a + i + 1] for a, b in zip(rows, rows[1:] + rows[:1]) for i in range(count - 1)]
    return points, faces + [[row + count - 1 for row in rows], [row for row in rows][::-1]]


def star(draw, points):
    """An outline."""
    return [(radius * math.cos(math.pi * k / points), radius * math.sin(math.pi * k / points))
            for k in range(2 * points) for radius in [20 if k % 2 else 20 * draw.uniform(0.25, 0.8)]]


def comb(teeth):
    """An outline whose gaps end on one line."""
    wide = 40 / (2 * teeth - 1)
    feet = [(x * wide, y) for k in range(teeth)
            for x, y in [(2 * k, 0), (2 * k + 1, 0)] + [(2 * k + 1, 15), (2 * k + 2, 15)] * (k + 1 < teeth)]
    return [(40, 20), (0, 20)] + feet


def random_part(kind, draw):
    thick, height = draw.uniform(1, 6), 10 ** draw.uniform(-0.7, 1.5)
    if kind == "star":
        return frustum(star(draw, draw.randint(3, 9)), height, draw.uniform(0.3, 1))
    if kind == "frustum":
        flat = draw.uniform(0.4, 1)
        return frustum([(20 * x, 20 * flat * y) for x, y in ring(1, draw.randint(3, 8))], height, draw.uniform(0.1, 0.95))
    if kind == "bracket":
        return prism([(0, 0), (40, 0), (40, thick), (thick, thick), (thick, 30), (0, 30)], height)
    if kind == "channel":
        return prism([(0, 0), (40, 0), (40, 30), (40 - thick, 30), (40 - thick, thick), (thick, thick), (thick, 30), (0, 30)],
                     height)
    if kind == "comb":
        return prism(comb(draw.randint(3, 9)), height)
    if kind == "tube":
        out = draw.uniform(5, 20)
        inner = out * draw.uniform(0.3, 0.97)
        return turned([(out, 0), (out, height), (inner, height), (inner, 0)], draw.randint(6, 40), True)
    if kind == "vase":
        steps = draw.randint(3, 6)
        return turned([(0, 0)] + [(draw.uniform(2, 15), 20 * (k + 1) / (steps + 1)) for k in range(steps)] + [(0, 20)],
                      draw.randint(5, 40), False)
    if kind == "disc":
        return turned([(0, 0), (15, 0), (15, height), (0, height)], draw.randint(3, 40), False)
    if kind == "torus":
        across = draw.uniform(1, 9)
        return turned([(12 + x, y * draw.uniform(0.5, 1)) for x, y in ring(across, draw.randint(5, 16))], draw.randint(8, 30),
                      True)
    return spiral(draw.randint(20, 60), draw.uniform(1, 2.5), draw.uniform(0.3, 2), draw.uniform(3, 20))


KINDS = ("star", "frustum", "bracket", "channel", "comb", "tube", "vase", "disc", "torus", "spiral")


def random_parts(count, seed):
    """Yields a name, points and faces, of each kind in turn, in any position."""
    for i in range(count):
        draw = random.Random(f"{seed} {i}")
        points, faces = random_part(KINDS[i % len(KINDS)], draw)
        x, y, z = (draw.gauss(0, 1) for _ in range(3))
        w = draw.gauss(0, 1)
        size = math.hypot(w, x, y, z)
        w, x, y, z = w / size, x / size, y / size, z / size
        rows = ((1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
                (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
                (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)))
        yield f"{KINDS[i % len(KINDS)]} {i}", [tuple(sum(a * b for a, b in zip(row, p)) for row in rows) for p in points], faces


PARTS = {"plate 40 x 40 x 0.2": prism([(0, 0), (40, 0), (40, 40), (0, 40)], 0.2),
         "needle 1 x 100": prism(ring(0.5, 12), 100),
         "bracket": prism([(0, 0), (40, 0), (40, 4), (4, 4), (4, 40), (0, 40)], 20), "nut": prism(ring(10, 6), 8),
         "cylinder": prism(ring(10, 24), 60), "round slab 203 x 305 x 12.7": slab(203.2, 304.8, 12.7, 25.4, 12, 6),
         "round bar 20 x 300 x 4": slab(20, 300, 4, 4, 6, 3)}
