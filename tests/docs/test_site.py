#!/usr/bin/env python3
"""The documentation as a site: test_site.py SOURCE_FOLDER. Builds it as script/docs does, without the C++ reference.

Needs mkdocs and its theme; where they are missing, it says so and passes. Standard library only.
"""
import html.parser
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import urllib.parse

SOURCE = pathlib.Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2]


class Page(html.parser.HTMLParser):
    """Targets of links and pictures, and what links can name."""

    def __init__(self, text):
        super().__init__()
        self.targets, self.names = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.targets += [given[key] for key in ("href", "src") if given.get(key)]
        self.names |= {given[key] for key in ("id", "name") if given.get(key)}


def command():
    """The words of script/docs that build the site."""
    return re.search(r"^mkdocs build (.*)$", (SOURCE / "script/docs").read_text(), re.M)[1].split()


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if not shutil.which("mkdocs"):
            raise unittest.SkipTest("mkdocs is not installed: Debian packages mkdocs and mkdocs-material")
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.site = pathlib.Path(cls.folder.name, "site")
        done = subprocess.run(["mkdocs", "build", *command(), "--site-dir", cls.site], cwd=SOURCE, capture_output=True,
                              text=True)
        if "Unrecognised theme" in done.stdout + done.stderr:
            raise unittest.SkipTest("mkdocs has no theme material: Debian package mkdocs-material")
        assert done.returncode == 0, done.stdout + done.stderr
        cls.pages = {path: Page(path.read_text()) for path in sorted(cls.site.rglob("*.html"))}

    def test_every_page_is_there(self):
        expected = {f"{path.stem}.html" for path in SOURCE.glob("docs/*.md")}
        self.assertLessEqual(expected, {path.name for path in self.pages})

    def test_no_link_is_dead(self):
        for path, page in self.pages.items():
            if path.name == "404.html":
                continue  # its links begin at the root of a server
            for target in page.targets:
                url = urllib.parse.urlsplit(target)
                if url.scheme or url.netloc or target.startswith("api/"):
                    continue
                file = (path.parent / urllib.parse.unquote(url.path)).resolve() if url.path else path
                with self.subTest(page=path.name, target=target):
                    file = file / "index.html" if file.is_dir() else file
                    self.assertTrue(file.exists(), f"{path.name}: {target}: there is no such file")
                    if url.fragment and file in self.pages and url.fragment != "__tabbed":
                        self.assertIn(urllib.parse.unquote(url.fragment), self.pages[file].names, f"{path.name}: {target}")

    def test_the_front_page_shows_the_loops(self):
        loops = [target for target in self.pages[self.site / "index.html"].targets if target.endswith(".webp")]
        self.assertGreaterEqual(len(loops), 7, "the film and the large loops of script/gallery")

    def test_search_finds_every_page(self):
        places = {entry["location"].partition("#")[0]
                  for entry in json.loads((self.site / "search/search_index.json").read_text())["docs"]}
        self.assertLessEqual({f"{path.stem}.html" for path in SOURCE.glob("docs/*.md")}, places)
        worker = re.search(r'"search": "([^"]+)"', (self.site / "index.html").read_text())[1]
        self.assertTrue((self.site / worker).is_file(), worker)


if __name__ == "__main__":
    unittest.main()
