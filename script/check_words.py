#!/usr/bin/env python3
"""Refuses words that CONTRIBUTING's glossary replaced: in names, comments, messages and the manual.

NAMES holds words inside identifiers (`led_count` and `LedCount` both hold "led"), PROSE holds patterns of text, each with
what to say instead. ALLOWED holds the legitimate uses. Prints one line per violation and exits with 1 if there is any.
"""

import fnmatch
import re

import checks

NAMES = {
    "colour": "color", "colours": "colors", "coloured": "colored", "colouring": "coloring",
    "centre": "center", "centres": "centers", "neighbour": "neighbor", "neighbours": "neighbors",
    "led": "kinematic or driven",
    "rubbed": "tangent_sum",
    "knot": "component (of intersections)", "knots": "components (of intersections)",
    "tangle": "intersection", "tangles": "intersections", "tangled": "intersecting", "untangling": "resolve",
    "hurry": "escalate",
    "mouth": "inflow", "mouths": "inflows",
    "knob": "tunable", "knobs": "tunables",
    "wakefulness": "active scope",
    "owed": "motion since",
    "account": "statistics",
    "bounced": "restitution", "rebound": "restitution",
    "course": "strategy",
    "misplaced": "layer violation",
    "patience": "retry limit",
    "realm": "cluster",
    "rescue": "correction",
    "verdict": "classification",
    "draft": "builder",
    "restless": "cannot_sleep",
    "yielding": "compliance of the body, two-way coupling",
}
PROSE = {
    r"(colour|centre\b|centres\b|neighbour|behaviour|metres?\b)": "US spelling: color, center, neighbor, behavior, meter",
    r"\bled\b": "kinematic, driven or moved by",
    r"\banew\b": "again, or rebuilt",
    r"\b(un)?tangl(e|es|ed|ing)\b": "intersection, intersecting, resolve",
    r"\bpull(s|ed|ing)? (\w+ )?apart\b": "resolve",
    r"\bknots?\b": "intersection component",
    r"\brubb(ed|ing)\b": "tangent multiplier, friction",
    r"\b(share[sd]?|sharing) (\w+ )?out\b": "parallel_for, distribute",
    r"\b(let|lets|letting) go of\b": "release",
    r"\bhurr(y|ies|ied)\b": "escalate",
    r"\bmouths?\b": "inflow",
    r"\bknobs?\b": "tunable, setting",
    r"\bthings?\b": "object, or its name",
    r"\bnobody\b": "no user, no object: name it",
    r"\bof its own accord\b": "automatically",
    r"\bought\b": "must, should",
    r"\bwhat nothing\b": "name it",
    r"\buntil it is mended\b": "workaround",
    r"\bby the way of\b": "along the path of",
    r"\bwakefulness\b": "active scope",
}
# (files, pattern of the words around the use, matched from up to 20 characters before it)
ALLOWED = [
    # A real knot.
    ("docs/gallery.md", r"reef knot"),
    ("script/gallery", r"reef knot"),
    ("docs/collisions.md", r"reef knot"),
    ("tests/physics/collision_cases.*", r"[Kk]not"),
    ("tests/physics/test_collision_surfaces.cpp", r"[Kk]not"),
    ("souple/io/recorder_report.cpp", r'"tangled"'),  # a key of run.json
    ("souple/scene/nearest.cpp", r".*"),   # names of older scene files
    ("tests/scene/test_messages.cpp", r".*colour|.*neighbour"),
    # Radium's own names.
    ("plugins/radium/*", r"\bRa::[\w:]*"),
    ("tests/radium/*", r"\bRa::[\w:]*"),
    ("CONTRIBUTING.md", r".*"),            # the glossary
    ("script/check_words.py", r".*"),
]

CODE = re.compile(r'//[^\n]*|/\*.*?\*/|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'', re.S)
IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
PART = re.compile(r"[A-Z]?[a-z]+|[A-Z]+(?![a-z])")
PROSE_ANY = re.compile("|".join(f"(?:{pattern})" for pattern in PROSE), re.I)
SOURCES = (".h", ".cpp", ".glsl", ".vert", ".frag")


def allowed(path, text, begin, end):
    around = text[max(0, begin - 20):end + 20]
    return any(fnmatch.fnmatch(path, files) and re.search(pattern, around) for files, pattern in ALLOWED)


def instead(word):
    return next(say for pattern, say in PROSE.items() if re.fullmatch(pattern, word, re.I))


def check_prose(path, text, offset, whole):
    for match in PROSE_ANY.finditer(text):
        begin, end = offset + match.start(), offset + match.end()
        if not allowed(path, whole, begin, end):
            yield begin, f'"{match[0]}": say {instead(match[0])}'


def check_names(path, text, whole):
    for match in IDENTIFIER.finditer(text):
        for part in PART.findall(match[0]):
            say = NAMES.get(part.lower())
            if say and not allowed(path, whole, match.start(), match.end()):
                yield match.start(), f"the name {match[0]}: say {say}"


def check_file(path, text):
    """Yields (line, problem)."""
    if path.endswith(SOURCES):
        found = [problem for match in CODE.finditer(text)
                 for problem in check_prose(path, match[0], match.start(), text)]
        # Names: the code with comments and strings blanked.
        found += check_names(path, CODE.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text), text)
    else:
        found = check_prose(path, text, 0, text)
    return sorted((text.count("\n", 0, place) + 1, problem) for place, problem in found)


if __name__ == "__main__":
    checked = checks.tracked(lambda name: name.endswith((*SOURCES, ".md")) or name.startswith(("script/", ".ci/", "cmake/")))
    checks.report_lines(checked, check_file, f"check_words: {len(checked)} files, no replaced word")
