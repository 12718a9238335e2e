"""An SVG picture in the one style of all: blue is a surface, red the HIP and what it feels, grey what helps to see it.
Text is text, and colours follow the reader's choice of light or dark."""
import html
import math

STYLE = """
.back { fill: #ffffff; } .box { fill: #f6f8fa; stroke: #8c959f; } .group { fill: none; stroke: #d0d7de; }
.fill { fill: #1565c0; fill-opacity: .12; stroke: none; } .hot { fill: #c62828; fill-opacity: .14; stroke: none; }
.blue { stroke: #1565c0; } .red { stroke: #c62828; } .grey { stroke: #8c959f; }
.blue-dot { fill: #1565c0; } .red-dot { fill: #c62828; } .grey-dot { fill: #8c959f; }
text { fill: #1f2328; font: 13px sans-serif; } .small { font-size: 11.5px; } .title { font-weight: bold; }
.code { font: 11.5px monospace; fill: #59636e; } .blue-text { fill: #1565c0; } .red-text { fill: #c62828; }
@media (prefers-color-scheme: dark) {
  .back { fill: #0d1117; } .box { fill: #161b22; stroke: #6e7681; } .group { stroke: #30363d; }
  .fill { fill: #58a6ff; fill-opacity: .18; } .hot { fill: #ff7b72; fill-opacity: .2; }
  .blue { stroke: #58a6ff; } .red { stroke: #ff7b72; } .grey { stroke: #8b949e; }
  .blue-dot { fill: #58a6ff; } .red-dot { fill: #ff7b72; } .grey-dot { fill: #8b949e; }
  text { fill: #e6edf3; } .code { fill: #9198a1; } .blue-text { fill: #58a6ff; } .red-text { fill: #ff7b72; }
}
"""


def number(x):
    """A coordinate to a tenth; never -0."""
    return f"{round(x, 1) + 0:.10g}"


def place(p):
    return f"{number(p[0])} {number(p[1])}"


class Canvas:
    def __init__(self, title, width, height):
        self.parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img">'
                      f"<title>{html.escape(title)}</title><style>{STYLE}</style>",
                      f'<rect class="back" width="{width}" height="{height}"/>']

    def text(self, x, y, words, style="", anchor="start"):
        """One line of text, or one for each string of a list."""
        for i, line in enumerate([words] if isinstance(words, str) else words):
            at = f' text-anchor="{anchor}"' if anchor != "start" else ""
            kind = f' class="{style}"' if style else ""
            self.parts.append(f'<text x="{number(x)}" y="{number(y + 16 * i)}"{kind}{at}>{html.escape(line)}</text>')

    def box(self, x, y, width, height, style="box", dashed=False):
        dash = ' stroke-dasharray="5 4"' if dashed else ""
        self.parts.append(f'<rect class="{style}" x="{number(x)}" y="{number(y)}" width="{number(width)}" '
                          f'height="{number(height)}" rx="5"{dash}/>')

    def path(self, points, style, width=1.5, dashed=False, closed=False):
        """Lines from point to point; `style` fill or hot: the area in them."""
        data = "M" + "L".join(place(p) for p in points) + ("Z" if closed else "")
        self.curve(data, style, width, dashed)

    def curve(self, data, style, width=1.5, dashed=False):
        is_line = style not in ("fill", "hot")
        line = f' fill="none" stroke-width="{width}"' if is_line else ""
        dash = ' stroke-dasharray="5 4"' if dashed else ""
        self.parts.append(f'<path class="{style}" d="{data}"{line}{dash}/>')

    def arrow(self, points, style, width=1.5, dashed=False):
        """Lines from point to point, with a head at the last."""
        self.path(points, style, width, dashed)
        (x0, y0), (x, y) = points[-2:]
        length = math.hypot(x - x0, y - y0)
        a, b = (x - x0) / length, (y - y0) / length
        size = 5 + width
        head = [(x - size * a - size * s * b / 2, y - size * b + size * s * a / 2) for s in (1, -1)]
        self.parts.append(f'<path class="{style}-dot" d="M{place((x, y))}L{place(head[0])}L{place(head[1])}Z"/>')

    def dot(self, p, style, size=3.5):
        self.parts.append(f'<circle class="{style}-dot" cx="{number(p[0])}" cy="{number(p[1])}" r="{size}"/>')

    def ring(self, p, size, style, width=1.5, dashed=False):
        dash = ' stroke-dasharray="5 4"' if dashed else ""
        self.parts.append(f'<circle class="{style}" cx="{number(p[0])}" cy="{number(p[1])}" r="{number(size)}" '
                          f'fill="none" stroke-width="{width}"{dash}/>')

    def svg(self):
        return "\n".join([*self.parts, "</svg>\n"])
