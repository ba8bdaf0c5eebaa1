#!/usr/bin/env python3
"""Cases of script/check_sentences.py. Standard library only."""

import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "script"))
import check_sentences

HALF = " ".join(["word"] * 13)  # a sentence may have 25
LONG = f"{HALF} {HALF}."


class Sentences(unittest.TestCase):
    def check(self, name, text, *lines):
        self.assertEqual([line for line, _ in check_sentences.check_file(name, text)], list(lines), text)

    def test_lines_join_to_sentences(self):
        self.check("a.h", f"/// Fits.\nint x;  ///< {HALF},\n        ///< {HALF}.\n", 2)
        self.check("a.py", f'def f():\n    """{HALF}\n    {HALF}."""\n', 2)
        self.check("a.sh", f"# {HALF}\n# {HALF}.\n", 1)
        self.check("a.md", f"{HALF}\n{HALF}.\n\n- {HALF},\n  {HALF}.\n", 1, 4)

    def test_what_ends_a_sentence(self):
        self.check("a.h", f"// {HALF}. {HALF}.\n// {HALF}\n//\n// {HALF}:\n//   x = {LONG}\n// {HALF}\n// - {HALF};\n// - {HALF}.\n")
        self.check("a.md", f"| {HALF} | {HALF} |\n{HALF}\n```\n{LONG}\n```\n{HALF}\n")
        self.check("a.h", f"// {HALF} (Müller et al. 2007, eq. 3), e.g. {HALF}.\n", 1)

    def test_what_counts_as_a_word(self):
        three = "`two words` [m/s] f(x, y) a = b + c"
        self.check("a.h", f"// {HALF} {three} one two three four five six seven eight nine.\n")
        self.check("a.h", f"// {HALF} {three} one two three four five six seven eight nine ten.\n", 1)
        self.check("a.h", f'char* s = "// {LONG}";\n')

    def test_first_words(self):
        self.check("a.h", "// Of a body.\n\n// What it is.\n\n// What is it?\n\n/// The same, later.\n\n// Offer it. As above.\n", 1, 3, 7, 9)


if __name__ == "__main__":
    unittest.main()
