#!/usr/bin/env python3
"""One word, one thing: no page and no --help says a word that the glossary of docs/why/design.md replaces.

The glossary is a table of word, meaning and the words that are not used for it. Pages are read without code, names of
files and targets of links; of the program the tables of its options and subcommands are read. CHANGELOG.md is history.
Names and comments of host_sim's C files keep to it as well, but for words that some rooms have still: LATER, which may
only lose entries."""
import pathlib
import re
import sys

import check_pages
import listed

GLOSSARY, HEAD = pathlib.Path("docs/why/design.md"), "## Glossary"
LEAST = 40
TABLE = re.compile(r"^(?:static const struct (?:option|usage)\b|\} command\[\] = \{).*?^\}", re.S | re.M)
# A room of host_sim, and words of the last column that its code has still.
LATER = {
    "afm": "station setpoint", "library": "station", "list": "station",
    "out": "surrogate", "scene": "station", "test": "station",
}
STRINGS = re.compile(r'"(?:\\.|[^"\\\n])*"')
TEXT = re.compile(r'"((?:\\.|[^"\\\n])*)"')


def glossary_lines():
    """(number, line) of the glossary's table, without its head."""
    lines, on, found = GLOSSARY.read_text(encoding="utf-8").split("\n"), False, []
    for number, line in enumerate(lines, 1):
        on = line == HEAD if line.startswith("## ") else on
        if on and line.startswith("| ") and not line.startswith("| word |"):
            found.append((number, line))
    return found


def glossary():
    """{word that is not used: the word in its place}, and all words of the glossary."""
    instead, words = {}, []
    for _, line in glossary_lines():
        word, _, banned = (cell.strip() for cell in line.strip("|").split("|"))
        words += word.split(", ")
        instead.update((b, word) for b in banned.split(", ") if b)
    return instead, words


def page_text(path):
    """(number, text) of the lines of a page, but for code, files, targets and the glossary itself."""
    own = {number for number, _ in glossary_lines()} if path == GLOSSARY else ()
    for number, line in check_pages.prose(path.read_text(encoding="utf-8")):
        if number not in own:
            line = re.sub(r"`[^`]*`|\]\([^)\s]*\)", " ", line)
            yield number, re.sub(r"\S+\.(?:[ch]|py|sh|md)\b", " ", line)


def help_text(path):
    """(number, text) of the texts in a source's tables of options and subcommands; command lines are code."""
    text = path.read_text(encoding="utf-8")
    for table in TABLE.finditer(text):
        for found in TEXT.finditer(table.group()):
            if not found.group(1).startswith("  contactplant "):
                yield text.count("\n", 0, table.start() + found.start()) + 1, found.group(1).replace("\\n", " ")


def code_text(path):
    """(number, text) of names, split at their underscores, and of comments of a C file."""
    text = STRINGS.sub('""', path.read_text(encoding="utf-8"))
    for number, line in enumerate(text.split("\n"), 1):
        yield number, "" if line.startswith("#include") else line.replace("_", " ")


def is_later(path, word):
    return word.lower() in LATER.get(path.with_suffix("").parts[1], "").split()


def main():
    instead, words = glossary()
    wrong = [f"{GLOSSARY}: {len(words)} words in the glossary, {LEAST} at least"] if len(words) < LEAST else []
    wrong += [f"{GLOSSARY}: the glossary has {w} and refuses it" for w in sorted(set(words) & set(instead))]
    wrong += [f"{GLOSSARY}: the glossary has {w} twice" for w in sorted(set(words)) if words.count(w) > 1]
    refused = re.compile(r"(?<![\w-])(" + "|".join(re.escape(b) for b in sorted(instead, key=len, reverse=True)) + r")s?(?![\w-])", re.I)
    pages = [p for p in listed.files() if p.suffix == ".md" and p.name != "CHANGELOG.md"]
    sources = [p for p in listed.files("host_sim") if p.suffix == ".c"]
    for path in pages + sources:
        for number, text in (page_text if path.suffix == ".md" else help_text)(path):
            for found in refused.finditer(text):
                word = instead[found.group(1).lower()]
                wrong.append(f"{path}:{number}: {found.group()}: the glossary's word is {word}")
    code = [p for p in listed.files("host_sim") if p.suffix in (".c", ".h") and p.name != "contactplant.h"]
    for path in code:
        for number, text in code_text(path):
            for found in refused.finditer(text):
                if not is_later(path, found.group(1)):
                    wrong.append(f"{path}:{number}: {found.group()}: the glossary's word is {instead[found.group(1).lower()]}")
    for line in wrong:
        print("FAIL  " + line)
    if not wrong:
        print(f"ok    {len(words)} words of the glossary: {len(pages)} pages, --help and {len(code)} C files use none of the {len(instead)} that it replaces")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
