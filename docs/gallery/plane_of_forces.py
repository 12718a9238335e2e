"""The force on a hand at each point of a plane through a torus."""
import gliss
import numpy as np

from shapes import picture, torus

surface = gliss.Surface(*torus(16, 8), unit="mm")
x, z = np.meshgrid(np.linspace(-60, 60, 240), np.linspace(-20, 20, 80))
points = np.column_stack([x.ravel(), np.zeros(x.size), z.ravel()])
force = surface.force(points, stiffness="0.5N/mm")
size = np.linalg.norm(force, axis=1)
print(f"{np.count_nonzero(size)} of {len(points)} points feel a force, of {size.max():.2f} N at most")


def draw(plt):
    plt.figure(figsize=(9, 3.5))
    plt.imshow(size.reshape(x.shape), extent=(-60, 60, -20, 20), origin="lower", cmap="viridis")
    plt.colorbar(label="force, N")
    some = np.flatnonzero(size > 0)[::37]
    plt.quiver(points[some, 0], points[some, 2], force[some, 0], force[some, 2], color="white", width=2e-3)
    plt.xlabel("x, mm")
    plt.ylabel("z, mm")


picture(draw)
