#!/usr/bin/env python3
"""Refuses long sentences in comments and in the manual: more than 25 words, or a first word that hides the subject.

A sentence ends at a period, at a blank line, at an indented formula or code, and with a list item or a table's cell.
Code spans, formulas and calls count as one word, units as none. Prints one line per violation and exits with 1 if there
is any.
"""

import io
import re
import tokenize

import checks

LONGEST = 25
# A question may begin with "What".
WEAK_START = re.compile(r"(Of|The same|As above)\b|What\b(?!.*\?$)")

C_LIKE = (".h", ".hpp", ".cpp", ".in", ".glsl", ".vert", ".frag", ".js", ".mjs", ".ts")
C_TOKEN = re.compile(r'(?P<comment>//[^\n]*|/\*.*?\*/)|R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|`(?:\\.|[^`\\])*`'
                     r"|\b\d[\w.']*|'(?:\\.|[^'\\\n])+'", re.S)
HASH_COMMENT = re.compile(r"^[ \t]*(#(?!!)[^\n]*)|[ \t](# [^\n\"']*)$", re.M)
NO_PROSE = re.compile(r"NOLINT|clang-format|shellcheck|SPDX|type:|noqa")

LIST_ITEM = re.compile(r"(?:[-*+]|\d+[.)])\s+")
ABBREVIATION = re.compile(r"\b(e\.g|i\.e|et al|eqs?|figs?|cf|vs|approx)\.(?=\s)")
CODE_SPAN = re.compile(r"(`+)(?:(?!\1).)+\1|\$[^$]+\$", re.S)
LINK = re.compile(r"!\[[^\]]*\]\([^)]*\)|\[([^\]]*)\]\([^)]*\)|<[^<>\s][^<>]*>")
UNIT = re.compile(r"\[[^\[\]]{1,20}\]")
CALL = re.compile(r"(?<=\w)(\([^()]*\)|\[[^\[\]]*\])")
OPERATOR = re.compile(r"\s+(?:[-+*/=<>^|~&%!:]=?|->|<=>|&&|\|\||\*\*|[≤≥·×→≈±])\s+")
SENTENCE_END = re.compile(r"(?<![.\s])[.!?][)\"'*_]*\s+|\.\.\.\s+(?=[A-Z])")


def c_comments(text):
    """Yields (column of the comment, offset of its text, its text), line by line."""
    for match in C_TOKEN.finditer(text):
        offset, column = match.start(), match.start() - text.rfind("\n", 0, match.start())
        for line in (match["comment"] or "").splitlines(keepends=True):
            marker = re.match(r"\s*(///?<?|/\*+|\*/?)?[ ]?", line)[0]
            yield column, offset + len(marker), line[len(marker):].rstrip().removesuffix("*/")
            offset += len(line)


def hash_comments(text):
    for match in HASH_COMMENT.finditer(text):
        begin = match.start(1) if match[1] else match.start(2)
        marker = re.match(r"#+[ ]?", text[begin:])[0]
        yield begin - text.rfind("\n", 0, begin), begin + len(marker), text[begin + len(marker):match.end()].rstrip()


def python_comments(text):
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    begins_statement = True
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        column, offset = token.start[1], starts[token.start[0] - 1] + token.start[1]
        if token.type == tokenize.COMMENT and not token.string.startswith("#!"):
            yield column, offset + 2, token.string[2:]
        elif token.type == tokenize.STRING and begins_statement:
            for line in token.string.removesuffix('"""').splitlines(keepends=True):
                marker = re.match(r"\w?['\"]+" if line == token.string[:len(line)] else f"[ ]{{0,{column}}}", line)[0]
                yield column, offset + len(marker), line[len(marker):].rstrip()
                offset += len(line)
        if token.type not in (tokenize.NL, tokenize.COMMENT):
            begins_statement = token.type in (tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT)


def comment_blocks(text, comments):
    """Joins comment lines below each other into blocks: lists of (offset, text)."""
    block, last_column, last_line = [], 0, -2
    for column, offset, line in comments:
        number, begin = text.count("\n", 0, offset), text.rfind("\n", 0, offset) + 1
        if block and (number > last_line + 1 or column != last_column or text[begin:offset].strip(" \t/*#<")):
            yield block
            block = []
        if not NO_PROSE.match(line):
            block.append((offset, line))
        last_column, last_line = column, number
    yield block


def markdown_block(text):
    block, offset, fence = [], 0, ""
    for line in re.sub(r"<!--.*?-->", lambda m: re.sub(r"[^\n]", " ", m[0]), text, flags=re.S).splitlines(keepends=True):
        mark = re.match(r"\s*(```+|~~~+|\$\$(?!.*\$\$\s*$)|---$(?=.)|:::)", line)
        if fence:
            fence = "" if mark and mark[1] == fence else fence
        elif mark:
            fence = mark[1]
        block.append((offset, "" if fence or mark or line.startswith("<") else line.rstrip()))
        offset += len(line)
    return block


def paragraphs(block, indented_is_code):
    """Yields lists of (offset, text), each a run of sentences."""
    paragraph, indent, in_list = [], 0, False
    for offset, line in block:
        stripped = line.strip()
        own_indent = len(line) - len(line.lstrip())
        item = LIST_ITEM.match(stripped)
        starts = not stripped or item or stripped.startswith(("|", "#", "@", ">")) or own_indent < indent
        code = indented_is_code and own_indent >= 2 + (indent if paragraph else 0) and not in_list and not item
        if starts or code or stripped.startswith("---"):
            yield paragraph
            paragraph = []
            in_list = in_list and own_indent >= indent
        if stripped.startswith("---"):
            yield [(offset + own_indent, stripped)]
        elif stripped.startswith("|"):
            for cell in re.finditer(r"(?:\\\||`[^`]*`|[^|])+", line):
                yield [(offset + cell.start(), cell[0])]
        elif stripped and not code:
            indent = own_indent + bool(item) if not paragraph else indent
            in_list = in_list or bool(item)
            paragraph.append((offset + own_indent + (item.end() if item else 0), stripped[item.end() if item else 0:]))
    yield paragraph


def sentences(paragraph):
    """Yields (offset, sentence)."""
    text, places = "", []
    for offset, line in paragraph:
        places.append((len(text), offset))
        text += line + " "
    spans = CODE_SPAN.sub(lambda m: "`" + "_" * (len(m[0]) - 2) + "`", text)
    spans = ABBREVIATION.sub(lambda m: m[0].replace(".", "_"), spans)
    begin = 0
    for end in [match.end() for match in SENTENCE_END.finditer(spans)] + [len(text)]:
        start, offset = [place for place in places if place[0] <= begin][-1]
        yield offset + begin - start, text[begin:end].strip()
        begin = end


def count_words(sentence):
    plain = LINK.sub(lambda m: m[1] or "", CODE_SPAN.sub("X", sentence))
    plain = UNIT.sub("", plain)
    for _ in range(3):
        plain = CALL.sub("", plain)
    plain = OPERATOR.sub("=", plain)
    return sum(bool(re.search(r"\w", word)) for word in plain.split())


def blocks_of(path, text):
    if path.endswith(".md"):
        return [markdown_block(text)]
    if path.endswith(C_LIKE):
        return comment_blocks(text, c_comments(text))
    if path.endswith(".py") or text.startswith("#!/usr/bin/env python3"):
        return comment_blocks(text, python_comments(text))
    return comment_blocks(text, hash_comments(text))


def check_file(path, text):
    """Yields (line, problem)."""
    for block in blocks_of(path, text):
        for paragraph in paragraphs(block, not path.endswith(".md")):
            for offset, sentence in sentences(paragraph) if paragraph else ():
                words = count_words(sentence)
                first = " ".join(sentence.split()[:8])
                line = text.count("\n", 0, offset) + 1
                if words > LONGEST:
                    yield line, f'{words} words: "{first} ..."'
                if WEAK_START.match(sentence):
                    yield line, f'begins with "{WEAK_START.match(sentence)[0]}": "{first} ..."'


def is_checked(name):
    return (name.endswith((*C_LIKE, ".py", ".sh", ".cmake", "CMakeLists.txt", ".md", ".yml", ".toml"))
            or re.fullmatch(r"(script|\.ci)/[^.]*", name))


if __name__ == "__main__":
    checked = checks.tracked(is_checked)
    checks.report_lines(checked, check_file, f"check_sentences: {len(checked)} files, no long sentence")
