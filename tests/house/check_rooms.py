#!/usr/bin/env python3
"""check_rooms.py - a room includes only rooms below it. The floors stand here, the lowest first; a room is a folder of firmware, hal or
host_sim (with the folders in it), all of models, or a file beside those folders. So rooms can have no circle. And a .c file has a header of its own name, but for few: main files, commands (host_sim/commands.h has them
all), and files that share one interface (board.h, contactplant.h, fmi3.h, check.h)."""
import pathlib
import re
import sys

FLOORS = """
models hal/hal hal/device host_sim/version host_sim/commands host_sim/out
firmware/method hal/link hal/can host_sim/batch
firmware/plant hal/posix hal/ethernet
firmware/bus hal/board host_sim/beside
firmware/stage
firmware/observe firmware/afm
firmware/app
firmware/main host_sim/cli
host_sim/scene host_sim/database
host_sim/report host_sim/afm host_sim/plants host_sim/listen host_sim/help
host_sim/maps host_sim/replay
host_sim/merge host_sim/live host_sim/choose host_sim/fit host_sim/view
host_sim/test host_sim/library
host_sim/simulate host_sim/fmu host_sim/scope
host_sim/run host_sim/demo
host_sim/list host_sim/main
"""
HEADERLESS = 15  # files beside the commands; may only fall
FLOOR = {room: i for i, line in enumerate(FLOORS.strip().splitlines()) for room in line.split()}
INCLUDE = re.compile(r'#include "((?:models|firmware|hal|host_sim)/[^"]+)"')


def room_of(path):
    parts = pathlib.PurePath(path).with_suffix("").parts
    return "models" if parts[0] == "models" else "/".join(parts[:2])


def breaches(path):
    room = room_of(path)
    if room not in FLOOR:
        yield f"{path}: room {room} has no floor: give it one in tests/house/check_rooms.py"
        return
    for n, line in enumerate(path.read_text().splitlines(), 1):
        found = INCLUDE.match(line)
        other = room_of(found[1]) if found else room
        if other != room and FLOOR.get(other, len(FLOOR)) >= FLOOR[room]:
            yield f"{path}:{n}: room {room} must not include room {other}, which is not below it"


files = sorted(f for top in ("models", "firmware", "hal", "host_sim") for f in pathlib.Path(top).rglob("*.[ch]"))
bad = [b for f in files for b in breaches(f)]
bare = [f for f in files if f.suffix == ".c" and not f.with_suffix(".h").exists()]
alone = [f for f in bare if not re.search(r"^int cmd_", f.read_text(), re.M)]
for b in bad:
    print(f"FAIL  {b}")
if len(alone) > HEADERLESS:
    print(f"FAIL  {len(alone)} .c files have no header of their own, {HEADERLESS} may: give yours one, or fold it into its neighbour:", *alone)
else:
    print(f"ok    {len(alone)} .c files without a header of their own, at most {HEADERLESS}; and {len(bare) - len(alone)} commands")
if not bad:
    print(f"ok    {len(FLOOR)} rooms on {max(FLOOR.values()) + 1} floors include only rooms below them ({len(files)} files)")
sys.exit(bool(bad) or len(alone) > HEADERLESS)
