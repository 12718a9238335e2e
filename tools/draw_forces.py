#!/usr/bin/env python3
"""Draws |F_i - F_(i-1)| along a path, a bar graph for each method, all on the same axis, as SVG.

Usage: tools/draw_forces.py FORCES.csv PICTURE.svg, where FORCES.csv was written by `gliss trace`.
A tick has a bar where it or the one before it is in contact: gaining and losing contact are steps
from zero and to zero. Jumps are steps above 20 % of the method's largest force, which is stiffness
times depth on a path of one depth; lost are contacts that end under more than that.
"""

import csv
import html
import math
import sys

METHODS = (("flat", "flat polygons"), ("shaded", "force shading"), ("gregory", "Gregory patches"))
LEFT, RIGHT, TOP, GRAPH, GAP, BOTTOM = 40, 16, 50, 84, 30, 40
LEAST_WIDTH = 500

STYLE = """
.back { fill: #ffffff; } text { fill: #222222; font: 13px sans-serif; }
.axis { stroke: #888888; } .grid { stroke: #dddddd; } .small { font-size: 11px; }
.flat { stroke: #333333; } .shaded { stroke: #c62828; } .gregory { stroke: #1565c0; }
@media (prefers-color-scheme: dark) {
  .back { fill: #0d1117; } text { fill: #e6edf3; }
  .axis { stroke: #8b949e; } .grid { stroke: #30363d; }
  .flat { stroke: #c9d1d9; } .shaded { stroke: #ff7b72; } .gregory { stroke: #58a6ff; }
}
"""


def read_steps(name):
    """{method: [(tick, force before, force)]}, None where free; {method: ticks in contact}; ticks."""
    steps, touching, last, first, tick = {}, {}, {}, None, 0
    with open(name, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            method, tick = row["method"], int(float(row["step"]))
            force = [float(row[c]) for c in ("fx", "fy", "fz")]
            if not all(math.isfinite(f) for f in force):
                sys.exit(f"{name}: a force of {method} at step {tick} is not finite")
            force = force if row["state"] == "contact" else None
            first = tick if first is None else first
            touching[method] = touching.get(method, 0) + (force is not None)
            if method in last and (force or last[method]):
                steps.setdefault(method, []).append((tick - first, last[method], force))
            last[method] = force
    if not steps:
        sys.exit(f"{name}: no step of force")
    return steps, touching, tick - first + 1


FREE = (0, 0, 0)


class Felt:
    """What one method's steps are, and how many of them jump or lose contact."""

    def __init__(self, steps, touching):
        self.bars = [(tick, math.dist(now or FREE, before or FREE)) for tick, before, now in steps]
        self.largest = max(step for _, step in self.bars)
        sizes = [math.hypot(*force) for _, *forces in steps for force in forces if force]
        jump = 0.2 * max(sizes)
        self.jumps = 1e5 / touching * sum(step > jump for _, step in self.bars)
        self.lost = 1e5 / touching * sum(
            now is None and math.hypot(*before) > jump for _, before, now in steps)


def scale_of(largest):
    """The end of the axis, and its marks."""
    unit = 10 ** math.floor(math.log10(largest))
    mark = next(m * unit for m in (0.2, 0.5, 1, 2, 5) if largest / (m * unit) <= 4)
    count = math.ceil(largest / mark)
    return mark * count, [mark * i for i in range(count + 1)]


def graph(method, title, felt, top, height, marks, width):
    base = top + GRAPH
    yield (f'<text x="{LEFT}" y="{top - 8}">{title}: at most {felt.largest:.2g} N; '
           f'per 100,000 ticks jumps {felt.jumps:,.0f}, lost {felt.lost:,.0f}</text>')
    for mark in marks:
        y = base - GRAPH * mark / height
        yield f'<path class="grid" d="M{LEFT} {y:.1f}h{width}"/>'
        yield (f'<text class="small" x="{LEFT - 6}" y="{y + 4:.1f}" text-anchor="end">'
               f'{mark:.10g}</text>')
    bars = "".join(f"M{LEFT + tick} {base}v-{GRAPH * step / height:.2f}" for tick, step in felt.bars)
    yield f'<path class="{method}" d="{bars}"/>'
    yield f'<path class="axis" d="M{LEFT} {base}h{width}"/>'


def draw(steps, touching, ticks):
    methods = [(m, title) for m, title in METHODS if m in steps]
    felt = {method: Felt(of_method, touching[method]) for method, of_method in steps.items()}
    height, marks = scale_of(max(of.largest for of in felt.values()))
    width = max(ticks, LEAST_WIDTH)
    full = (LEFT + width + RIGHT, TOP + len(methods) * (GRAPH + GAP) + BOTTOM - GAP + 16)
    title = "|F(i) - F(i-1)|, N: what the force changes by from one tick to the next"
    yield (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {full[0]} {full[1]}" '
           f'role="img"><title>{html.escape(title)}</title><style>{STYLE}</style>')
    yield f'<rect class="back" width="{full[0]}" height="{full[1]}"/>'
    for i, (method, name) in enumerate(methods):
        top = TOP + i * (GRAPH + GAP)
        yield from graph(method, name, felt[method], top, height, marks, width)
    y = full[1] - BOTTOM + 4
    for tick in range(0, ticks + 1, 100):
        yield f'<text class="small" x="{LEFT + tick}" y="{y}" text-anchor="middle">{tick}</text>'
    yield f'<text x="{LEFT + width / 2}" y="{y + 20}" text-anchor="middle">tick</text>'
    yield f'<text x="{LEFT}" y="{TOP - 32}">{html.escape(title)}</text>'
    yield "</svg>\n"


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    steps, touching, ticks = read_steps(sys.argv[1])
    with open(sys.argv[2], "w", encoding="utf-8") as file:
        file.write("\n".join(draw(steps, touching, ticks)))


if __name__ == "__main__":
    main()
