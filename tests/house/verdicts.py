"""Lines `ok` and `FAIL`, as tests/run.sh counts them."""
import sys

sys.stdout.reconfigure(line_buffering=True)
results = []


def verdict(name, good, why=""):
    """`why` is printed where it is not good."""
    results.append(bool(good))
    print(("ok    " if good else "FAIL  ") + name.strip() + ("" if good or not why else ": %.2000s" % (why,)))


def check(name, good, told=""):
    """`told` is printed in any case."""
    results.append(bool(good))
    print(("ok    " if good else "FAIL  ") + name + (": %s" % (told,) if told != "" else ""))


def equal(name, got, wanted):
    verdict("%s: %.60s" % (name, got), got == wanted, "wanted %.400s" % (wanted,))


def conclude():
    print("%d passed, %d failed" % (results.count(True), results.count(False)))
    sys.exit(not all(results))
