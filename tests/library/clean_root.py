#!/usr/bin/env python3
"""clean_root.py ROOT PACKAGE... - a root folder of nothing but these installed packages, the essential ones, and what they depend on."""
import os
import re
import shutil
import subprocess
import sys

MERGED = ("bin", "sbin", "lib", "lib32", "lib64", "libx32")  # links to those below usr, on this system as in the root


def installed():
    """name -> names that it needs; and who provides a name."""
    form = "${binary:Package}\t${Essential}\t${Provides}\t${Pre-Depends}, ${Depends}\n"
    needs, provider, essential = {}, {}, []
    for line in subprocess.run(["dpkg-query", "-W", "-f", form], check=True, stdout=subprocess.PIPE).stdout.decode().splitlines():
        name, is_essential, provides, depends = line.split("\t")
        needs[name] = [[re.split(r"[ (:]", p.strip())[0] for p in one.split("|")] for one in depends.split(",") if one.strip()]
        for given in [name.split(":")[0], *(re.split(r"[ (]", p.strip())[0] for p in provides.split(","))]:
            provider.setdefault(given, name)
        if is_essential == "yes":
            essential.append(name)
    return needs, provider, essential


def closure(wanted):
    needs, provider, essential = installed()
    found, open_ones = set(), essential + [provider[w] for w in wanted]
    while open_ones:
        name = open_ones.pop()
        if name not in found:
            found.add(name)
            open_ones += [provider[p] for one in needs[name] for p in one if p in provider]
    return sorted(found)


def put(path, root):
    to = root + path
    if os.path.islink(path):
        if not os.path.lexists(to):
            os.symlink(os.readlink(path), to)
    elif os.path.isdir(path):
        os.makedirs(to, exist_ok=True)
    elif os.path.isfile(path):
        os.makedirs(os.path.dirname(to), exist_ok=True)
        shutil.copy2(path, to)


def alternatives(root):
    """cc, c++, awk, pager: links that belong to no package."""
    for folder in ("/etc/alternatives", "/usr/bin"):
        for name in os.listdir(folder):
            path = f"{folder}/{name}"
            mine = folder == "/etc/alternatives" or os.path.islink(path) and os.readlink(path).startswith("/etc/alternatives/")
            if mine and os.path.exists(root + os.path.realpath(path)):
                put(path, root)


def main():
    root, wanted = sys.argv[1], sys.argv[2:]
    for name in MERGED:
        if os.path.islink("/" + name):
            os.makedirs(f"{root}/usr/{name}", exist_ok=True)
            os.symlink("usr/" + name, f"{root}/{name}")
    packages = closure(wanted)
    for path in subprocess.run(["dpkg-query", "-L", *packages], check=True, stdout=subprocess.PIPE).stdout.decode().splitlines():
        if path.startswith("/") and path != "/." and path[1:] not in MERGED:
            put(path, root)
    os.makedirs(root + "/etc/alternatives", exist_ok=True)
    alternatives(root)
    for folder in ("dev", "proc", "tmp", "root", "usr/local", "var/lib/dpkg/info", "var/lib/dpkg/updates"):
        os.makedirs(f"{root}/{folder}", exist_ok=True)
    for file in ("passwd", "group"):
        shutil.copy2(f"/usr/share/base-passwd/{file}.master", f"{root}/etc/{file}")
    # dpkg there knows of these packages, so that it can say what is missing.
    with open(root + "/var/lib/dpkg/status", "w") as status:
        status.write(subprocess.run(["dpkg-query", "-s", *packages], check=True, stdout=subprocess.PIPE).stdout.decode())
    print(len(packages))


main()
