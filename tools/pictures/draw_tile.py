"""A tile: where it lies in the domain, what is kept of it in space, when a search leaves it out, and its words."""
import math

from canvas import Canvas

SIDES, LEVELS = 4, 2
MARKED = 3  # the tile that is shown in space: of fan 0, row 1


def corner(k):
    return math.cos(2 * math.pi * k / SIDES), math.sin(2 * math.pi * k / SIDES)


def point(fan, ring, along):
    """A point of the lattice that tiles are cut by: on a ring about the centre, so far along it (kernels/tile.h)."""
    (a, b), (c, d) = corner(fan), corner(fan + 1)
    u, v = (ring - along) / LEVELS, along / LEVELS
    return u * a + v * c, u * b + v * d


def tiles():
    """Of each tile, in the order of the cache, its three corners."""
    for fan in range(SIDES):
        for row in range(LEVELS):
            for j in range(2 * row + 1):
                i = j // 2
                yield ([point(fan, row, i), point(fan, row + 1, i), point(fan, row + 1, i + 1)] if j % 2 == 0 else
                       [point(fan, row, i), point(fan, row, i + 1), point(fan, row + 1, i + 1)])


def draw_domain(canvas, middle, size):
    def at(p):
        return middle[0] + size * p[0], middle[1] - size * p[1]

    all_tiles = list(tiles())
    canvas.path([at(p) for p in all_tiles[MARKED]], "fill", closed=True)
    for tile in all_tiles:
        canvas.path([at(p) for p in tile], "grey", 1, closed=True)
    canvas.path([at(corner(k)) for k in range(SIDES)], "blue", 2, closed=True)
    for i, tile in enumerate(all_tiles[:LEVELS * LEVELS]):
        x, y = at([sum(p[c] for p in tile) / 3 for c in (0, 1)])
        canvas.text(x, y + 4, str(i), "small", "middle")
    for k, (dx, dy, anchor) in enumerate([(8, 4, "start"), (0, -8, "middle"), (-8, 4, "end"), (0, 18, "middle")]):
        x, y = at(corner(k))
        canvas.text(x + dx, y + dy, f"corner {k}" if k % 2 else str(k), "small", anchor)
    canvas.text(middle[0] + size * 0.62, middle[1] - size * 0.58, "side 0", "small")


class Piece:
    """The tile from aside: an arc with its cylinder, about a place."""

    def __init__(self, middle, radius, turn, slack):
        self.middle, self.turn, self.slack = middle, turn, slack
        self.radius = radius
        self.half = radius * (1 - math.cos(turn)) / 2

    def at(self, angle, out=0.0):
        """The point of the arc at an angle, moved out along its normal."""
        r = self.radius + out
        return (self.middle[0] + r * math.sin(angle),
                self.middle[1] - self.half + self.radius - r * math.cos(angle))

    def draw(self, canvas):
        wide, high = self.radius * math.sin(self.turn) + self.slack, self.half + self.slack
        x, y = self.middle
        canvas.box(x - wide, y - high, 2 * wide, 2 * high, "grey", dashed=True)
        canvas.parts[-1] = canvas.parts[-1].replace("/>", ' fill="none"/>')
        canvas.path([self.at(self.turn * i / 12) for i in range(-12, 13)], "blue", 2.5)


def draw_space(canvas, source, middle):
    most = source.find("host/build/patch_tiles.cpp", r"kMostTurn = ([\d.]+);")
    piece = Piece(middle, 560, float(most), 12)
    piece.draw(canvas)
    x, y = middle
    for step in (-1, -0.5, 0.5, 1):
        canvas.arrow([piece.at(step * piece.turn), piece.at(step * piece.turn, 62)], "grey", 1)
    canvas.arrow([(x, y), (x, y - 96)], "blue")
    canvas.dot(middle, "blue")
    wide, high = 560 * math.sin(piece.turn) + 12, piece.half + 12
    canvas.text(x + 8, y - 88, "axis: mean normal", "blue-text")
    canvas.text(x + 6, y + 13, "centre", "blue-text small")
    canvas.text(x + wide + 30, y - 62, [f"normals lean at most {most} rad", "where that can be had"], "small")
    canvas.arrow([(x, y + high + 14), (x + wide, y + high + 14)], "grey", 1)
    canvas.text(x + wide, y + high + 30, "radius", "small", "end")
    canvas.arrow([(x + wide + 14, y), (x + wide + 14, y - high)], "grey", 1)
    canvas.text(x + wide + 24, y - 4, "half the height", "small")
    canvas.text(x - wide, y + high + 30, "surface, in its flat cylinder", "blue-text small")


def draw_reasons(canvas, top):
    """Why a search leaves a tile out: three small pictures."""
    middles = [(140, top + 104), (446, top + 104)]
    pieces = [Piece(middle, 340, 0.2, 7) for middle in middles]
    for piece in pieces:
        piece.draw(canvas)

    canvas.text(30, top, "Left out: too far", "title")
    hip = (90, top + 50)
    canvas.dot(hip, "red", 4)
    canvas.ring(hip, 34, "red", 1, dashed=True)
    canvas.text(hip[0] + 40, hip[1] - 8, ["HIP, and the nearest", "point known so far"], "red-text small")
    canvas.dot((hip[0] - 33, hip[1] + 8), "red", 3)

    canvas.text(310, top, "Left out: no normal leads to the HIP", "title")
    piece = pieces[1]
    for sign in (-1, 1):
        canvas.path([piece.at(sign * piece.turn, -40), piece.at(sign * piece.turn, 76)], "grey", 1, dashed=True)
    canvas.path([piece.at(-piece.turn, -40), piece.at(-piece.turn, 76), piece.at(piece.turn, 76),
                 piece.at(piece.turn, -40)], "fill", closed=True)
    hip = (554, top + 78)
    canvas.dot(hip, "red", 4)
    canvas.text(hip[0] + 2, hip[1] - 10, "HIP", "red-text small", "middle")
    canvas.text(356, top + 44, ["normals,", "both ways"], "small", "end")

    canvas.text(632, top, "Left out: leads to a known minimum", "title")
    left, right, low, high = 640, 866, top + 122, top + 32
    canvas.path([(left, high), (left, low), (right, low)], "grey", 1)
    curve = [(left + 30 + 1.7 * i, low - 14 - 0.0070 * (i - 20) ** 2) for i in range(0, 101, 4)]
    canvas.path(curve, "blue", 2)
    canvas.dot((left + 30 + 34, low - 14), "red", 4)
    canvas.text(left + 64, low - 24, "minimum", "red-text small", "middle")
    canvas.dot(curve[-4], "blue", 4)
    canvas.text(curve[-4][0] - 8, curve[-4][1] - 8, "middle of the tile", "blue-text small", "end")
    canvas.text(left + 6, high + 4, "distance\u00b2 is convex between", "small")
    canvas.text(right, low + 16, "way in the domain", "small", "end")


# [word]: its name, and its fields from bit 0 up: bits and what they hold.
WORDS = (
    ("TILE_CENTRE_XY", ((16, "centre x"), (16, "centre y"))),
    ("TILE_CENTRE_Z_RADIUS", ((16, "centre z"), (16, "radius"))),
    ("TILE_AXIS", ((12, "axis x"), (12, "axis y"), (7, "lean"), (1, ""))),
    ("TILE_HALF_CURVES", ((16, "half the height"), (8, "least"), (8, "largest"))),
    ("TILE_SECOND_FORM", ((9, "n\u00b7G xi xi"), (9, "n\u00b7G xi eta"), (9, "n\u00b7G eta eta"), (5, "scale"))),
)


def draw_words(canvas, source, top):
    bit, left = 15.5, 196
    count = int(source.number("kernels/layout.h", "TILE_UINTS"))
    assert count == len(WORDS)
    canvas.text(30, top - 10, f"What the cache keeps of it: {count} words of 32 bits, {4 * count} bytes", "title")
    for row, (name, fields) in enumerate(WORDS):
        y, x = top + 25 * row, left
        canvas.text(left - 12, y + 15, source.name("kernels/layout.h", name), "code", "end")
        assert source.number("kernels/layout.h", name) == row and sum(bits for bits, _ in fields) == 32
        for bits, words in fields:
            canvas.box(x, y, bit * bits, 21)
            canvas.text(x + bit * bits / 2, y + 15, words, "small", "middle")
            x += bit * bits
    right = left + 32 * bit + 12
    canvas.text(right, top + 57, ["lean of normals, from the", "axis or from how it curves;"], "small")
    canvas.text(right, top + 92, ["least, largest curvature;", "second fundamental form"], "small")


def draw(source):
    most = int(source.number("host/build/tile_cuts.cpp", "kMostTiles"))
    levels = [level for level in (1, 2, 4, 8) if SIDES * level * level <= most]
    canvas = Canvas("A tile of a patch", 900, 640)
    canvas.text(30, 26, "In the domain of a quad", "title")
    draw_domain(canvas, (150, 150), 100)
    canvas.text(30, 284, [f"Fans from the centre to the sides, in {levels[1]} rows: {SIDES * levels[1] ** 2} tiles.",
                          f"Others have {', '.join(str(SIDES * level ** 2) for level in levels[:-1] if level != 2)} "
                          f"or {SIDES * levels[-1] ** 2}, by how the normals turn."], "small")
    canvas.text(390, 26, "In space, along the frame of the patch", "title")
    draw_space(canvas, source, (540, 172))
    draw_reasons(canvas, 334)
    draw_words(canvas, source, 506)
    return canvas.svg()
