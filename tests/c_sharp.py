"""The hand in C# prints what the one in C does, and says what the library says of a call that fails. Skipped without
mono. usage: c_sharp.py LIBRARY INCLUDES EXAMPLES GLISS"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

library, includes, examples, gliss = (pathlib.Path(word).resolve() for word in sys.argv[1:])
if not shutil.which("mcs") or not shutil.which("mono"):
    print("skipped: no mono: install mono-mcs and mono-runtime")
    sys.exit(77)

with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    environment = {**os.environ, "LD_LIBRARY_PATH": str(library.parent)}

    def run(*words, code=0):
        result = subprocess.run([str(word) for word in words], cwd=folder, env=environment, capture_output=True, text=True,
                                check=False)
        if result.returncode != code:
            sys.exit(f"{words}: {result.returncode}\n{result.stdout}{result.stderr}")
        return result.stdout if code == 0 else result.stderr

    run("cc", "-std=c99", f"-I{includes}", examples / "hand.c", library, "-o", "hand")
    run("mcs", "-warnaserror", "-warn:4", "-out:Hand.exe", examples / "Hand.cs")
    run(gliss, "generate", "goldberg", "-o", "b\u00e4ll.obj")  # a name that is not ASCII
    in_c, in_sharp = run("./hand", "b\u00e4ll.obj", "0.001"), run("mono", "Hand.exe", "b\u00e4ll.obj", "0.001")
    if in_c != in_sharp or len(in_c.splitlines()) != 13:
        sys.exit(f"in C:\n{in_c}in C#:\n{in_sharp}")
    told = run("mono", "Hand.exe", "none.obj", "0.001", code=1)
    if "Hand: none.obj: " not in told or run("./hand", "none.obj", "0.001", code=1) != told.replace("Hand: ", "hand: "):
        sys.exit(f"of a file that is not there it says {told}")
    told = run("mono", "Hand.exe", "b\u00e4ll.obj", "-1", code=1)
    if "unit" not in told:
        sys.exit(f"of a unit below 0 it says {told}")
