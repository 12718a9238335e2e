#!/usr/bin/env python3
"""Writes kernel programs as C++ strings. usage: embed_kernels.py ROOT OUT.cpp PROGRAM.cl ...

Includes are put in place; #line tells compilers which file of ours they read."""
import pathlib
import re
import sys

root, out, *programs = sys.argv[1:]


def flatten(name):
    lines = [f'#line 1 "{name}"']
    for number, line in enumerate((pathlib.Path(root) / name).read_text().splitlines(), 1):
        include = re.match(r'#include "(.*)"', line)
        if include:
            lines += flatten(include.group(1)) + [f'#line {number + 1} "{name}"']
        else:
            lines.append(line)
    return lines


parts = ['#include "host/opencl_device.h"', "", "namespace gliss {", ""]
for program in programs:
    text = "\n".join(flatten(program))
    parts.append(f'const char* const k{pathlib.Path(program).stem.capitalize()}Program = R"cl({text}\n)cl";\n')
parts.append("}  // namespace gliss")
pathlib.Path(out).write_text("\n".join(parts) + "\n")
