#!/usr/bin/env python3
"""stack_depth.py BOARD IMAGE TOOLS-PREFIX OBJECT-DIRECTORY - the deepest stack that an image can need, and the calls that lead there.

What a function takes is what the compiler says (-fstack-usage, files .su); for those of the compiler's own library, what
they push. Who calls whom is read from the disassembly; where a call goes through a pointer, from INDIRECT: the
functions of a file whose address is taken anywhere. Recursion, stack of no fixed size and a pointer call with nowhere to go
are refused. An interrupt comes on top. The limit is the fourth column of tests/data/board_limits.txt, if there is one.
"""
import re
import subprocess
import sys

# By the caller, FILE:FUNCTION, the first that fits: files, and functions in them, that it may call through a pointer.
MODELS = (r"models/.*", r".*")
STEP, REFUSE, SET_UP = r"step.*|run_a\w+|books|switched", r"(exact_)?refuse\w*", r"(refuse\w*|prepare|bind\w*|n_scratch|exact_\w+)(\..*)?"
KINDS = r"firmware/method/(rk4|float32/rk4_float32|taylor/taylor|exact/exact|exact/exact_tables|adams/adams)\.c"
INDIRECT = [
    (r"firmware/method/switch\.c:.*", [(r"firmware/method/(float32/)?rk4\w*\.c", r"advance_general|run_through"), MODELS]),
    (r"firmware/method/rk4_unlocated\.c:.*", [(r"firmware/method/rk4\.c", r"step.*|refuse|bind"), MODELS]),
    (r"firmware/method/(float32/|taylor/|exact/|adams/)?(rk4|taylor|exact|adams)\w*\.c:.*", [MODELS]),
    (r"firmware/method/auto\.c:run_adams", [(r"firmware/method/adams/adams\.c", r"run_any|bind_run")]),
    (r"firmware/method/auto\.c:(step|books|switched).*", [(KINDS, STEP)]),
    (r"firmware/method/auto\.c:(choose|refuse).*", [(KINDS, REFUSE), MODELS]),
    (r"firmware/method/auto\.c:.*", [(KINDS, SET_UP), MODELS]),
    (r"firmware/plant/plant_change\.c:(plant_check|plant_find_regime).*", [MODELS]),
    (r"firmware/plant/plant_change\.c:derive.*", [(KINDS, REFUSE), (r"firmware/method/auto\.c", REFUSE), MODELS]),
    (r"firmware/plant/plant\.c:(integrate|plant_advance|cut).*",
     [(KINDS, STEP), (r"firmware/method/auto\.c", STEP), (r"firmware/plant/ledger\.c", r"piece.*"), MODELS]),
    (r"firmware/plant/plant_change\.c:.*", [(KINDS, SET_UP), (r"firmware/method/auto\.c", SET_UP), MODELS]),
    (r"models/scenes/scenes\.c:.*", [(r"models/(?!scenes).*", r".*")]),
    (r"firmware/.*", [MODELS, (r"hal/.*", r".*")]),
    (r"hal/ethernet/(net|ipv4)\.c:.*", [(r"hal/ethernet/lan9118\.c", r".*")]),
    (r"hal/ethernet/lan9118\.c:.*", [(r"hal/device/registers\.c", r".*")]),
    (r"hal/.*", [(r"hal/.*", r"(\w+_)?(read|write|clock|now_us)\w*(\..*)?")]),
]
# Interrupts, and the registers that the processor itself pushes for them (Armv7-M with FPU, aligned).
INTERRUPTS = {"cortex_m_tick": 112}


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


class Function:
    def __init__(self, name, file):
        self.name, self.file = name, file
        self.own = self.pushed = 0
        self.calls, self.jumps = set(), False
        self.depth = self.next = None


def functions_of(image, prefix):
    found = {}
    for line in run(prefix + "nm", "-l", "--defined-only", image).splitlines():
        m = re.match(r"([0-9a-f]+) [tTwW] ([^\s$]\S*)(?:\t(\S+):\d+)?", line)
        if m:
            file = re.search(r"(?:models|firmware|hal|linker|tests)/[\w/]+\.c$", m.group(3) or "")
            found[int(m.group(1), 16) & ~1] = Function(m.group(2), file.group() if file else "")
    return found


def pushed(mnemonic, operands):
    """Bytes that an Arm instruction takes from the stack."""
    if mnemonic.startswith(("push", "stmdb")) and ("sp!" in operands or mnemonic.startswith("push")):
        return 4 * sum(2 if r.startswith("d") else 1 for r in re.findall(r"\w+", operands.split("{")[-1]))
    m = re.match(r"sp, (?:sp, )?#(\d+)", operands)
    return int(m.group(1)) if m and mnemonic.startswith("sub") else 0


def read_calls(image, prefix, functions):
    here = None
    for line in run(prefix + "objdump", "-d", "--no-show-raw-insn", image).splitlines():
        head = re.match(r"([0-9a-f]+) <", line)
        if head:
            here = functions.get(int(head.group(1), 16) & ~1, here)
        m = re.match(r"\s*[0-9a-f]+:\t(\S+)\s*(.*)", line)
        if not m or not here:
            continue
        mnemonic, operands = m.groups()
        here.pushed += pushed(mnemonic, operands)
        target = re.search(r"\b([0-9a-f]+) <[^+>]+>", operands)
        if re.match(r"(b|j|cb|tail|call)", mnemonic) and target:
            to = functions.get(int(target.group(1), 16) & ~1)
            if to and (to is not here or re.match(r"(bl|jal|call)", mnemonic)):
                here.calls.add(to)
        elif re.match(r"(blx|bx|jalr|jr)\b", mnemonic) and not re.match(r"lr|ra|zero", operands):
            here.jumps = True


def read_frames(directory, functions):
    frames = {}
    for su in run("find", directory, "-name", "*.su").split():
        for line in open(su):
            where, size, kind = line.rstrip("\n").split("\t")
            file, _, _, name = where.split(":")
            if "dynamic" in kind and "bounded" not in kind:
                sys.exit(f"FAIL  {file}: {name} takes stack of no fixed size")
            frames[file, name] = max(int(size), frames.get((file, name), 0))
    for f in functions.values():
        f.own = frames.get((f.file, f.name), f.pushed)


def addresses_taken(image, prefix, functions):
    """Functions whose address stands in the image's data or among its code's constants."""
    words = set()
    for line in run(prefix + "objdump", "-s", image).splitlines():
        m = re.match(r" [0-9a-f]+((?: [0-9a-f]{2,8}){1,4}) ", line)
        if m:
            for w in m.group(1).split():
                if len(w) == 8:
                    words.add(int.from_bytes(bytes.fromhex(w), "little") & ~1)
    return [f for a, f in functions.items() if a in words]


def resolve_pointers(functions, taken):
    for f in functions.values():
        if not f.jumps:
            continue
        allowed = next((to for caller, to in INDIRECT if re.fullmatch(caller, f"{f.file}:{f.name}")), [])
        found = [t for t in taken for file, name in allowed
                 if re.fullmatch(file, t.file) and re.fullmatch(name, t.name)]
        if f.file and not found:
            sys.exit(f"FAIL  {f.file}: {f.name} calls through a pointer: say in INDIRECT to where")
        f.calls.update(found)


def depth(f, path=()):
    if f in path:
        sys.exit("FAIL  recursion: " + " ".join(g.name for g in path[path.index(f):] + (f,)))
    if f.depth is None:
        f.depth = f.own
        for g in f.calls:
            below = f.own + depth(g, path + (f,))
            if below > f.depth:
                f.depth, f.next = below, g
    return f.depth


def main():
    board, image, prefix, directory = sys.argv[1:]
    functions = functions_of(image, prefix)
    read_calls(image, prefix, functions)
    read_frames(directory, functions)
    resolve_pointers(functions, addresses_taken(image, prefix, functions))
    entry = int(re.search(r"start address 0x([0-9a-f]+)", run(prefix + "objdump", "-f", image)).group(1), 16) & ~1
    # A board whose first instructions load the program counter from a table goes on in linker/startup.c.
    first = max([functions[entry]] + [f for f in functions.values() if f.name == "startup"], key=depth)
    total = first.depth
    for f in functions.values():
        if f.name in INTERRUPTS:
            total += depth(f) + INTERRUPTS[f.name]
    path, f = [], first
    while f:
        path.append(f"{f.name} {f.own}")
        f = f.next
    print(f"      {board} deepest calls: {', '.join(path)}")
    limits = [line.split() for line in open("tests/data/board_limits.txt") if line.startswith(board + " ")]
    limit = int(limits[0][3]) if limits and len(limits[0]) > 3 else None
    if limit is None:
        print(f"note  {board} stack by the call graph: {total} bytes, no limit")
    elif total <= limit:
        print(f"ok    {board} stack by the call graph: {total} bytes, at most {limit}")
    else:
        print(f"FAIL  {board} stack by the call graph: {total} bytes, above {limit}")
        sys.exit(1)


main()
