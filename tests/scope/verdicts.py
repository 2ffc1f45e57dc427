"""Lines `ok` and `FAIL`, as tests/run.sh counts them."""
import sys

sys.stdout.reconfigure(line_buffering=True)
count = {True: 0, False: 0}


def check(name, ok, told=""):
    count[bool(ok)] += 1
    print(("ok    " if ok else "FAIL  ") + name + (": " + str(told) if told != "" else ""))


def conclude():
    print(f"{count[True]} passed, {count[False]} failed")
    sys.exit(count[False] > 0)
