#!/usr/bin/env python3
"""Draws the pictures of docs/architecture.md. A test holds that those in docs/pictures are what this draws.

Usage: tools/pictures/draw.py build/compile_commands.json
"""
import pathlib
import sys

import draw_patch
import draw_rooms
import draw_seam
import draw_tick
import draw_tile
from seen_rooms import Rooms, library_rooms
from source import Source


def pictures(commands, root):
    """{file name: its text}, from the sources in `root` and how they are compiled."""
    source = Source(root)
    drawn = {f"{module.__name__.removeprefix('draw_')}.svg": module.draw(source)
             for module in (draw_tile, draw_seam, draw_patch, draw_tick)}
    drawn["rooms.svg"] = draw_rooms.draw(source, Rooms(commands, root, library_rooms(root)))
    return drawn


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    root = pathlib.Path(__file__).resolve().parents[2]
    folder = root / "docs" / "pictures"
    folder.mkdir(exist_ok=True)
    for name, text in pictures(pathlib.Path(sys.argv[1]), root).items():
        (folder / name).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
