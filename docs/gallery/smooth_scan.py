"""A coarse scan of a bumpy ball, made smooth, beside its facets."""
import gliss
import numpy as np

from shapes import picture

# A scan: rings of points, a little off, and triangles between them.
rings, spokes = 10, 16
up = np.linspace(0, np.pi, rings + 2)[1:-1]
around = np.arange(spokes) * 2 * np.pi / spokes
u, a = (x.ravel() for x in np.meshgrid(up, around, indexing="ij"))
radius = 30 + 3 * np.sin(3 * a) * np.sin(u) ** 2 + np.random.default_rng(1).normal(0, 0.3, u.size) * np.sin(u)
body = radius[:, None] * np.column_stack([np.sin(u) * np.cos(a), np.sin(u) * np.sin(a), np.cos(u)])
vertices = np.vstack([body, [[0, 0, 30], [0, 0, -30]]])
north, south = rings * spokes, rings * spokes + 1
triangles = []
for j in range(spokes):
    k = (j + 1) % spokes
    triangles += [[north, j, k], [south, (rings - 1) * spokes + k, (rings - 1) * spokes + j]]
    for i in range(rings - 1):
        one, two, three, four = i * spokes + j, (i + 1) * spokes + j, (i + 1) * spokes + k, i * spokes + k
        triangles += [[one, two, three], [one, three, four]]
scan = np.array(triangles)

surface = gliss.Surface(vertices, scan, unit="mm")
smooth = surface.tessellate(4)


def bends(points, faces):
    """Degrees between each pair of neighbours."""
    a, b, c = np.moveaxis(points[faces], 1, 0)
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    owner, pairs = {}, []
    for face, (i, j, k) in enumerate(faces.tolist()):
        for edge in ((i, j), (j, k), (k, i)):
            if edge[::-1] in owner:
                pairs.append((owner[edge[::-1]], face))
            owner[edge] = face
    one, other = np.array(pairs).T
    return np.degrees(np.arccos(np.clip((normal[one] * normal[other]).sum(axis=1), -1, 1)))


print(f"scan: {len(scan)} triangles, which bend by {bends(vertices, scan).max():.1f} degrees at most")
print(f"smooth: {len(smooth.triangles)} triangles, by {bends(smooth.point, smooth.triangles).max():.1f} degrees")


def draw(plt):
    figure = plt.figure(figsize=(9, 4.5))
    for i, (points, faces) in enumerate([(vertices, scan), (smooth.point, smooth.triangles)]):
        axes = figure.add_subplot(1, 2, i + 1, projection="3d")
        axes.plot_trisurf(*points.T, triangles=faces, color="#9ab", linewidth=0, antialiased=False, shade=True)
        axes.set_box_aspect((1, 1, 1))
        axes.set_axis_off()
        axes.set_title("facets" if i == 0 else "smooth")


picture(draw)
