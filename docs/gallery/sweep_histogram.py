"""How much the force changes from sample to sample beneath a whole torus: smooth, shaded and flat."""
import gliss
import numpy as np

from shapes import picture, torus

surface = gliss.Surface(*torus(24, 12), unit="mm")
sweep = surface.sweep("1mm", samples=1e5, stiffness="0.5N/mm")
for figures in sweep.statistics:
    print(f"{figures['method']:8} step across edges: mean {figures['edge_step_N']['mean']:.4f} N, "
          f"largest {figures['edge_step_N']['max']:.4f} N; {figures['jumps_per_100k']:.0f} jumps per 100,000 pairs")


def draw(plt):
    plt.figure(figsize=(7, 4))
    for figures, histograms in zip(sweep.statistics, sweep.histograms):
        counts = histograms["edge_step"]
        plt.step(sweep.bin_edges, counts / max(counts.sum(), 1), label=figures["method"])
    plt.xscale("log")
    plt.xlim(1e-6, 1)
    plt.xlabel("change of force across an edge, N")
    plt.ylabel("share of the pairs")
    plt.legend()


picture(draw)
