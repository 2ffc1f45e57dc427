#!/usr/bin/env python3
"""test_help.py PROGRAM - contactplant help: pages of the source tree and of a copy that stands elsewhere, searches, advice, what is not
there, a pager on a terminal; every page that a subcommand's --help names. Prints `ok` and `FAIL` lines and `N passed, N failed`."""
import os
import pathlib
import pty
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../house"))
from verdicts import conclude, equal, verdict  # noqa: E402

program = os.path.abspath(sys.argv[1])
root = pathlib.Path(__file__).resolve().parents[2]
here = pathlib.Path(tempfile.mkdtemp())


def run(*words, by=program, **more):
    return subprocess.run([by, "help", *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=60, **more)


def on_terminal(*words, **environment):
    """What a terminal shows."""
    ours, theirs = pty.openpty()
    child = subprocess.Popen([program, "help", *words], stdin=theirs, stdout=theirs, stderr=theirs,
                             env={**os.environ, "TERM": "dumb", **environment})
    os.close(theirs)
    shown = b""
    try:
        while True:
            part = os.read(ours, 65536)
            if not part:
                break
            shown += part
    except OSError:  # the other end was closed
        pass
    os.close(ours)
    return child.wait(60), shown.decode().replace("\r\n", "\n")


def refused(name, part, status, *words, by=program):
    r = run(*words, by=by)
    verdict("%s: %s" % (name, r.stderr.strip()), r.returncode == status and part in r.stderr and r.stderr.count("\n") == 1 and not r.stdout,
            (r.returncode, r.stdout[:100], r.stderr))


fmi = (root / "docs/guide/fmi.md").read_text()
for name in ("fmi", "guide/fmi", "docs/guide/fmi.md", "FMI", "Guide/Fmi.md"):
    r = run(name)
    verdict("help %s prints the page as it is" % name, r.returncode == 0 and r.stdout == fmi and not r.stderr, r.stderr)
pages = sorted((root / "docs").rglob("*.md"))
listed = re.findall(r"^  (\S+) +\S", run().stdout.split("pages (contactplant help PAGE):")[1], re.M)
verdict("help lists %d pages, one name each" % len(listed), len(listed) == len(set(listed)) == len(pages) - 1 + 3, listed)
texts = {run(name).stdout for name in listed}
equal("pages that the names of the list print", len(texts), len(listed))
verdict("they are the pages", {p.read_text() for p in pages if p.parent != root / "docs"} <= texts)

# What the texts of the program name.
named = {}
for command in re.findall(r"^  ([a-z]+) +\S", run().stdout.split("subcommands:")[1].split("\n\n")[0], re.M):
    told = subprocess.run([program, command, "--help"], stdout=subprocess.PIPE, text=True).stdout
    for page in re.findall(r"docs/[\w/.-]*\w", told):
        named.setdefault(page, command)
    for word in re.findall(r"contactplant help ([a-z][\w/.-]*)$", told, re.M):
        named.setdefault(word, command)
advice = run("--errors").stdout
for word in re.findall(r"contactplant\s+help\s+([a-z][\w/-]*)", advice):
    named.setdefault(word, "help --errors")
missing = ["%s in %s --help" % pair for pair in named.items()
           if run(pair[0]).returncode and not (root / pair[0]).exists()]
verdict("%d pages that --help and --errors name are there" % len(named), named and not missing, missing)
for command in ("run", "simulate", "monitor"):
    told = subprocess.run([program, command, "--help"], stdout=subprocess.PIPE, text=True).stdout
    equal("help %s is %s --help" % (command, command), run(command).stdout[:60], told[:60])

# Searches, beside grep.
for words in (["touchdown"], ["EARLY", "return"], ["ffp-contract"]):
    r = run("--search", *words)
    lines = [line for p in pages if p.parent != root / "docs" for line in p.read_text().split("\n") if all(w.lower() in line.lower() for w in words)]
    shown = r.stdout.split("\n")[:-1]
    lost = [line for line in lines if not any(s.endswith(line.strip()) or line.strip() in s for s in shown)]
    verdict("help --search %s: %d lines, with all %d of the pages" % (" ".join(words), len(shown), len(lines)), lines and not lost, lost[:2])
    verdict("each with page, heading and words", all(re.match(r"(docs/\w+/)?[\w-]+\.md: [^:]*", s) and all(w.lower() in s.lower() for w in words)
                                                     for s in shown), shown[:3])
line = [s for s in run("--search", "lastSuccessfulTime").stdout.split("\n") if "fmi.md" in s]
verdict("page and heading: %.60s" % line[:1], line and line[0].startswith("docs/guide/fmi.md: Events: "), line)
refused("nothing is found", 'no line of the pages has "zyzzyva of nowhere"; try fewer words', 1, "--search", "zyzzyva", "of", "nowhere")
refused("no words", "--search wants words", 2, "--search")
manual = subprocess.run([program, "man", "fmi"], stdout=subprocess.PIPE, text=True).stdout
heads = [line[4:] for line in manual.split("\n") if line.startswith(".SH ")]
equal("man fmi: its sections", heads, ["NAME", "DESCRIPTION"] + re.findall(r"^## (.*)", fmi, re.M))
plain = subprocess.run(["groff", "-k", "-man", "-Tascii", "-P-cbou", "-rLL=200n"], input=manual, stdout=subprocess.PIPE, text=True).stdout
shown = re.sub(r"\s+", "", plain)
lost = [w for w in re.findall(r"[a-z_]{9,}", re.sub(r"\]\([^)]*\)|^```.*", "", fmi, flags=re.M)) if w not in re.sub("-", "", shown) and w not in shown]
verdict("all long words of the page stand in its manual page, %d of them" % len(re.findall(r"[a-z_]{9,}", fmi)), not lost, lost[:5])
refused("two questions", "ask one", 2, "--search", "--errors", "x")
refused("two pages", "one word too many", 2, "fmi", "fit")
refused("a page that is near", "did you mean fmi?", 2, "fmii")
refused("no page", "contactplant help lists all", 2, "qqqqqqqqqqqq")
refused("a path out of the pages", "no page is called", 2, "../../../etc/passwd")

# Advice.
r = run("--errors", "late")
verdict("--errors late: cause, counter, what to do", r.returncode == 0 and "in REPLY: the instant named has passed" in r.stdout
        and "in HEALTH:" in r.stdout and "  -> The command came after the instant" in r.stdout, r.stdout)
equal("--errors LATE", run("--errors", "LATE").stdout, r.stdout)
verdict("--errors alone has it, too", r.stdout in advice)
equal("arrows, one for each name", advice.count("\n  -> "), len(re.findall(r"^\w+$", advice, re.M)))
dbc = subprocess.run([program, "dbc"], stdout=subprocess.PIPE, text=True).stdout
causes = re.findall(r'\d+ "(\w+)"', re.search(r"^VAL_ \d+ CAUSE (.*);$", dbc, re.M)[1])
verdict("every cause of the .dbc: %s" % " ".join(causes), len(causes) > 5
        and all(run("--errors", c).returncode == 0 for c in causes if c != "ok"), causes)
trouble = (root / "docs/guide/trouble.md").read_text()
sources = "".join(p.read_text() for room in ("host_sim", "hal", "firmware") for p in sorted((root / room).rglob("*.[csh]*")) if p.suffix in (".c", ".sh"))
sources = re.sub(r'"\s*\n\s*"', "", sources)
messages = [m for m in re.findall(r"^\| ([^|]*) \|", trouble, re.M) if m not in ("message", "---")]
stale = [m for m in messages if m not in sources]
verdict("%d messages of the page of errors are messages of the program" % len(messages), len(messages) > 10 and not stale, stale)
lost = [m for m in messages if m + "\n  -> " not in run("--errors", *m.split()).stdout]
verdict("--errors finds each of them", not lost, lost)
said = subprocess.run([program, "control", "--bus", "udp:127.77.0.1:%d" % (20000 + os.getpid() % 9000), "--peer", "127.77.0.2:20000", "--duration", "1"], stdout=subprocess.PIPE,
                      stderr=subprocess.STDOUT, text=True).stdout.strip().split("\n")[-1]
verdict("a whole line of the program, as it was printed: %.60s" % said, "no plant answers\n  -> Start one" in run("--errors", said).stdout, said)
verdict("a name in a line of send", run("--errors", "FIRE: late, 12 ticks").stdout == r.stdout)
both = run("--errors", "overrun").stdout + run("--errors", "timeout").stdout
for said in ("40", "0x28", "FAULTS=40", "7 STATUS SESSION=1 STATE=fault FAULTS=40 (overrun, timeout) FRAME=3", "--fail-on fault: 40 (overrun, timeout)"):
    verdict("faults by their number or names: %s" % said, run("--errors", "--", said).stdout == both, run("--errors", "--", said).stdout)
refused("a number with other bits", "nothing is known", 2, "--errors", "256")
refused("an empty word", "a word is empty", 2, "--errors", "")
refused("no such error", 'nothing is known about "late_"; did you mean late?', 2, "--errors", "late_")

# Elsewhere: an installed tree that was moved, with blanks; a program alone.
tree = here / "a prefix" / "bin"
tree.mkdir(parents=True)
shutil.copy(program, tree)
refused("a program without its pages", "run make install in the source tree", 1, "fmi", by=tree / "contactplant")
verdict("its help alone still says what there is", "subcommands:" in run(by=tree / "contactplant").stdout)
verdict("--errors needs no page", run("--errors", "late", by=tree / "contactplant").stdout == r.stdout)
doc = here / "a prefix" / "share/doc/contactplant"
shutil.copytree(root / "docs", doc / "docs")
for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md"):
    shutil.copy(root / name, doc)
equal("in a prefix with blanks, from another folder", run("fmi", by=tree / "contactplant", cwd="/").stdout[:30], fmi[:30])
os.symlink(tree / "contactplant", here / "link")
equal("by a link", run("fmi", by=here / "link", cwd="/").stdout[:30], fmi[:30])
(doc / "docs/guide/fmi.md").unlink()
os.symlink("nowhere", doc / "docs/guide/fmi.md")
refused("a page that is broken", "install again", 1, "fmi", by=tree / "contactplant")

# A terminal.
status, shown = on_terminal("fmi", PAGER="sed s/^/PAGED:/")
verdict("on a terminal by $PAGER", status == 0 and shown.rstrip() == "\n".join("PAGED:" + line for line in fmi.rstrip().split("\n")), shown[:80])
status, shown = on_terminal("fmi", PAGER="no-such-pager-%d" % os.getpid())
verdict("a pager that is missing: the page, plain", status == 0 and shown.endswith(fmi[-60:]), shown[-200:])
with open("/dev/full", "w") as full:
    r = subprocess.run([program, "help", "fmi"], stdout=full, stderr=subprocess.PIPE, text=True)
verdict("a full disk: %s" % r.stderr.strip(), r.returncode == 1 and "cannot write the output" in r.stderr)
shutil.rmtree(here)
conclude()
