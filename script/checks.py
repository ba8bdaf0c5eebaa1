"""Shared by the checks of script/lint: the files that they read, and how they report."""
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def sources(*folders):
    """{name: text} of the sources in C++ below some folders."""
    files = [file for folder in folders for file in sorted((ROOT / folder).rglob("*")) if file.suffix in (".h", ".cpp")]
    return {str(file.relative_to(ROOT)): file.read_text(encoding="utf-8") for file in files}


def tracked(wanted):
    """{name: text} of the files of the repository whose names are wanted."""
    names = subprocess.check_output(["git", "-C", str(ROOT), "ls-files"], text=True).splitlines()
    return {name: (ROOT / name).read_text(encoding="utf-8") for name in names if wanted(name) and (ROOT / name).is_file()}


def report_lines(files, check_file, fine):
    """Checks each text with `check_file(name, text)`, which yields (line, problem)."""
    report([f"{name}:{line}: {problem}" for name, text in files.items() for line, problem in check_file(name, text)], fine)


def report(problems, fine):
    print("\n".join(problems) if problems else fine, file=sys.stderr if problems else sys.stdout)
    sys.exit(1 if problems else 0)
