#!/usr/bin/env python3
"""The work of tools/mutate.sh. usage: mutants.py apply|run|table FOLDER [NAME ...], mutants.py tests FILE ...

apply  puts all mutants of tests/mutants.txt into the copy of the tree in FOLDER/tree, each behind its number
run    runs the tests with one mutant after the other, and adds a line for each to FOLDER/results.txt
table  prints these results as Markdown
tests  prints the tests of files of the source, as gtest_filter takes them
"""
import collections
import os
import pathlib
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
# What runs programs, other processes or devices, measures time, or compares with code that has no mutants.
LEFT_OUT = ("*OpenCl*:*opencl*:Program*:UdpKill*:*Strace*:FaultInjection*:Realtime*:Run*:Judge.reports*:Judge.says*:"
            "Judge.stops*:HostileProgram*:HostileEnds*:Report*:AllocationFailure*:*Freshness*:Periodic*")
Mutant = collections.namedtuple("Mutant", "number name file before original mutated after stages reason")


def read_list(tree):
    """The stages, and the mutants in their order; as a tree has them."""
    stages, mutants, file, names = {}, [], "", []
    text = (tree / "tests/mutants.txt").read_text()
    for line in re.sub(r"\n +", " ", text).splitlines():  # what is indented goes on
        if not line or line.startswith("#"):
            continue
        if found := re.fullmatch(r"stage (\w+): (\S+)", line):
            stages[found[1]] = found[2]
        elif found := re.fullmatch(r"(\S+): ([\w ]+)", line):
            file, names = found[1], found[2].split()
        elif line.startswith("!"):
            mutants[-1] = mutants[-1]._replace(reason=line[1:].strip())
        elif found := re.fullmatch(r"(\S+)\s+(.*?)\{\{(.*?) =>(.*?)\}\}(.*)", line):
            name, *piece = (part.strip() for part in found.groups())
            mutants.append(Mutant(len(mutants) + 1, name, file, *piece, names, ""))
        else:
            sys.exit(f"mutants.txt: {line}")
    return stages, mutants


def squeezed(text):
    """A text without white space, and where each of its letters was."""
    places = [i for i, letter in enumerate(text) if not letter.isspace()]
    return "".join(text[i] for i in places), places


def place_of(mutant, text):
    """Where the original begins and ends in a file's text; None where its piece is not there exactly once."""
    flat, places = squeezed(text)
    before, original, after = (squeezed(part)[0] for part in (mutant.before, mutant.original, mutant.after))
    piece = before + original + after
    if flat.count(piece) != 1:
        return None
    first = flat.index(piece) + len(before)
    return places[first], places[first + len(original) - 1] + 1


def choice(mutant, text):
    if mutant.original.endswith(";"):
        return f"if (gliss_mutant == {mutant.number}) {{ {mutant.mutated} }} else {{ {text} }}"
    return f"(gliss_mutant == {mutant.number} ? ({mutant.mutated}) : ({text}))"


def with_mutants(mutants, text):
    places = []
    for mutant in mutants:
        if place := place_of(mutant, text):
            places.append((*place, mutant))
        else:
            print(f"{mutant.name}: {mutant.file} does not have its piece once", file=sys.stderr)
    for begin, end, mutant in sorted(places, reverse=True, key=lambda place: place[0]):
        text = text[:begin] + choice(mutant, text[begin:end]) + text[end:]
    return text


def apply(folder):
    tree = folder / "tree"
    header = tree / "gliss_mutant.h"
    write(header, "#pragma once\n#include <cstdlib>\n"
          "// The number of the mutant that this run has.\n"
          "inline const int gliss_mutant = [] {\n"
          '  const char* text = std::getenv("GLISS_MUTANT");\n'
          "  return text != nullptr ? std::atoi(text) : 0;\n}();\n")
    by_file = collections.defaultdict(list)
    for mutant in read_list(ROOT)[1]:
        by_file[mutant.file].append(mutant)
    names = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT, text=True,
                           capture_output=True, check=True).stdout.split("\0")
    for name in filter(None, names):
        source = ROOT / name
        if not source.is_file():
            continue
        text = source.read_bytes().decode("latin-1")
        if name in by_file:
            text = with_mutants(by_file[name], text)
        if name == "kernels/real.h":  # no variable there
            text = text.replace("#ifdef __OPENCL_C_VERSION__\n", "#ifdef __OPENCL_C_VERSION__\n#define gliss_mutant 0\n", 1)
        # All kernels are compiled with one file.
        if name == "host/surface/instances_isa.cpp" or (name in by_file and not name.startswith("kernels/")):
            text = f'#include "{header.resolve()}"\n#line 1\n' + text
        write(tree / name, text)


def write(path, text):
    """Leaves a file alone that has this text, so that it is not compiled again. Bytes beyond ASCII stand as latin-1."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_bytes() != text.encode("latin-1"):
        path.write_bytes(text.encode("latin-1"))


def run_stage(folder, number, tests, limit):
    """None where all tests pass, else the one that does not; and the seconds."""
    began = time.monotonic()
    command = ["build-dev/tests/gliss_tests", f"--gtest_filter={tests}-{LEFT_OUT}", "--gtest_fail_fast"]
    try:
        done = subprocess.run(command, cwd=folder / "tree", env={**os.environ, "GLISS_MUTANT": str(number)}, text=True,
                              errors="replace", stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=limit)
        output, code = done.stdout, done.returncode
    except subprocess.TimeoutExpired as late:
        output, code = (late.stdout or b"").decode(errors="replace"), "time"
    seconds = time.monotonic() - began
    if code == 0:
        return None, seconds
    ran = re.findall(r"^\[ RUN      \] (\S+)", output, re.M)
    failed = re.findall(r"^\[  FAILED  \] ([^\s,]+)", output, re.M)
    test = failed[0] if failed else ran[-1] if ran else "?"
    return test if code == 1 else f"{test} ({'does not end' if code == 'time' else f'signal {-code}'})", seconds


def read_results(folder):
    results, path = {}, folder / "results.txt"
    if path.exists():
        for line in path.read_text().splitlines():
            name, *rest = line.split("\t")
            results[name] = rest
    return results


def run(folder, names):
    stages, mutants = read_list(folder / "tree")
    results = read_results(folder)

    def add(name, *words):
        results[name] = list(words)
        with open(folder / "results.txt", "a") as file:
            file.write("\t".join((name, *words)) + "\n")
        print(name, *words, flush=True)

    unknown = set(names) - {mutant.name for mutant in mutants}
    if unknown:
        sys.exit(f"no mutant has the name {', '.join(sorted(unknown))}")
    for mutant in mutants:
        if mutant.name not in names if names else mutant.name in results:
            continue
        if not re.search(rf"gliss_mutant == {mutant.number}\b", (folder / "tree" / mutant.file).read_text()):
            print(mutant.name, "has no place", flush=True)
            continue
        spent = 0
        for stage in mutant.stages:
            if stage not in (key.removeprefix("stage ") for key in results):  # without a mutant
                test, seconds = run_stage(folder, 0, stages[stage], None)
                if test is not None:
                    sys.exit(f"{test} fails without a mutant")
                add(f"stage {stage}", f"{seconds:.0f} s")
            limit = 20 + 5 * float(results[f"stage {stage}"][0].split()[0])
            test, seconds = run_stage(folder, mutant.number, stages[stage], limit)
            spent += seconds
            if test is not None:
                add(mutant.name, "killed", test, f"{spent:.0f} s")
                break
        else:
            add(mutant.name, "survives", "", f"{spent:.0f} s")


def table(folder):
    mutants = read_list(ROOT)[1]
    results = read_results(folder)
    ran = [m for m in mutants if m.name in results]
    killed = [m for m in ran if results[m.name][0] == "killed"]
    survive = [m for m in ran if results[m.name][0] != "killed"]
    cell = lambda text: text.replace("|", "\\|")
    print("# Mutants\n")
    print("<!-- made by tools/mutate.sh --table: do not edit; the mutants and the reasons are in mutants.txt -->\n")
    print(f"`tools/mutate.sh` ran {len(ran)} of the {len(mutants)} mutants of [mutants.txt](mutants.txt) in a build of "
          f"the preset `dev`,\nwithout what tests that need further meshes, programs, devices or real time hold. The tests"
          f" notice {len(killed)}; {len(survive)} survive.\nWhy they do is reasoned, not measured.\n")
    print("## Those that survive\n\n| file | mutant | instead of | it has | why |\n|---|---|---|---|---|")
    for m in survive:
        print(f"| `{m.file}` | {m.name} | `{cell(m.original)}` | `{cell(m.mutated)}` | {cell(m.reason) or 'not known yet'} |")
    print("\n## Those that are noticed\n\n| file | mutant | the test that failed first |\n|---|---|---|")
    for m in killed:
        print(f"| `{m.file}` | {m.name} | `{results[m.name][1]}` |")
    left = [m.name for m in mutants if m not in ran]
    if left:
        print(f"\nNot run yet, for they take an hour of a processor: {', '.join(left)}.")


def tests(files):
    stages, _ = read_list(ROOT)
    text, filters = (ROOT / "tests/mutants.txt").read_text(), ["Revision.*"]
    for file in files:
        found = re.search(rf"^{re.escape(file)}: ([\w ]+)$", text, re.MULTILINE)
        if not found:
            sys.exit(f"tests/mutants.txt names no tests of {file}: run all")
        filters += [stages[stage] for stage in found[1].split() if stages[stage] not in filters]
    print(":".join(filters))


if __name__ == "__main__":
    what, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    if what == "tests":
        tests(sys.argv[2:])
    elif what == "apply":
        apply(folder)
    elif what == "run":
        run(folder, sys.argv[3:])
    else:
        table(folder)
