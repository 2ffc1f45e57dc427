#!/usr/bin/env python3
"""wheel.py BUILD FLAGS.. - a wheel of contactplant.py and the library of this build, into BUILD/wheel; FLAGS are what the library was
compiled with. It needs no network and no package: a wheel is a zip with a list of its files. Equal builds give equal bytes."""
import base64
import hashlib
import pathlib
import platform
import re
import subprocess
import sys
import tempfile
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
NAME = "contactplant"
OLDEST = 17  # glibc 2.17: pip knows no older manylinux on most processors
GLIBC = {"libc.so.6", "libm.so.6"}  # with the loader, all that a wheel for manylinux may need of these


def constant(name):
    return re.search(rf'^#define {name} +"?([^"\s]+)', (ROOT / "host_sim/library/contactplant.h").read_text(), re.M)[1]


def platform_tag(library, flags):
    """manylinux_2_N where it is true: glibc alone, no newer than 2.N, and code for every processor of the kind. Else linux."""
    told = subprocess.run(["objdump", "-p", library], check=True, stdout=subprocess.PIPE, universal_newlines=True).stdout
    needed = set(re.findall(r"NEEDED +(\S+)", told))
    versions = [tuple(map(int, v.split("."))) for v in re.findall(r"GLIBC_([0-9.]+)", told)]
    special = any(f.startswith(("-march", "-mcpu", "-mavx")) for f in flags)
    if special or not versions or not {n for n in needed if not n.startswith("ld-linux")} <= GLIBC:
        return f"linux_{platform.machine()}"
    return f"manylinux_2_{max(OLDEST, max(v[1] for v in versions))}_{platform.machine()}"


def stripped(library):
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder, "library")
        subprocess.run(["strip", "--strip-unneeded", "-o", copy, library], check=True)
        return copy.read_bytes()


def contents(version, library, tag):
    """name in the wheel -> bytes, but for the list of them."""
    info = f"{NAME}-{version}.dist-info"
    metadata = (f"Metadata-Version: 2.1\nName: {NAME}\nVersion: {version}\n"
                "Summary: a real-time plant whose contact makes and breaks, for controllers under test\n"
                "License: MIT\nRequires-Python: >=3.8\nDescription-Content-Type: text/markdown\n\n")
    page = "`import contactplant` is all; its help() and docs/guide/python.md of the source say how.\n"
    wheel = f"Wheel-Version: 1.0\nGenerator: contactplant {version}\nRoot-Is-Purelib: false\nTag: {tag}\n"
    return {f"{NAME}.py": (ROOT / "host_sim/python/contactplant.py").read_bytes(),
            f"{NAME}.libs/{library.name}": stripped(library),
            f"{info}/LICENSE": (ROOT / "LICENSE").read_bytes(),
            f"{info}/METADATA": (metadata + page).encode(),
            f"{info}/WHEEL": wheel.encode()}, info


def pack(path, files, info):
    record = ""
    for name, data in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(data)}\n"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in {**files, f"{info}/RECORD": (record + f"{info}/RECORD,,\n").encode()}.items():
            entry = zipfile.ZipInfo(name)  # of 1980: the time of a build is no part of it
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if ".so" in name else 0o644) << 16
            archive.writestr(entry, data)


def main():
    build, flags = pathlib.Path(sys.argv[1]), " ".join(sys.argv[2:]).split()
    version = constant("CONTACTPLANT_VERSION")
    library = build / f"libcontactplant.so.{constant('CONTACTPLANT_ABI')}"
    tag = "py3-none-" + platform_tag(library, flags)
    folder = build / "wheel"
    folder.mkdir(exist_ok=True)
    for old in folder.glob("*.whl"):
        old.unlink()
    files, info = contents(version, library, tag)
    path = folder / f"{NAME}-{version}-{tag}.whl"
    pack(path, files, info)
    print(path)


main()
