"""Prints EXTREMES.md of the rows that tests/extremes.h adds: group, what, samples, goal, worst, limited by."""
import datetime
import pathlib
import sys

rows = [line.split("\t") for line in pathlib.Path(sys.argv[1]).read_text(encoding="utf-8").splitlines()]
groups = {}
for group, what, count, goal, worst, limit in rows:
    groups.setdefault(group, []).append((what, int(count), goal, worst, limit))
print("# The extremes\n")
print(f"Made by `tools/extremes.sh` on {datetime.date.today()}: the worst value of each bound over all samples, beside its")
print("goal. A goal that is missed is bold and says why.")
for group, bounds in groups.items():
    print(f"\n## {group}\n\n| what | samples | worst | goal | |\n|---|---|---|---|---|")
    for what, count, goal, worst, limit in bounds:
        print(f"| {what} | {count:,} | {f'**{worst}**' if limit else worst} | {goal} | {limit} |")
