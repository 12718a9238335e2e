"""Which rooms see which, by the -I that they are compiled with."""
import json
import pathlib
import shlex


def searches_of(entry):
    """The compiler of a command, and where that looks for headers."""
    words = entry.get("arguments") or shlex.split(entry["command"])
    compiler = words[1] if words[0].endswith("ccache") else words[0]
    searches = [word for word in words if word.startswith("-I")]
    for option, folder in zip(words, words[1:]):
        if option == "-isystem":
            searches += [option, folder]
    return compiler, searches


def library_rooms(root):
    """The folders of the rooms that libraries are made of."""
    return [room for top in ("host", "runtime") for room in (root / top).iterdir() if room.is_dir()]


def program_rooms(root):
    """Those of the program."""
    return [*(room for room in (root / "tools" / "cli").iterdir() if room.is_dir()),
            *(root / "tools" / room for room in ("report", "view"))]


class Rooms:
    """Of these folders. headers: one of each room. compiled: its compiler and searches. seen: the rooms that it sees,
    and those that they see; with itself."""

    def __init__(self, commands, root, folders):
        programs = program_rooms(root)  # their headers go by their paths
        self.headers = {room.name: f"{room.relative_to(root) if room in programs else f'gliss/{room.name}'}/"
                                   f"{sorted(room.glob('*.h'))[0].name}" for room in folders}
        self.compiled = {}
        for entry in json.loads(commands.read_text(encoding="utf-8")):
            source = (pathlib.Path(entry["directory"]) / entry["file"]).resolve()
            # instances_isa.cpp sees the kernels, too.
            if source.parent in folders and source.name != "instances_isa.cpp":
                self.compiled[source.parent.name] = searches_of(entry)
        self.seen = {room: {other for other, header in self.headers.items() if self._finds(room, header)}
                     for room in self.compiled}

    def _finds(self, room, header):
        return any((pathlib.Path(word[2:]) / header).exists()
                   for word in self.compiled[room][1] if word.startswith("-I"))

    def not_compiled(self):
        return self.compiled.keys() ^ self.headers.keys()

    def used(self, room):
        """The rooms that it sees for itself, not by another that it sees."""
        others = self.seen[room] - {room}
        return sorted(other for other in others
                      if not any(other in self.seen[between] for between in others - {other}))
