#!/usr/bin/env python3
"""The pages: every relative link and every page named in a source exists; lines fit; no page under docs/ is too long, and no
release of CHANGELOG.md, whose lines are wider.

Headings make anchors as GitHub makes them. Tables and code may be wider than LINE."""
import pathlib
import re
import sys

import listed

LINE, PAGE = 110, 300
CHANGES, RELEASE, CHANGE = pathlib.Path("CHANGELOG.md"), 40, 150


def prose(text):
    """(line number, line) outside of code."""
    fenced, code, blank = False, False, True
    for number, line in enumerate(text.split("\n"), 1):
        fence = line.lstrip().startswith("```")
        code = not fence and line.startswith("    ") and (blank or code)
        blank = not line.strip()
        if not (fenced or fence or code):
            yield number, line
        fenced ^= fence


def anchors(path):
    heads = [line for _, line in prose(path.read_text(encoding="utf-8")) if line.startswith("#")]
    return {re.sub(r"[^\w\- ]", "", h.lstrip("# ").lower()).replace(" ", "-") for h in heads}


def broken(path, target):
    name, _, anchor = target.partition("#")
    to = path.parent / name if name else path
    if not to.exists():
        return "no such file"
    return "no such heading" if anchor and anchor not in anchors(to) else ""


def releases():
    """Each release of CHANGELOG.md, by its heading, that has more than RELEASE lines with something in them."""
    for part in re.split(r"^## ", CHANGES.read_text(encoding="utf-8"), flags=re.M)[1:]:
        lines = [line for line in part.split("\n") if line.strip()]
        if len(lines) > RELEASE:
            yield f"{CHANGES}: {lines[0]}: {len(lines)} lines, {RELEASE} at most: join what one user notices, drop what none does"


def main():
    files = listed.files()
    wrong, links, named = [], 0, 0
    pages = [p for p in files if p.suffix == ".md"]
    for path in pages:
        text = path.read_text(encoding="utf-8")
        for number, line in prose(text):
            most = CHANGE if path == CHANGES else LINE
            if len(line) > most and not line.startswith("|"):
                wrong.append(f"{path}:{number}: {len(line)} columns, {most} at most")
            for target in re.findall(r"\]\(([^)\s]+)\)", line):
                links += 1
                if not re.match(r"https?:", target) and broken(path, target):
                    wrong.append(f"{path}:{number}: {broken(path, target)}: {target}")
        if path.parts[0] == "docs" and text.count("\n") > PAGE:
            wrong.append(f"{path}: {text.count(chr(10))} lines, {PAGE} at most: split it")
    wrong += releases()
    for path in files:
        if path.suffix in (".md", ".c", ".h", ".mk", ".sh", ".py") or path.name == "Makefile":
            for page in re.findall(r"\bdocs/[\w/]+\.md", path.read_text(encoding="utf-8")):
                named += 1
                if not pathlib.Path(page).exists():
                    wrong.append(f"{path}: names {page}, which does not exist")
    for line in wrong:
        print("FAIL  " + line)
    if not wrong:
        print(f"ok    {len(pages)} pages: {links} links and {named} names of pages lead somewhere, lines and pages fit")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
