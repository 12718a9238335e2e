#!/usr/bin/env python3
"""Writes a path of HIPs 2 mm, or DEPTH mm, beneath the tube of `gliss generate knot`, one a tick, as CSV.

It travels along the knot and slowly round the tube, 0.15 mm a tick. Usage: tools/knot_path.py [DEPTH] > path.csv
"""

import math
import sys

MAJOR, MINOR, TUBE = 33.0, 17.0, 12.0  # mm, the generator's defaults
DEPTH, STEP, TICKS = 2.0, 0.15, 800  # mm, mm, ticks
TURN = 8  # radians round the tube for a radian of t


def point(t, radius):
    """The point at `radius` from the knot's curve, TURN * t round it."""
    a, b = 2 * t, 3 * t
    ring = MAJOR + MINOR * math.cos(b)
    centre = (ring * math.cos(a), ring * math.sin(a), MINOR * math.sin(b))
    slope, speed = -3 * MINOR * math.sin(b), 2 * ring
    along = (slope * math.cos(a) - speed * math.sin(a),
             slope * math.sin(a) + speed * math.cos(a), 3 * MINOR * math.cos(b))
    length = math.hypot(*along)
    along = [x / length for x in along]
    # The curve lies on a torus, whose normal is at right angles to it.
    out = (math.cos(b) * math.cos(a), math.cos(b) * math.sin(a), math.sin(b))
    side = (along[1] * out[2] - along[2] * out[1], along[2] * out[0] - along[0] * out[2],
            along[0] * out[1] - along[1] * out[0])
    c, s = radius * math.cos(TURN * t), radius * math.sin(TURN * t)
    return [m + c * o + s * d for m, o, d in zip(centre, out, side)]


def path(depth):
    t, radius = 0.0, TUBE - depth
    for _ in range(TICKS):
        yield point(t, radius)
        t += STEP * 1e-4 / math.dist(point(t, radius), point(t + 1e-4, radius))


def main():
    sys.stdout.write("step,x_mm,y_mm,z_mm\n")
    depth = float(sys.argv[1]) if len(sys.argv) > 1 else DEPTH
    for step, (x, y, z) in enumerate(path(depth)):
        sys.stdout.write(f"{step},{x:.9f},{y:.9f},{z:.9f}\n")


if __name__ == "__main__":
    main()
