#!/usr/bin/env python3
"""Plain English: sentences of at most 30 words, and none that opens with Of, What, Whoever or The same.

    check_language.py            counts per room against tests/data/language.txt; a count above its budget fails
    check_language.py PATH...    shows each finding in these files or folders
    check_language.py --lower    writes today's counts where they are below the budget

It reads the pages (*.md) and the comments of *.c and *.h. Code, formulas, tables and headings are no sentences, and a
question may open with What. A budget may only go down; pages have none. CHANGELOG.md is history and not read."""
import collections
import pathlib
import re
import sys

import listed

BUDGET = pathlib.Path("tests/data/language.txt")
LONGEST = 30
OPENS = re.compile(r"(of|what|whoever|the same)\b", re.I)
ENDS = re.compile(r"(?<!\be\.g\.)(?<!\bi\.e\.)(?<!\beq\.)(?<!\bfig\.)(?<=[.!?])[\"')\]]*\s+")
COMMENT = re.compile(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'|/\*(.*?)\*/|//([^\n]*)', re.S)


def page_paragraphs(text):
    """(line, text) of each paragraph or list item; without code, tables and headings."""
    found, at, fenced, after_blank = [], None, False, True
    for number, line in enumerate(text.split("\n"), 1):
        fence = line.lstrip().startswith("```")
        code = fenced or fence or (line.startswith("    ") and after_blank)
        fenced ^= fence
        item = re.match(r"\s*([-*]|\d+\.) ", line)
        after_blank = not line.strip() or (code and not fence)
        if code or after_blank or line.startswith(("|", "#", "![")):
            at = None
            continue
        if at is None or item:
            at = [number, ""]
            found.append(at)
        at[1] += " " + (line[item.end():] if item else line)
    return found


def comment_paragraphs(text):
    """(line, text) of each paragraph of each comment; lines set in by four blanks, or with gaps, are code or tables."""
    for match in COMMENT.finditer(text):
        body = match.group(1) or match.group(2)
        if body is None:
            continue
        first, at, part = text.count("\n", 0, match.start()) + 1, 0, ""
        for i, line in enumerate(body.split("\n") + [""]):
            line = re.sub(r"^\s*\*(?=\s|$)", "", line) if i else line
            item, code = re.match(r"\s*(-|\d+\.) ", line), re.search(r"\S   +\S", line) or (i and re.match(r"\s{4}", line))
            if part and (item or code or not line.strip()):
                yield first + at, part
                part = ""
            if line.strip() and not code:
                at = at if part else i
                part += " " + line[item.end() if item else 0:].strip()


def sentences(text):
    text = re.sub(r"`[^`]*`", "CODE", text)
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    text = re.sub(r"[*_]{2}", "", text)
    text = re.sub(r"^\s*[\w/.]+\.[ch] - ", "", text)  # the opening line of a source
    return [s.strip(" *(\"") for s in ENDS.split(text) if s.strip()]


def findings(path):
    text = path.read_text(encoding="utf-8")
    for line, part in page_paragraphs(text) if path.suffix == ".md" else comment_paragraphs(text):
        for s in sentences(part):
            words = len([w for w in s.split() if re.search(r"[A-Za-z]{2}|^[aAI]$", w)])
            if words > LONGEST:
                yield line, f"{words} words", s
            if OPENS.match(s) and not s.endswith("?"):
                yield line, f"opens with {OPENS.match(s).group(1)}", s


def room(path):
    return "pages" if path.suffix == ".md" else "/".join(path.parts[:-1][:2])


def main():
    names = [a for a in sys.argv[1:] if a != "--lower"]
    paths = [p for p in listed.files(*names) if p.suffix in (".md", ".c", ".h") and p.name != "CHANGELOG.md"]
    found = {path: list(findings(path)) for path in paths}
    if names:
        for path, rows in found.items():
            for line, what, sentence in rows:
                print(f"{path}:{line}: {what}: {sentence}")
        return 0
    now = collections.Counter({room(path): 0 for path in found})
    for path, rows in found.items():
        now[room(path)] += len(rows)
    budget = {r: int(n) for r, n in (line.split() for line in BUDGET.read_text().splitlines() if line[:1] != "#")}
    over = [r for r in sorted(now) if now[r] > budget.get(r, 0)]
    for r in over:
        path = "'*.md'" if r == "pages" else r
        print(f"FAIL  plain English in {r}: {now[r]} findings, {budget.get(r, 0)} allowed; check_language.py {path} lists them")
    lower = [r for r in sorted(budget) if now[r] < budget[r]]
    if "--lower" in sys.argv:
        head = [line for line in BUDGET.read_text().splitlines() if line[:1] == "#"]
        rows = [f"{r} {min(now[r], budget[r])}" for r in sorted(budget) if now[r] or budget[r] and r in now]
        BUDGET.write_text("\n".join(head + rows) + "\n")
    elif lower:
        print("      below its budget; run tests/house/check_language.py --lower: " + ", ".join(lower))
    if not over:
        print(f"ok    plain English: {sum(now.values())} findings in {len(found)} files, none beyond the budget of its room")
    return 1 if over else 0


if __name__ == "__main__":
    sys.exit(main())
