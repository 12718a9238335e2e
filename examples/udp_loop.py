"""A loop in Python's standard library on a device that Gliss serves: a wall of 300 N/m at z = 0.01 m, for a while.

    gliss serve scene.toml --device sim --port 10002 &
    python3 udp_loop.py 10002 2

The datagrams are those of gliss/device/udp_protocol.h, little-endian; another language packs the same."""
import os
import socket
import struct
import sys
import time

WALL, STIFFNESS, MOST = 0.01, 300, 2  # m, N/m, N
STATE = struct.Struct("<IHHQQq3d3ddd3d3d")  # magic version flags session sequence measured position velocity ...
FORCE = struct.Struct("<IHHQQq3d16s")       # magic version flags sequence answers sent force pass
BYE, ENDED = 1, 4


def pass_of(port):
    """What proves that this is the user who serves the device."""
    for path in (f"/run/user/{os.geteuid()}/gliss-udp-{port}", f"/tmp/gliss-{os.geteuid()}/udp-{port}",
                 os.path.expanduser(f"~/.gliss/udp-{port}")):
        if os.path.exists(path):
            with open(path, "rb") as file:
                return file.read()
    sys.exit(f"udp:{port}: nobody of this user serves a device there")


def main(port, seconds):
    link, own = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), pass_of(port)
    link.connect(("127.0.0.1", port))
    link.settimeout(0.001)
    sequence, answers, force, most, states = 0, 0, 0.0, 0.0, 0
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        sequence += 1
        link.send(FORCE.pack(0x46534C47, 1, 0, sequence, answers, time.monotonic_ns(), 0, 0, force, own))
        try:
            state = link.recv(1024)
        except (TimeoutError, socket.timeout):
            continue  # the device's own watchdog takes a force away that is not renewed for 20 ms
        if len(state) != STATE.size:
            sys.exit(f"udp:{port}: answers what is not a state of a device that does not turn")
        _, _, flags, _, answers, _, _, _, z, *_ = STATE.unpack(state)
        if flags & ENDED:
            break
        states += 1
        force = min(MOST, STIFFNESS * max(0.0, WALL - z))
        most = max(most, force)
    link.send(FORCE.pack(0x46534C47, 1, BYE, sequence + 1, answers, time.monotonic_ns(), 0, 0, 0, own))
    print(f"{states} states, at most {most:.2f} N")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: udp_loop.py PORT SECONDS")
    main(int(sys.argv[1]), float(sys.argv[2]))
