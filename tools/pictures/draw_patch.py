"""The life of a patch: from a polygon to the cache, and what a search does with it."""
import math

import draw_tile
from canvas import Canvas

WIDTH, HEIGHT = 280, 132
COLUMNS, ROWS = (20, 310, 600), (16, 186, 356, 526)


class Thumbnail:
    """A quad seen from above and aside, and its patch; points are (u, v), each from 0 to 1."""

    def __init__(self, canvas, middle, size=58, bulge=0.24):
        self.canvas, self.middle, self.size, self.bulge = canvas, middle, size, bulge

    def at(self, u, v, flat=False, up=0.0):
        x, y = u - 0.5, v - 0.5
        height = up + (0 if flat else self.bulge * (1 - 2 * x * x - 2 * y * y))
        cos, sin = math.cos(0.55), math.sin(0.55)
        return (self.middle[0] + self.size * (x * cos + y * sin),
                self.middle[1] + self.size * (0.75 * (x * sin - y * cos) - height) + 6)

    def line(self, begin, end, style="blue", width=1.5, flat=False, dashed=False):
        count = 1 if flat else 12
        points = [(begin[0] + (end[0] - begin[0]) * i / count, begin[1] + (end[1] - begin[1]) * i / count)
                  for i in range(count + 1)]
        self.canvas.path([self.at(*p, flat=flat) for p in points], style, width, dashed)

    def outline(self, style="blue", width=1.8, flat=False, dashed=False):
        corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
        for a, b in zip(corners, corners[1:] + corners[:1]):
            self.line(a, b, style, width, flat, dashed)

    def grid(self):
        self.outline()
        for t in (0.25, 0.5, 0.75):
            self.line((t, 0), (t, 1), "blue", 0.8)
            self.line((0, t), (1, t), "blue", 0.8)

    def tile(self, corners):
        return [self.at((1 + xi - eta) / 2, (1 + xi + eta) / 2) for xi, eta in corners]

    def tiles(self, filled=()):
        for i, corners in enumerate(draw_tile.tiles()):
            if i in filled:
                self.canvas.path(self.tile(corners), "fill", closed=True)
            for a, b in zip(corners, corners[1:] + corners[:1]):
                self.canvas.path(self.tile([(a[0] + (b[0] - a[0]) * j / 4, a[1] + (b[1] - a[1]) * j / 4)
                                            for j in range(5)]), "blue", 0.8)
        self.outline()


def draw_mesh(t):
    for u in (0, 0.5, 1):
        t.line((u, 0), (u, 1), flat=True)
        t.line((0, u), (1, u), flat=True)


def draw_normals(t):
    t.outline("blue", 1.5, flat=True)
    t.line((0, 0), (1, 0), "red", 2.5, flat=True)
    for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
        t.canvas.arrow([t.at(u, v, flat=True), t.at(u + 0.15 * (u - 0.5), v + 0.15 * (v - 0.5), flat=True, up=0.3)],
                       "grey", 1.2)


def draw_sides(t):
    t.outline()
    t.outline("grey", 1, flat=True, dashed=True)
    for begin, inner in (((0.5, 0), (0.5, 0.3)), ((1, 0.5), (0.7, 0.5)), ((0.5, 1), (0.5, 0.7)),
                         ((0, 0.5), (0.3, 0.5))):
        t.canvas.arrow([t.at(*begin), t.at(*inner)], "red", 1.3)


def draw_probes(t):
    t.outline()
    rings = 4
    for fan in range(4):
        (a, b), (c, d) = draw_tile.corner(fan), draw_tile.corner(fan + 1)
        for ring in range(1, rings + 1):
            for i in range(ring):
                p = ((ring - i) * a + i * c) / rings, ((ring - i) * b + i * d) / rings
                t.canvas.dot(t.tile([p])[0], "red", 1.6)
    t.canvas.dot(t.at(0.5, 0.5), "red", 1.6)


def draw_split(t):
    t.outline()
    for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
        t.line((0.5, 0.5), (u, v), "blue", 1.2)
    t.canvas.dot(t.at(0.5, 0.5), "red", 2.5)


def draw_net(t):
    t.outline()
    thirds = (0, 1 / 3, 2 / 3, 1)
    for u in thirds:
        t.canvas.path([t.at(u, v) for v in thirds], "grey", 1)
        t.canvas.path([t.at(v, u) for v in thirds], "grey", 1)
        for v in thirds:
            t.canvas.dot(t.at(u, v), "red", 2)


def draw_boxes(t):
    t.grid()
    x, y = t.middle
    t.canvas.box(x - 48, y - 34, 96, 70, "grey")
    t.canvas.parts[-1] = t.canvas.parts[-1].replace("/>", ' fill="none"/>')
    t.canvas.box(x - 42, y - 29, 84, 60, "grey", dashed=True)
    t.canvas.parts[-1] = t.canvas.parts[-1].replace("/>", ' fill="none"/>')


# [stage]: its title, text, where it is, the picture, and what must be there: names in files. They follow one another
# from left to right, row by row.
def stages(source):
    rings = int(source.find("kernels/examine.h", r"probe_levels\(int n\) \{ return n <= 8 \? (\d+)"))
    half = rings // 2
    probes, gentle = 1 + 4 * rings * (rings + 1) // 2, 1 + 4 * half * (half + 1) // 2 + 4 * half
    most = int(source.number("kernels/layout.h", "FAIR_MOST_SIDES"))
    return (
        ("Polygon", "of a file or of arrays;\nchecked, and mended or\nrefused: nothing later\nchecks it again",
         "host/files, host/validate", draw_mesh,
         {"host/files/mesh_file.h": "load_mesh", "host/validate/validate.h": "validate"}),
        ("Normals, creases",
         "creases (red) marked or\nrounded; normals if the\nfile has none; limits to\nhow far sides bulge",
         "host/mesh, complete_mesh", draw_normals,
         {"host/mesh/creases.h": "mark_creases", "host/build/complete_mesh.h": "complete_mesh"}),
        ("Sides", "the curve C, the normal\nn_c along it, and the\ncross tangent T (red);\nneighbours share C, n_c",
         "kernels/fair.h, side.h, build.h", draw_sides,
         {"kernels/fair.h": "fair_curve", "kernels/side.h": "cross_tangent"}),
        ("Draft", "control data. If fair:\n3 sides: sextic, 4: bicubic,\n"
         f"5 to {most}: curved ribbons;\nelse the paper's blend",
         "draft_patch, FORM_* of layout.h", Thumbnail.grid,
         {"host/build/patch_draft.h": "draft_patch", "kernels/layout.h": "FORM_SEXTIC FORM_BEZIER FORM_CURVED"}),
        ("Examination", f"a quad at {probes} probes, or\n{gentle} if gentle: how its\n"
         "normals turn, curvature,\nbox, way to its polygon",
         "examine (kernels/examine.h)", draw_probes, {"kernels/examine.h": "examine is_gentle"}),
        ("If it folds or bulges", "1. eased: shorter T\n2. split: triangles\n3. bent: T in the plane;\nthe first that is safe",
         "draft_tamer, draft_flatter", draw_split, {"host/build/patch_tame.h": "draft_tamer draft_flatter"}),
        ("Form of the level",
         "exact: as drafted; else\nribbon, bezier or table,\nexamined again; as drafted\nwhere that folds",
         "forms_of (build_cache.cpp)", draw_net, {"host/build/build_cache.cpp": "forms_of"}),
        ("Tiles", "the fewest in which\nnormals keep together,\nbounds from samples,\nwidened",
         "cut_tiles, kernels/cut.h", Thumbnail.tiles,
         {"host/build/patch_tiles.h": "cut_tiles", "kernels/cut.h": "cut_patch"}),
        ("Cache", "stored in float or double;\nsides joined, a tree of\nboxes, parts that overlap;\na file, if wanted",
         "PatchCache, Surface", draw_boxes,
         {"host/surface/patch_cache.h": "PatchCache", "host/surface/surface.h": "Surface"}),
    )


def draw_search(canvas, source):
    x, y = COLUMNS[0], ROWS[3]
    canvas.box(x, y, COLUMNS[2] + WIDTH - x, HEIGHT)
    canvas.text(x + 12, y + 22, "Search for the nearest point", "title")
    steps = (("boxes near the\nHIP, nearest first", "kernels/hierarchy.h", "next_patch"),
             ("its polygon gives\nwhere to start", "kernels/search.h", "nearest_base"),
             ("tiles that may hold\na nearer point", "kernels/search.h", "search_tiles"),
             ("descent, over edges\nif that is nearer", "kernels/track.h", "track_foot"))
    for i, (words, path, name) in enumerate(steps):
        left = x + 12 + 215 * i
        t = Thumbnail(canvas, (left + 154, y + 62), 42)
        hip = (left + 160, y + 114)
        if i == 0:
            t.grid()
            for size, dashed in ((33, False), (38, True)):
                canvas.path([(t.middle[0] + a * size, t.middle[1] + b * 0.75 * size) for a, b in
                             ((-1, -1), (1, -1), (1, 1), (-1, 1))], "grey", 1.2, dashed, closed=True)
        elif i == 1:
            t.outline("blue", 1.5, flat=True)
            canvas.path([hip, t.at(0.55, 0.45, flat=True)], "red", 1.2, dashed=True)
            canvas.dot(t.at(0.55, 0.45, flat=True), "red", 2.5)
        elif i == 2:
            t.tiles(filled=(4, 5, 6))
        else:
            t.outline()
            foot = t.at(0.42, 0.62)
            canvas.path([t.at(0.95, 0.9), t.at(0.7, 0.85), t.at(0.52, 0.7), foot], "red", 1.2)
            canvas.arrow([hip, foot], "red", 1.5)
            canvas.dot(foot, "red", 2.5)
        canvas.dot(hip, "red", 3.5)
        canvas.text(left, y + 50, words.split("\n"), "small")
        canvas.text(left, y + 88, source.name(path, name), "code")


def draw(source):
    canvas = Canvas("The life of a patch", 900, 676)
    for i, (title, words, where, picture, names) in enumerate(stages(source)):
        for path, of_file in names.items():
            source.name(path, of_file)
        x, y = COLUMNS[i % 3], ROWS[i // 3]
        canvas.box(x, y, WIDTH, HEIGHT)
        canvas.text(x + 12, y + 22, title, "title")
        canvas.text(x + 12, y + 43, words.split("\n"), "small")
        canvas.text(x + 12, y + HEIGHT - 14, where, "code")
        picture(Thumbnail(canvas, (x + WIDTH - 58, y + 62)))
    draw_search(canvas, source)

    for row in range(3):
        y = ROWS[row] + HEIGHT / 2
        for column in range(2):
            canvas.arrow([(COLUMNS[column] + WIDTH, y), (COLUMNS[column + 1], y)], "grey")
    middles = [x + WIDTH / 2 for x in COLUMNS]
    for row in range(2):
        bottom, gap, top = ROWS[row] + HEIGHT, ROWS[row] + HEIGHT + 20, ROWS[row + 1]
        canvas.arrow([(middles[2], bottom), (middles[2], gap), (middles[0], gap), (middles[0], top)], "grey")
    canvas.arrow([(middles[2], ROWS[2] + HEIGHT), (middles[2], ROWS[3])], "grey")
    bottom, gap = ROWS[1] + HEIGHT, ROWS[1] + HEIGHT + 20
    canvas.path([(middles[1], bottom), (middles[1], gap)], "grey")
    canvas.text(middles[1] + 8, bottom + 14, "safe", "small")
    return canvas.svg()
