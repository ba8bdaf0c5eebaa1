#!/usr/bin/env python3
"""Checks the limits of the architecture on sizes:
  - a folder of the library has at most 6,000 lines in its own files (a subfolder counts for itself);
  - a class or struct has at most 25 data members;
  - a header of the library includes at most 41 other headers of ours, directly or not.
Prints one line per violation and exits with 1 if there is any. `--list` prints the largest.
"""

import re
import sys

import checks

MAX_LINES, MAX_MEMBERS, MAX_REACH = 6000, 25, 41
# They gather what others include one by one.
GATHERING = {"souple/souple.h", "souple/constraints/all.h"}
INCLUDE = re.compile(r'^\s*#\s*include\s*"((?:souple|render|app|plugins)/[^"]+)"', re.M)
CLASS = re.compile(r"\b(?:class|struct)\s+(?:\[\[[^\]]*\]\]\s*)?([A-Za-z_][\w:]*)\s*(?:final\s*)?(?::[^;{(]*)?\{")
NO_MEMBER = re.compile(r"(using|friend|static|enum|struct|class|template|typedef|union|explicit|virtual|constexpr|inline static)\b")
FUNCTION_HEAD = re.compile(r"\)\s*(const|noexcept|override|final|&|\s)*(->[^;]*)?(:[^;]*)?$")
TYPE_HEAD = re.compile(r"\b(class|struct|enum|union)\b[^;=(]*$")


def without_comments(text):
    text = re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.S if "/*" in text else 0)
    text = re.sub(r'"(\\.|[^"\\\n])*"', '""', text)
    return re.sub(r"^\s*#.*$", "", re.sub(r"'(\\.|[^'\\\n])'", "' '", text), flags=re.M)


def end_of_block(text, begin):
    depth = 0
    for i in range(begin, len(text)):
        depth += {"{": 1, "}": -1}.get(text[i], 0)
        if depth == 0:
            return i
    return len(text) - 1


def statements(body):
    """The declarations in a class, with the blocks of functions and nested types cut out."""
    out, i = "", 0
    while i < len(body):
        if body[i] == "{":
            head = out[max(out.rfind(";"), out.rfind("}")) + 1:]
            i = end_of_block(body, i)
            out += "{}"
            if FUNCTION_HEAD.search(head.rstrip()) or TYPE_HEAD.search(head):
                out += ";"
        else:
            out += body[i]
        i += 1
    for statement in out.split(";"):
        statement = re.sub(r"\b(public|private|protected)\s*:(?!:)", "", statement).strip()
        yield re.sub(r"^(\{\})+", "", statement).strip()


def count_members(body):
    count = 0
    for statement in statements(body):
        if not statement or NO_MEMBER.match(statement):
            continue
        while re.search(r"<[^<>]*>", statement):
            statement = re.sub(r"<[^<>]*>", "", statement)
        if "(" in statement.split("=")[0] or "operator" in statement or "~" in statement:
            continue
        count += 1 + re.sub(r"\([^)]*\)|\[[^\]]*\]", "", statement).count(",")
    return count


def classes(text):
    """(name, number of data members) of each class and struct."""
    text = without_comments(text)
    for match in CLASS.finditer(text):
        if not text[:match.start()].rstrip().endswith("enum"):
            yield match.group(1), count_members(text[match.end():end_of_block(text, match.end() - 1)])


def reach(header, includes):
    found, next_ones = set(), list(includes[header])
    while next_ones:
        file = next_ones.pop()
        if file not in found:
            found.add(file)
            next_ones += includes.get(file, [])
    return len(found - {header})


def main():
    texts = checks.sources("souple")
    lines, includes = {}, {}
    for path, text in texts.items():
        folder = path.rsplit("/", 1)[0]
        lines[folder] = lines.get(folder, 0) + text.count("\n")
        includes[path] = [target for target in INCLUDE.findall(text) if target in texts]
    sizes = [(count, MAX_LINES, folder, "lines in one folder") for folder, count in lines.items()]
    sizes += [(count, MAX_MEMBERS, f"{path}: {name}", "data members") for path, text in texts.items()
              for name, count in classes(text)]
    sizes += [(reach(path, includes), MAX_REACH, path, "of our headers included, directly or not") for path in texts
              if path.endswith(".h") and path not in GATHERING]
    if "--list" in sys.argv:
        for kind in (MAX_LINES, MAX_MEMBERS, MAX_REACH):
            for count, limit, what, unit in sorted((s for s in sizes if s[1] == kind), reverse=True)[:12]:
                print(f"{count:6} {what}: {unit}, at most {limit}")
        return
    problems = [f"{what}: {count} {unit}, expected at most {limit}" for count, limit, what, unit in sizes if count > limit]
    checks.report(problems, f"{len(texts)} files of {len(lines)} folders keep to their sizes")


if __name__ == "__main__":
    main()
