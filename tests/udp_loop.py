"""The loop in Python touches its wall with the hand that gliss serve simulates, and the hand is let go at its end.
usage: udp_loop.py EXAMPLE GLISS"""
import json
import pathlib
import re
import signal
import subprocess
import sys
import tempfile

example, gliss = (pathlib.Path(word).resolve() for word in sys.argv[1:])
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    subprocess.run([gliss, "generate", "goldberg", "-o", "ball.obj"], cwd=folder, check=True, capture_output=True)
    (folder / "hand.csv").write_text("x_mm,y_mm,z_mm\n0,0,14\n0,0,4\n0,0,14\n")
    (folder / "scene.toml").write_text("""[[object]]
mesh = 'ball.obj'
unit = 'mm'
[sim]
path = 'hand.csv'
interval = 0.5
rounds = 1000
""")
    with subprocess.Popen([gliss, "serve", "scene.toml", "--device", "sim", "--port", "0", "--json"], cwd=folder, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE) as server:
        port = re.search(r"udp:(\d+)", server.stderr.readline())
        if not port:
            server.kill()
            sys.exit("gliss serve tells no port")
        loop = subprocess.run([sys.executable, example, port[1], "1.5"], capture_output=True, text=True, check=False)
        server.send_signal(signal.SIGINT)
        counts = json.loads(server.communicate()[0])
    told = re.fullmatch(r"(\d+) states, at most ([\d.]+) N\n", loop.stdout)
    if loop.returncode or not told:
        sys.exit(f"{example}: {loop.returncode}\n{loop.stdout}{loop.stderr}")
    if int(told[1]) < 100 or not 0.3 < float(told[2]) <= 2:
        sys.exit(f"it felt too little: {loop.stdout}")
    if counts["loops"] < 1 or counts["received"] < 100 or counts["rejected"]:  # a busy machine holds it up now and then
        sys.exit(f"gliss serve did not take its forces: {counts}")
    nobody = subprocess.run([sys.executable, example, port[1], "1"], capture_output=True, text=True, check=False)
    if nobody.returncode == 0 or "nobody of this user serves" not in nobody.stderr:
        sys.exit(f"where nothing is served it says: {nobody.stdout}{nobody.stderr}")
