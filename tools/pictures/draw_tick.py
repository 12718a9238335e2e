"""A HIP through a tick: down through the rooms to the kernels, and the force back up."""
from canvas import Canvas

LANES = (("device", "runtime/device"), ("loop", "runtime/loop"), ("scene", "runtime/contact"),
         ("contact", "host/query"), ("surface", "kernels/"))
LEFT, RIGHT, WIDTH, TOP, HIGH, PITCH = 130, 540, 340, 16, 104, 132


def lane_top(lane):
    return TOP + PITCH * lane


def texts(source):
    """[lane]: of the step down and of the step up, title, text and the name in the source."""
    guard, tracker = "runtime/device/guard.h", "host/query/contact_tracker.h"
    late, begins, ends = (int(source.find(guard, rf"{name}\{{(\d+)'000'000\}}"))
                          for name in ("hold_after", "ramp_from", "ramp_to"))
    force, rate, engage = (source.number(guard, name) for name in ("max_force", "max_rate", "engage_below"))
    evaluations, searches = (int(source.number(tracker, name)) for name in ("kTickEvaluations", "kTickSearches"))
    all_of_step = int(source.number("runtime/contact/tracker.h", "kStepEvaluations"))
    drags = int(source.number("host/query/tick_drag.h", "kDrags"))
    settle = float(source.find("host/query/query.h", r"kSettleTime = ([\d.e-]+)"))
    period = source.find("runtime/loop/loop.h", r"period = std::chrono::milliseconds\((\d+)\)")
    promise = source.find("runtime/device/device.h", r"(\d+) ms")
    return (
        (("Read", "where the hand is, and when that was measured", "HapticDevice::read"),
         ("Write", f"no force stands for longer than {promise} ms\nafter the loop has written it last",
          "HapticDevice::write")),
        (("Wait, then read", f"the deadline comes every {period} ms by default;\nwhat brings nothing new grows old",
          "HapticLoop::run"),
         ("Guard", f"at most {force:g} N, {rate:,.0f} N/s; engages below {engage:g} N;\n"
          f"an input older than {late} ms is late: the force fades\nfrom {begins} ms on, and is 0 at {ends} ms",
          "Guard::step")),
        (("Each HIP and object", "one that is too far to touch costs a comparison;\n"
          f"a step has {all_of_step:,} evaluations, and a tick's more", "Tracker::step"),
         ("Force", "stiffness times push, and effects; turned to\nthe world, summed over HIPs and objects",
          "Tracker::feel, Effects")),
        (("Follow, or look", "in contact: the contact point is followed;\n"
          f"free: the way since the last tick is searched;\n{evaluations:,} evaluations, {searches} searches at most",
          "ContactTracker::tick, TickWay"),
         ("Friction, settling", "friction holds the contact point, or drags it and\n"
          f"asks the surface again, up to {drags} times; after a leap\n"
          f"the push turns by a fifth of itself in {1e3 * settle:g} ms", "TickDrag, Settling")),
        (("Find the foot", "in contact from where the last one was going, else of\n"
          "all patches: descents within a patch, over edges\nwhere the neighbour is nearer",
          "follow_contact, nearest_contact"),
         ("Judge it", "inside where the way out goes along the normal;\n"
          "past an open border it fades; where solids overlap\nit is carried to the surface of their union",
          "contact_of_foot, unite_tracked")),
    )


NAMES = (("runtime/device/device.h", "HapticDevice read write"), ("runtime/loop/loop.h", "HapticLoop run"),
         ("runtime/device/guard.h", "Guard step"), ("runtime/contact/tracker.h", "Tracker step feel Effects"),
         ("host/query/contact_tracker.h", "ContactTracker tick Settling"), ("host/query/tick_way.h", "TickWay"),
         ("host/query/tick_drag.h", "TickDrag"), ("kernels/union.h", "unite_tracked"),
         ("kernels/contact.h", "tick follow_contact nearest_contact contact_of_foot"))
# Between two lanes: what goes down, what comes up.
DOWN = ("position in m, world", "position, time, velocity", "HIP in the mesh's unit, object's frame",
        "HIP as high and low numbers in [-1, 1]")
UP = ("force in N, guarded", "force and torque in N, N m, world", "push in the mesh's unit",
      "contact: point, normal, push, flags")


def draw(source):
    for path, names in NAMES:
        source.name(path, names)
    steps = texts(source)
    canvas = Canvas("A HIP through a tick", 900, lane_top(len(LANES) - 1) + HIGH + 16)
    for lane, (title, folder) in enumerate(LANES):
        y = lane_top(lane)
        canvas.box(12, y - 8, 876, HIGH + 16, "group")
        canvas.text(22, y + 20, title, "title")
        canvas.text(22, y + 40, folder.split("/")[0] + "/", "code")
        canvas.text(22, y + 56, folder.split("/")[1], "code")
        for x, (name, words, code) in zip((LEFT, RIGHT), steps[lane]):
            canvas.box(x, y, WIDTH, HIGH)
            canvas.text(x + 12, y + 22, name, "title")
            canvas.text(x + 12, y + 43, words.split("\n"), "small")
            canvas.text(x + 12, y + HIGH - 10, code, "code")
    for lane in range(len(LANES) - 1):
        low, high = lane_top(lane) + HIGH, lane_top(lane + 1)
        canvas.arrow([(LEFT + 24, low), (LEFT + 24, high)], "red", 2)
        canvas.text(LEFT + 36, (low + high) / 2 + 4, DOWN[lane], "red-text small")
        canvas.arrow([(RIGHT + 24, high), (RIGHT + 24, low)], "blue", 2)
        canvas.text(RIGHT + 36, (low + high) / 2 + 4, UP[lane], "blue-text small")
    y = lane_top(len(LANES) - 1) + HIGH / 2
    canvas.arrow([(LEFT + WIDTH, y), (RIGHT, y)], "red", 2)
    canvas.text((LEFT + WIDTH + RIGHT) / 2, y - 8, "foot", "red-text small", "middle")
    return canvas.svg()
