"""Friction along a path: a HIP goes to and fro 1 mm beneath a torus, and its contact point sticks and slips."""
import gliss
import numpy as np

from shapes import picture, torus

surface = gliss.Surface(*torus(24, 12), unit="mm")
t = np.arange(4000) * 1e-3  # s, a tick a millisecond
way = 3 * np.sin(2 * np.pi * 0.5 * t)  # mm
path = np.column_stack([54 * np.cos(way / 54), 54 * np.sin(way / 54), np.zeros(len(t))])

felt = {}
for friction in (0, 0.3, (0.6, 0.3)):
    trace = felt[friction] = surface.trace(path, stiffness="0.5N/mm", friction=friction, friction_settle="2ms")
    print(f"friction {friction}: slips in {100 * trace.slipping.mean():5.1f} % of the ticks; "
          f"work on the hand {1e3 * trace.statistics['net_work_J']:7.3f} mJ")


def draw(plt):
    plt.figure(figsize=(7, 4))
    for friction, trace in felt.items():
        plt.plot(way, trace.force[:, 1], label=f"friction {friction}")
    plt.xlabel("way along the surface, mm")
    plt.ylabel("force along it, N")
    plt.legend()


picture(draw)
