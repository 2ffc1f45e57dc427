"""The files of the project: git's, and where there is no repository all but builds."""
import pathlib
import subprocess


def files(*names):
    if pathlib.Path(".git").exists():
        command = ["git", "ls-files", "-co", "--exclude-standard", "--", *names]
        found = subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout.decode().split("\n")
        return [p for p in map(pathlib.Path, found) if p.is_file()]
    all_of_them = [p for n in names or ["."] for p in [pathlib.Path(n), *pathlib.Path(n).rglob("*")] if p.is_file()]
    return sorted(p for p in all_of_them if p.parts[0] != "build" and p.suffix not in (".o", ".pyc"))
