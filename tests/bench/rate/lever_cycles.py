#!/usr/bin/env python3
"""lever_cycles.py IMAGE QEMU.. - instructions and cycles of a tick of the AFM lever on a Cortex-M7.

It traces the image (lever_board.c) in the emulator QEMU.., instruction by instruction, and gives two periods of
the trace, in whole blocks of ticks, to llvm-mca with LLVM's model of the Cortex-M7. That model is no measurement:
memory answers at once, branches are free. llvm-mca does not know the part's comparisons; a negation takes their
place. Needs llvm and qemu-system-arm."""
import collections
import os
import re
import subprocess
import sys
import tempfile

TICKS = 48                  # at least, two periods
LOOK = "output"             # the lock-in reads the model's outputs once in a tick
LISTENING = {LOOK, "hear", "listen", "listen_ticks"}
METHODS = ["rk4", "adams", "rk4_float32"]  # one after the other in the image
TARGET = ["--triple=thumbv7em-none-eabihf", "--mcpu=cortex-m7"]
BRANCH = re.compile(r"(b|bl|cbz|cbnz)(eq|ne|lt|gt|le|ge|hi|ls|hs|lo|mi|pl|vs|vc)?(\.w|\.n)?$")


def trace(image, qemu):
    """(address, function) of each instruction that was executed."""
    with tempfile.TemporaryDirectory() as directory:
        path = os.path.join(directory, "trace")
        subprocess.run([*qemu, "-icount", "shift=10", "-serial", "null", "-nic", "none", "-singlestep", "-d", "exec,nochain",
                        "-D", path], stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=120)
        with open(path) as f:
            found = [re.match(r"Trace 0: \S+ \[\w+/(\w+)/\w+/\w+\] (\S*)", line) for line in f]
    return [(int(m.group(1), 16), m.group(2)) for m in found if m]


def text_of(image):
    """The instruction at each address."""
    out = subprocess.run(["llvm-objdump", "-d", "--no-show-raw-insn", *TARGET, image], capture_output=True, text=True).stdout
    found = [re.match(r"\s*([0-9a-f]+):\s+(.*)", line) for line in out.splitlines()]
    return {int(m.group(1), 16): re.sub(r"[<@].*", "", m.group(2)).strip() for m in found if m}


def for_model(text):
    """The instruction as llvm-mca takes it, without its condition; None: nothing is executed."""
    operation = text.split()[0]
    if operation.startswith("it"):
        return None
    if BRANCH.match(operation):
        return "b #4"
    text = re.sub(r"^blx", "bx", text)
    text = re.sub(r"^(vmov)(pl|mi|gt|le|eq|ne)\.", r"\1.", text)
    text = re.sub(r"^vcmpe?\.f32(\s+)(s\d+), .*", r"vneg.f32 s31, \2", text)
    return re.sub(r"^vcmpe?\.f64(\s+)(d\d+), .*", r"vneg.f64 d15, \2", text)


def cycles(lines, n_ticks):
    p = subprocess.run(["llvm-mca", "-march=thumb", "-mattr=+thumb2", "-mcpu=cortex-m7", "-iterations=1"],
                       input="\n".join(lines) + "\n", capture_output=True, text=True)
    found = re.search(r"Total Cycles:\s+(\d+)", p.stdout)
    if not found:
        sys.exit("FAIL  llvm-mca: " + p.stderr[:300])
    return int(found.group(1)) / n_ticks


def tell(method, steps, n_ticks, text):
    count = collections.Counter(name for _, name in steps)
    for part, n in [*count.most_common(), ("tick", len(steps))]:
        lines = [for_model(text[address]) for address, name in steps if part in (name, "tick")]
        print("%s,%s,%.0f,%.0f" % (method, part, n / n_ticks, cycles([line for line in lines if line], n_ticks)))


def window(steps, looks):
    """From one block of ticks to another: a block is moved first, and then looked at. The last block may be short."""
    first = [i for i in range(1, len(looks)) if any(name not in LISTENING for _, name in steps[looks[i - 1]:looks[i]])]
    return max(i for i in first if i <= first[-2] - TICKS), first[-2]


def main():
    image, qemu = sys.argv[1], sys.argv[2:]
    steps, text = trace(image, qemu), text_of(image)
    begin = min(address for address, name in steps if name == LOOK)
    all_looks = [i for i, (address, _) in enumerate(steps) if address == begin]
    each = len(all_looks) // len(METHODS)
    print("method,part,instructions,cycles")
    for i, method in enumerate(METHODS):
        looks = all_looks[i * each:(i + 1) * each]
        begin, end = window(steps, looks)
        tell(method, steps[looks[begin]:looks[end]], end - begin, text)


if __name__ == "__main__":
    main()
