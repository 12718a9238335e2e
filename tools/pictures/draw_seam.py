"""A seam in section: the contact of a HIP inside two solids, computed here step by step as kernels/union.h does."""
import math

from canvas import Canvas

SOLIDS = (((-66.0, 0.0), 96.0), ((60.0, 6.0), 84.0))  # circles: middle, radius
HIP = (4.0, 18.0)
GAP = 1e-3  # a contact point is buried if it is so far inside of another solid


def add(a, b, s=1.0):
    return a[0] + s * b[0], a[1] + s * b[1]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1]


def foot_on(solid, x):
    """The nearest point of a solid's surface to x, and the outward normal there."""
    middle, radius = solid
    way = add(x, middle, -1)
    normal = (way[0] / math.hypot(*way), way[1] / math.hypot(*way))
    return add(middle, normal, radius), normal


def is_in(solid, x):
    return math.dist(solid[0], x) < solid[1]


def supports_of(feet):
    """Of each solid: the foot, the normal, and how far the HIP is beneath the tangent plane there."""
    return [(foot, normal, dot(normal, add(foot, HIP, -1))) for foot, normal in feet]


def shortest_push(supports):
    """From the HIP out of the tangent planes of two supports, and the weights of their normals."""
    (_, n, b), (_, m, c) = supports
    along = dot(n, m)
    v, w = (b - along * c) / (1 - along * along), (c - along * b) / (1 - along * along)
    assert v > 0 and w > 0
    return add((v * n[0], v * n[1]), m, w), (v, w)


def steps():
    """The supports, the push and its weights of each step, until the push stays."""
    own = foot_on(SOLIDS[0], HIP)
    outside = add(own[0], own[1], GAP)
    assert is_in(SOLIDS[1], outside)
    supports, found = supports_of([own, foot_on(SOLIDS[1], outside)]), []
    while True:
        push, weights = shortest_push(supports)
        found.append((supports, push, weights))
        if len(found) > 1 and math.dist(push, found[-2][1]) < 1e-6:
            return found
        supports = supports_of([foot_on(solid, add(HIP, push)) for solid in SOLIDS])


class Panel:
    """A section of the solids, enlarged about a place of the picture."""

    def __init__(self, canvas, middle, size):
        self.canvas, self.middle, self.size = canvas, middle, size

    def draw_solids(self):
        for solid, other in (SOLIDS, SOLIDS[::-1]):
            self.draw_solid(solid, other)

    def at(self, p):
        return self.middle[0] + self.size * p[0], self.middle[1] - self.size * (p[1] - HIP[1])

    def draw_solid(self, solid, other):
        (x, y), radius = solid
        begin = math.atan2(other[0][1] - y, other[0][0] - x)  # in the other solid
        around = [(x + radius * math.cos(begin + math.radians(k)), y + radius * math.sin(begin + math.radians(k)))
                  for k in range(361)]
        out = [k for k in range(361) if not is_in(other, around[k])]
        around = [self.at(p) for p in around]
        self.canvas.path(around, "fill", closed=True)
        self.canvas.path(around[:out[0] + 1], "grey", 1.2, dashed=True)
        self.canvas.path(around[out[-1]:], "grey", 1.2, dashed=True)
        self.canvas.path(around[out[0]:out[-1] + 1], "blue", 2.2)

    def arrow(self, start, end, style, width=1.5):
        self.canvas.arrow([self.at(start), self.at(end)], style, width)

    def plane(self, support, size):
        foot, normal, _ = support
        aside = (-normal[1], normal[0])
        self.canvas.path([self.at(add(foot, aside, size)), self.at(add(foot, aside, -size))], "grey", 1.2)
        self.arrow(foot, add(foot, normal, 22), "grey", 1.2)
        self.canvas.dot(self.at(foot), "blue", 3.5)

    def label(self, p, dx, dy, words, style, anchor="start"):
        x, y = self.at(p)
        self.canvas.text(x + dx, y + dy, words, style, anchor)


def draw(source):
    union = "kernels/union.h"
    most, all_steps = (int(source.number(union, name)) for name in ("UNION_SUPPORTS", "UNION_STEPS"))
    found = steps()
    (first, push, _), (second, _, _), (_, last, weights) = found[0], found[1], found[-1]
    canvas = Canvas("A contact on the seam of two solids", 900, 372)
    for x, title in ((20, "1. The nearest point is buried"), (320, "2. Supports, and the way out of both"),
                     (620, "3. Again from there, until it stays")):
        canvas.text(x, 24, title, "title")
    canvas.parts.append('<clipPath id="panel"><rect width="276" height="250"/></clipPath>')

    panel = Panel(canvas, (134, 150), 1.55)
    canvas.parts.append('<defs><g id="solids">')
    panel.draw_solids()
    canvas.parts.append("</g></defs>")
    for i, x in enumerate((20, 320, 620)):
        canvas.parts.append(f'<g transform="translate({x} 40)" clip-path="url(#panel)"><use href="#solids"/>')
        canvas.dot(panel.at(HIP), "red", 4)
        if i == 0:
            foot, normal, _ = first[0]
            panel.arrow(HIP, foot, "red")
            canvas.dot(panel.at(foot), "blue", 4)
            panel.label(HIP, -8, 18, "HIP", "red-text", "end")
            panel.label(foot, 8, 4, ["nearest point", "of one solid,", "in the other"], "blue-text small")
        elif i == 1:
            for support in first:
                panel.plane(support, 74)
            panel.arrow(HIP, add(HIP, push), "red", 2)
            panel.label(HIP, 0, 20, "HIP", "red-text", "middle")
            panel.label(add(HIP, push), -14, 2, "push", "red-text small", "end")
            panel.label(first[1][0], -8, 16, "support", "blue-text small", "end")
        else:
            for support in second:
                panel.plane(support, 50)
            for (_, normal, _), weight, dx in zip(found[-1][0], weights, (16, -16)):
                panel.arrow(HIP, add(HIP, normal, weight), "grey", 1.5)
            panel.arrow(HIP, add(HIP, last), "red", 2.5)
            canvas.dot(panel.at(add(HIP, last)), "red", 4.5)
            panel.label(HIP, 0, 20, "HIP", "red-text", "middle")
            panel.label(add(HIP, last), 0, -52, "contact point", "red-text small", "middle")
        canvas.parts.append("</g>")
        canvas.box(x, 40, 276, 250, "group")

    join, push_of, move = (source.name(union, name) for name in ("join_burier", "shortest_push", "move_supports"))
    canvas.text(20, 310, join, "code")
    canvas.text(320, 310, push_of, "code")
    canvas.text(620, 310, move, "code")
    canvas.text(20, 328, ["The build marks patches that lie in no", "other solid: there nothing is asked."], "small")
    canvas.text(320, 328, [f"At most {most} supports. The push is the", "shortest that leaves all tangent planes;",
                           "up to three press, each by its weight."], "small")
    canvas.text(620, 328, ["Feet of the HIP moved by the push give",
                           f"new planes, at most {all_steps} times. Grey: the parts",
                           "of the push. A secant leads along the seam."], "small")
    return canvas.svg()
