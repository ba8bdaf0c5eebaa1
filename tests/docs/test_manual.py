#!/usr/bin/env python3
"""The manual: test_manual.py [Links | Snippets]. Snippets needs PROGRAM, COMPILER and INCLUDES of the environment."""

import json
import os
import pathlib
import re
import shlex
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted(ROOT.glob("docs/**/*.md"))]


def without_code(text):
    """Fenced blocks become empty lines, so that lines keep their numbers."""
    text = re.sub(r"^```.*?^```", lambda block: "\n" * block[0].count("\n"), text, flags=re.M | re.S)
    return re.sub(r"`[^`\n]*`", "", text)


def anchors(page):
    """Anchors of the page's headings, as GitHub makes them."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S)
    found = []
    for heading in re.findall(r"^#+ +(.*?) *$", text, re.M):
        name = re.sub(r"[^\w\- ]", "", re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()).replace(" ", "-")
        count = sum(re.fullmatch(rf"{re.escape(name)}(-\d+)?", other) is not None for other in found)
        found.append(f"{name}-{count}" if count else name)
    return found + re.findall(r'<a (?:id|name)="([^"]+)"', text)


class Links(unittest.TestCase):
    def test_each_leads_to_a_file_and_a_heading(self):
        for page in [*PAGES, ROOT / "CHANGELOG.md", ROOT / "benchmarks/README.md"]:
            text = without_code(page.read_text())
            for link in [*re.finditer(r"\]\(([^)\s]+)\)", text), *re.finditer(r'<(?:img src|a href)="([^"]+)"', text)]:
                path, _, anchor = link[1].partition("#")
                if re.match(r"\w+:", path):
                    continue
                target = (page.parent / path).resolve() if path else page
                with self.subTest(link=f"{page}:{text.count(chr(10), 0, link.start()) + 1}: {link[1]}"):
                    self.assertTrue(target.exists(), "there is no such file")
                    if anchor and target.suffix == ".md":
                        self.assertIn(anchor, anchors(target), "there is no such heading")

    def test_files_and_scenes_that_pages_name_exist(self):
        for page in PAGES:
            text = page.read_text()
            for path in re.findall(r"`((?:souple|app|render|plugins|tests|script|benchmarks|scenes|cmake|web)/[\w./-]+)`", text):
                with self.subTest(page=page.name, path=path):
                    self.assertTrue((ROOT / path).exists() or (ROOT / f"{path}.cpp").exists())
            for scene in re.findall(r"souple (?:run|view|render|surface|check) ([a-z_]+)(?![\w./])", text):
                with self.subTest(page=page.name, scene=scene):
                    self.assertTrue((ROOT / f"scenes/{scene}.json").exists())

    def test_the_gallery_shows_every_scene_and_the_index_every_page(self):
        gallery = (ROOT / "docs/gallery.md").read_text().split("<!-- gallery")[1].split("<!-- end of gallery")[0]
        self.assertEqual(sorted(re.findall(r"souple view (\w+)", gallery)), sorted(p.stem for p in ROOT.glob("scenes/*.json")))
        named = set(re.findall(r"\]\(([\w-]+\.md)\)", (ROOT / "docs/index.md").read_text()))
        self.assertEqual(named | {"index.md"}, {path.name for path in ROOT.glob("docs/*.md")})

    def test_citation_names_the_version(self):
        version = re.search(r"project\(souple VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
        self.assertIn(f"\nversion: {version}\n", (ROOT / "CITATION.cff").read_text())

    def test_a_warning_fails_no_build_of_a_user(self):
        presets = json.loads((ROOT / "CMakePresets.json").read_text())["configurePresets"]
        release = next(preset for preset in presets if preset["name"] == "release")
        self.assertNotIn("SOUPLE_WARNINGS_AS_ERRORS", release.get("cacheVariables", {}))


# A block without a main function is compiled in a function of its own. A session's headers are C++17.
OBJECTS = "veil crate bone post door rope ball sleeve shirt bead water".split()
WORLD = ("#include <souple/mesh_files/mesh_file.h>\n#include <souple/souple.h>\n#include <souple/surface/fluid_surface.h>\n"
         "#include <souple/threads/threads.h>\nusing namespace souple;\n",
         "World& world, const TriangleMesh& mesh, const std::vector<PoseKey>& keys, "
         + ", ".join("ObjectId " + name for name in OBJECTS))
SESSION = "#include <souple/host/session.h>\n", "souple::host::Session& session, souple::host::Handle cloth"
# Beginnings of commands of the program that are not run: why. Scripts are only looked for.
NOT_RUN = {
    "view": "needs a screen; tests/app/test_view_window.py opens it",
}
# Options that make long commands short.
SMALL = {"run": {"--frames": "2"}, "render": {"--frames": "2", "--size": "64x36", "--samples": "1"},
         "sweep": {"--frames": "2"}, "bench": {"--size": "10", "--runs": "2"}}


def blocks(language):
    for page in PAGES:
        if page.name == "CONTRIBUTING.md":
            continue  # its commands change the machine
        for found in re.finditer(rf"^```{language}\n(.*?)^```$", page.read_text(), re.M | re.S):
            yield page.name, found[1]


class Snippets(unittest.TestCase):
    def compiles(self, text):
        standard = "c++17" if "session.h" in text else "c++20"
        done = subprocess.run([os.environ["COMPILER"], f"-std={standard}", "-fsyntax-only", f"-I{ROOT}",
                               f"-I{os.environ['INCLUDES']}", "-xc++", "-"], input=text, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_cpp_compiles(self):
        functions = {WORLD: [], SESSION: []}
        for page, text in blocks("cpp"):
            if re.search(r"^int main\(", text, re.M):
                with self.subTest(page=page, begins=text.split("\n")[0]):
                    self.compiles(text)
            else:
                context = SESSION if "session." in text else WORLD
                functions[context].append(f'void {re.sub("[^a-z]", "_", page)}_{len(functions[context])}({context[1]}) {{{{\n'
                                          f'#line 1 "{page}"\n{text}}}}}\n')
        for (headers, _), texts in functions.items():
            self.compiles(headers + "".join(texts))

    def commands(self):
        for page, text in blocks("sh"):
            for line in text.replace("\\\n", " ").split("\n"):
                line = re.sub(r"\s+#.*", "", line).strip()
                if line:
                    yield page, line

    def test_commands_of_the_gallery_have_options_that_exist(self):
        said = {}
        shown = {line for page in PAGES for line in re.findall(r"<code>souple ([^<]*)</code>", page.read_text())}
        self.assertGreater(len(shown), 60)
        for line in shown:
            command, *words = shlex.split(line)
            if command not in said:
                said[command] = subprocess.run([os.environ["PROGRAM"], command, "--help"], capture_output=True, text=True).stdout
            for option in (word for word in words if word.startswith("--")):
                self.assertIn(f" {option} ", said[command], line)

    def test_commands_run(self):
        with tempfile.TemporaryDirectory() as folder:
            work = pathlib.Path(folder)
            for link in "bin/souple", "build/release/bin/souple":
                (work / link).parent.mkdir(parents=True)
                (work / link).symlink_to(os.environ["PROGRAM"])
            (work / "my").mkdir()
            for name in "my_scene.json", "my/scene.json":
                (work / name).write_text((ROOT / "scenes/flag.json").read_text())
            (work / "pool.json").write_text(next(text for page, text in blocks("json") if '"raft"' in text))
            environment = dict(os.environ, PATH=f"{work}/bin:{os.environ['PATH']}")
            for scene, name in ("dam_break", "dam"), ("flag", "flag"):
                self.run_in(work, environment, f"souple run {scene} --frames 3 --quiet --out out/{name}")
            for page, line in self.commands():
                with self.subTest(page=page, line=line):
                    if line.startswith("script/"):
                        self.assertTrue(os.access(ROOT / line.split()[0], os.X_OK))
                    for part in line.split("&&"):
                        said = re.match(r"(?:build/release/bin/)?souple (.*)", part.strip())
                        if said and not any(said[1].startswith(words) for words in NOT_RUN):
                            self.run_in(work, environment, part)

    def run_in(self, work, environment, line):
        line, _, file = line.partition(">")
        words = shlex.split(re.sub(r"--frames \d+-\d+(/\d+)?", "--frames 1-3/2", re.sub(r"--sheet \d+x\d+", "--sheet 2x1", line)))
        command = words[1] if len(words) > 1 else ""
        for option, value in SMALL.get(command, {}).items():
            of_results = command == "render" and ("--sheet" in words or words[2].startswith("out/"))
            if option in words and "-" not in words[words.index(option) + 1]:
                words[words.index(option) + 1] = value
            elif option not in words and not (option == "--frames" and of_results):
                words += [option, value]
        words += ["--no-sheet"] if command == "sweep" else []
        done = subprocess.run(words, cwd=work, env=environment, capture_output=True, text=True, timeout=60, stdin=subprocess.DEVNULL)
        if done.returncode == 2 and "this program was built without" in done.stderr:
            return
        self.assertEqual(done.returncode, 0, f"{' '.join(words)}\n{done.stdout}{done.stderr}")
        if file:
            (work / file.strip()).write_text(done.stdout)


if __name__ == "__main__":
    unittest.main()
