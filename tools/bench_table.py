"""Tables of gliss_bench's JSON, as Markdown: medians of the repetitions.

Usage: bench_table.py RESULTS.json [FILE.md]   prints, or replaces what lies between the markers of the file
"""
import json
import os
import pathlib
import platform
import statistics
import sys

BEGIN, END = "<!-- bench: begin -->", "<!-- bench: end -->"
PRECISIONS, LEVELS, SIDES = ("float", "double"), ("exact", "ribbon", "bezier", "table"), (3, 4, 5, 6)


def medians(benchmarks):
    """{name: {field: median}} over the repetitions of each name."""
    runs = {}
    for b in benchmarks:
        if b.get("run_type") != "aggregate" and not b.get("error_occurred"):
            runs.setdefault(b["name"], []).append(b)
    return {name: {key: statistics.median(r[key] for r in of if key in r)
                   for key in of[0] if isinstance(of[0][key], (int, float))} for name, of in runs.items()}


def short(value):
    """Three digits and a unit's prefix."""
    for prefix, size in (("G", 1e9), ("M", 1e6), ("k", 1e3)):
        if value >= size:
            return f"{value / size:.3g} {prefix}"
    return f"{value:.3g}"


def cell(results, name, field="items_per_second", form=short):
    value = results.get(name, {}).get(field)
    return form(value) if value is not None else ""


def times(value):
    return f"{value:.2f} x" if value < 10 else f"{value:.1f} x"


def percent(value):
    return f"{100 * value:.0f} %"


def table(head, rows):
    rows = [row for row in rows if any(row[1:])]
    if not rows:
        return []
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return lines + ["| " + " | ".join(row) + " |" for row in rows] + [""]


def peers(r):
    def row(what, name, limit=""):
        return [what, cell(r, name), cell(r, name, "x_opensubdiv", times), cell(r, name, "x_embree", times)]
    rows = []
    for path, what in (("api_evaluate", "regular quads, by patch"),
                       ("api_evaluate_irregular", "irregular quads, by patch"),
                       ("api_evaluate_shuffled", "regular quads, one sample a patch, shuffled")):
        rows += [row(f"{what}, {level}", f"{path}/{level}/float/4/tbb/1") for level in LEVELS]
    for path, order in (("nearest", "random order"), ("nearest_spatial", "in spatial order")):
        rows += [row(f"nearest, {p}, {order}", f"{path}/exact/{p}/4/tbb/1") for p in PRECISIONS]
    return table(["calls of both libraries, float, one thread", "a second", "of OpenSubdiv", "of Embree"], rows)


def calls(r):
    rows = []
    for level in LEVELS:
        for p in PRECISIONS:
            names = [f"{path}/{level}/{p}/4/tbb/1" for path in ("api_evaluate", "api_grid", "api_evaluate_shuffled")]
            rows.append([f"{level}, {p}"] + [cell(r, name) for name in names] +
                        [cell(r, name, "of_kernel", times) for name in names] +
                        [cell(r, name, "of_triad", percent) for name in names[:2]])
    for path in ("api_nearest", "api_track"):
        for p in PRECISIONS:
            name = f"{path}/exact/{p}/4/tbb/1"
            rows.append([f"{path[4:]}, exact, {p}", cell(r, name), "", "", cell(r, name, "of_kernel", times), "", "", "", ""])
    return table(["calls of the library, one thread, n = 4", "by patch", "grid", "shuffled", "of the kernel: by patch",
                  "grid", "shuffled", "of the triad's bandwidth: by patch", "grid"], rows)


def peer_rates(r):
    return table(["peer", "a second"], [[name[len("peer/"):], cell(r, name)] for name in r if name.startswith("peer/")])


def evaluate(r):
    rows = []
    for level in LEVELS:
        for p in PRECISIONS:
            name = f"evaluate/{level}/{p}/%d/tbb/%d"
            rows.append([f"{level}, {p}"] + [cell(r, name % (n, 1)) for n in SIDES] +
                        [cell(r, name % (4, 1), "x_exact", times), cell(r, name % (4, 1), "x_float", times),
                         cell(r, name % (4, 2), "x_one_thread", times)])
    return table(["points a second", *(f"n = {n}" for n in SIDES), "n = 4: of exact", "of float", "two threads of one"], rows)


def paths(r):
    rows = []
    for path in ("build", "build_checked", "nearest", "nearest_spatial", "track", "sweep", "load"):
        for p in PRECISIONS:
            one, two = (f"{path}/exact/{p}/4/tbb/{threads}" for threads in (1, 2))
            rows.append([f"{path}, {p}", cell(r, one), cell(r, two), cell(r, two, "x_one_thread", times),
                         cell(r, one, "solver_iterations", "{:.2f}".format), cell(r, one, "x_read", lambda v: times(1 / v))])
    return table(["exact, n = 4", "one thread", "two threads", "two of one", "iterations", "time, of reading the file"], rows)


def ticks(r):
    us = "{:.2f}".format
    return table(["tick, us", "median", "p99"],
                 [[p, cell(r, f"tick/exact/{p}/4/tbb/1", "p50_us", us), cell(r, f"tick/exact/{p}/4/tbb/1", "p99_us", us)]
                  for p in PRECISIONS])


def roofline(r):
    rows = []
    for name, of in r.items():
        path, level, _, n, *_ = name.split("/") + 4 * [""]
        if "of_peak" not in of or path == "evaluate_irregular" or (level == "bezier" and n in "56"):
            continue  # the same kernels again
        rows.append([name, short(of["items_per_second"]), f"{of['flops']:.0f}", f"{of['bytes']:.0f}",
                     short(of["flops"] * of["items_per_second"]), percent(of["of_peak"]),
                     percent(of["of_bandwidth"]) if "of_bandwidth" in of else ""])
    lines = table(["machine, at most", "one thread", "two threads"],
                  [[what, cell(r, f"machine/{path}/1") + unit, cell(r, f"machine/{path}/2") + unit]
                   for path, what, unit in (("fma/float", "fma, float", "flop/s"), ("fma/double", "fma, double", "flop/s"),
                                            ("read", "read", "B/s"), ("write", "write", "B/s"), ("triad", "triad", "B/s"))
                   if f"machine/{path}/1" in r])
    return lines + table(["kernel, one thread", "items a second", "flops", "bytes", "flop/s", "of the fma peak",
                          "of the triad's bandwidth"], rows)


def processor():
    for line in pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.machine()


def section(data):
    r, context = medians(data["benchmarks"]), data["context"]
    two = r.get("machine/fma/float/2", {}).get("x_one_thread")
    lines = [f"Made by `tools/bench.sh` on {context['date'][:10]}: {os.cpu_count()} cores of {processor()}, medians of the",
             "repetitions. Ratios are of turns taken in one run and carry over, absolute figures do not."]
    if two is not None and two < 1.9:
        lines.append(f"Two threads do {times(two)} the fma of one: **others used the machine**.")
    lines.append("")
    for title, part in (("Beside peers", peers(r) + peer_rates(r)), ("Calls", calls(r)), ("Evaluation of the kernels", evaluate(r)), ("The other paths", paths(r) + ticks(r)),
                        ("Roofline", roofline(r))):
        if part:
            lines += [f"### {title}", "", *part]
    return "\n".join(lines)


def main():
    text = section(json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8")))
    if len(sys.argv) < 3:
        print(text)
        return
    file = pathlib.Path(sys.argv[2])
    before, rest = file.read_text(encoding="utf-8").split(BEGIN)
    after = rest.split(END)[1]
    file.write_text(f"{before}{BEGIN}\n{text}\n{END}{after}", encoding="utf-8")


if __name__ == "__main__":
    main()
