"""What pictures say of the source, taken from it: numbers, and names that must be there."""
import re
import sys


class Source:
    def __init__(self, root):
        self.root = root

    def read(self, path):
        return (self.root / path).read_text(encoding="utf-8")

    def find(self, path, pattern):
        """The first group of a pattern that occurs in a file."""
        found = re.search(pattern, self.read(path))
        if not found:
            sys.exit(f"tools/pictures: {path} has no '{pattern}': the picture that shows it has to change")
        return found.group(1)

    def number(self, path, name):
        """The number that a constant or a member of the file has, as it is written but for digits' marks."""
        value = self.find(path, rf"\b{name}\b(?: =|\{{|\s*K?\(?)\s*([\d'.e-]+)")
        return float(value.replace("'", ""))

    def name(self, path, name):
        """A name for the picture: it stands in the file, each of its words."""
        for word in re.findall(r"\w+", name):
            self.find(path, rf"\b({word})\b")
        return name
