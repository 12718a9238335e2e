"""The rooms: which uses which, and the library that each goes into. Both are read from the build; only where a room
stands in the picture is written here."""
import re
import sys

from canvas import Canvas

# [room], column and row from below: a room stands above those that it uses.
PLACES = {
    "base": (3.5, 0), "mesh": (3.5, 1), "generate": (3, 2), "surface": (4, 2), "build": (3, 3), "query": (4, 3),
    "lazy": (3.5, 4), "thread": (6, 2), "device": (5, 4), "contact": (6, 5), "loop": (5.5, 6), "validate": (2, 4),
    "files": (2, 5), "tables": (2, 6), "engine": (3, 5), "walk": (0, 5), "sweep": (1, 6), "compare": (0.5, 7), "results": (1.5, 8),
    "haply": (7, 5), "scene": (5, 7), "c_api": (4, 7),
}
WIDTH, HEIGHT, ACROSS, UP, LEFT, BOTTOM = 90, 30, 108, 58, 26, 548


def corner(place):
    return LEFT + ACROSS * place[0], BOTTOM - UP * place[1]


def libraries_of(source):
    """{library: its rooms}, as the build file lists them."""
    build = source.read("CMakeLists.txt")
    lists = dict(re.findall(r"^add_gliss_library\((\w+) ROOMS ([\w ]+?)(?: USES [\w ]+)?\)", build, re.MULTILINE))
    lists.update(re.findall(r"add_library\(gliss_(\w+) SHARED \$<TARGET_OBJECTS:room_(\w+)>", build))
    return {library: rooms.split() for library, rooms in lists.items()}


def draw_frame(canvas, rooms):
    """The frame of a library's rooms; returns where its name stands."""
    at = [corner(PLACES[room]) for room in rooms]
    left, right = min(x for x, _ in at) - 8, max(x for x, _ in at) + WIDTH + 8
    top, bottom = min(y for _, y in at) - 20, max(y for _, y in at) + HEIGHT + 6
    canvas.box(left, top, right - left, bottom - top, "group")
    return left + 6, top + 13


def rooms_on(column, rows):
    """How many rooms stand in the way of a line down the middle of a column, in these rows."""
    return sum(row in rows and abs(at - column) * ACROSS < WIDTH / 2 for at, row in PLACES.values())


def turn_of(used, user):
    """The row above which a line down from the user goes aside: where the fewest rooms are in its way."""
    (low_column, low), (column, high) = PLACES[used], PLACES[user]
    return min(range(low, high), key=lambda row: rooms_on(column, range(row + 1, high)) +
               rooms_on(low_column, range(low + 1, row + 1)))


def ends_of(rooms, others):
    """{(room, other): where the line to the other one ends}, beside one another in the order of the others."""
    ends = {}
    for room in rooms.seen:
        at = sorted(others(room), key=lambda other: PLACES[other][0])
        for i, other in enumerate(at):
            ends[room, other] = corner(PLACES[room])[0] + WIDTH / 2 + 12 * (i - (len(at) - 1) / 2)
    return ends


def draw_uses(canvas, rooms):
    below = ends_of(rooms, rooms.used)
    above = ends_of(rooms, lambda room: [user for user in rooms.seen if room in rooms.used(user)])
    for user, used in sorted(below):
        x, x0, y = below[user, used], above[used, user], BOTTOM - UP * turn_of(used, user)
        top = y - UP + HEIGHT
        canvas.curve(f"M{x:.0f} {corner(PLACES[user])[1] + HEIGHT}V{top}C{x:.0f} {y} {x0:.0f} {top} {x0:.0f} {y}"
                     f"V{corner(PLACES[used])[1]}", "grey", 1.2)


def draw(source, rooms):
    libraries = libraries_of(source)
    drawn = {room for of_library in libraries.values() for room in of_library}
    if PLACES.keys() != rooms.seen.keys() or not drawn <= PLACES.keys():
        sys.exit("tools/pictures: the rooms of the picture, of the build and of its libraries differ: "
                 f"{sorted(PLACES.keys() ^ rooms.seen.keys() | drawn - PLACES.keys())}")
    canvas = Canvas("The rooms, and which uses which", 900, 604)
    canvas.box(LEFT - 8, 8, 866, 30, "box", dashed=True)
    canvas.text(450, 28, "Programs and bindings link the libraries: tools/, python/, examples/, tests/, bench/.", "",
                "middle")
    names = {library: draw_frame(canvas, of_library) for library, of_library in libraries.items()}
    draw_uses(canvas, rooms)
    for library, (x, y) in names.items():
        canvas.text(x, y, library, "code")
    for room in sorted(PLACES):
        x, y = corner(PLACES[room])
        canvas.box(x, y, WIDTH, HEIGHT)
        canvas.text(x + WIDTH / 2, y + 20, room, "", "middle")
    (x, y), (x0, y0) = corner((5, 1)), corner(PLACES["surface"])
    canvas.arrow([(x + 24, y - 20), (x + 24, y0 + HEIGHT / 2), (x0 + WIDTH, y0 + HEIGHT / 2)], "blue", 1.5, dashed=True)
    canvas.box(x, y - 20, 146, 50, "box", dashed=True)
    canvas.text(x + 8, y - 5, "kernels/", "title")
    canvas.text(x + 8, y + 10, ["the mathematics,", "which surface compiles"], "small")
    canvas.text(LEFT, BOTTOM - 6, ["A line leads up from a room to one that uses", "it, and that sees all below.",
                                   "A frame is a library, such as gliss::core;",
                                   "a room without one is for programs alone."], "small")
    return canvas.svg()
