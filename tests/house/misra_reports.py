#!/usr/bin/env python3
"""misra_reports.py DUMP... - what cppcheck's MISRA addon reports of these dumps, `rule file:line` a line, then of all of them together.

cppcheck itself starts the addon anew for each file, which takes half of the time; here it is started once."""
import contextlib
import gc
import glob
import io
import json
import sys

sys.path[:0] = glob.glob("/usr/lib/*/cppcheck/addons") + glob.glob("/usr/share/cppcheck/addons")
import misra  # noqa: E402


def reports(dumps):
    said = io.StringIO()
    with contextlib.redirect_stdout(said):
        settings = misra.MisraSettings(misra.get_args_parser().parse_args(sys.argv[1:]))
        for dump in dumps:
            misra.MisraChecker(settings).parseDump(dump)
            gc.collect()  # and not while a dump is read, which has a million objects
        misra.MisraChecker(settings).analyse_ctu_info([dump[:-len("dump")] + "ctu-info" for dump in dumps])
    return [json.loads(line) for line in said.getvalue().splitlines()]


gc.disable()
dumps = sys.argv[1:]
sys.argv[1:1] = ["--cli", "-q"]  # which the addon reads there itself
for r in reports(dumps):
    print(f"{r['errorId'].replace('c2012-', '', 1)} {r['file']}:{r['linenr']}")
