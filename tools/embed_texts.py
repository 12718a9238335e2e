#!/usr/bin/env python3
"""Writes files as C++ strings. usage: embed_texts.py ROOT OUT.cpp HEADER SUFFIX FILE ...

kernels/build.cl with the suffix Program becomes gliss::kBuildProgram, which HEADER declares. Includes of kernels are
put in place; #line tells compilers which file of ours they read."""
import pathlib
import re
import sys

root, out, header, suffix, *names = sys.argv[1:]


def flatten(name):
    lines = [f'#line 1 "{name}"']
    for number, line in enumerate((pathlib.Path(root) / name).read_text().splitlines(), 1):
        include = re.match(r'#include "(.*)"', line)
        if include:
            lines += flatten(include.group(1)) + [f'#line {number + 1} "{name}"']
        else:
            lines.append(line)
    return lines


def text_of(name):
    if name.endswith(".cl"):
        return "\n".join(flatten(name)) + "\n"
    return (pathlib.Path(root) / name).read_text(encoding="utf-8")


parts = [f'#include "{header}"', "", "namespace gliss {", ""]
for name in names:
    text = text_of(name)
    if ')embed"' in text:
        sys.exit(f'{name}: holds )embed", which ends a string here')
    parts.append(f'const char* const k{pathlib.Path(name).stem.capitalize()}{suffix} = R"embed({text})embed";\n')
parts.append("}  // namespace gliss")
pathlib.Path(out).write_text("\n".join(parts) + "\n", encoding="utf-8")
