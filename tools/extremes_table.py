"""Rewrites EXTREMES.md with the rows that tests/extremes/extremes.h adds: group, what, samples, goal, worst, limited by.

Usage: extremes_table.py ROWS EXTREMES.md [--whole]: rows that were not measured again stay, but with --whole.
"""
import datetime
import pathlib
import sys

HEADER = "| what | samples | worst | goal | |\n|---|---|---|---|---|"
measured, page = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
groups = {}  # {group: {what: its line}}
group = None
for line in page.read_text(encoding="utf-8").splitlines() if "--whole" not in sys.argv else []:
    if line.startswith("## "):
        group = groups.setdefault(line[3:], {})
    elif line.startswith("| ") and line not in HEADER:
        group[line[2:].split(" | ")[0]] = line
for line in measured.read_text(encoding="utf-8").splitlines():
    name, what, count, goal, worst, limit = line.split("\t")
    worst = f"**{worst}**" if limit else worst
    groups.setdefault(name, {})[what] = f"| {what} | {int(count):,} | {worst} | {goal} | {limit} |"
text = f"""# The extremes

Made by `tools/extremes.sh` on {datetime.date.today()}: the worst value of each bound over all samples, beside its
goal. A goal that is missed is bold and says why.
"""
for name, rows in groups.items():
    text += "\n".join([f"\n## {name}\n\n{HEADER}", *rows.values(), ""])
page.write_text(text, encoding="utf-8")
