#!/usr/bin/env python3
"""What README.md, CONTRIBUTING.md and docs/ count and bound is what the tree says.

    test_counts.py SOURCE_DIR

COUNTS holds each sentence with a number, and where its truth stands. A sentence that is gone fails, so an entry goes with
its sentence. SWEEP finds counts that no entry covers: add one, leave the number out, or say in ALLOWED why it is none.
docs/scene-format.md counts as truth, since another test compares it with the program's own text.
"""
import importlib.util
import json
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2]
PAGES = ["README.md", "CONTRIBUTING.md", *sorted(str(p.relative_to(ROOT)) for p in ROOT.glob("docs/*.md"))]
ONES = ("zero one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen seventeen "
        "eighteen nineteen").split()
TENS = "twenty thirty forty fifty sixty seventy eighty ninety".split()
WORDS = {word: n for n, word in enumerate(ONES)}
WORDS |= {tens + ("-" + ONES[one] if one else ""): 10 * n + one for n, tens in enumerate(TENS, 2) for one in range(10)}
ORDINALS = {"third": 3, "eighth": 8, "twentieth": 20}
NUMBER = r"-?\d[\d,']*(?:\.\d+)?(?:e-?\d+)?"


def read(path):
    return (ROOT / path).read_text(encoding="utf-8")


def value(said):
    """The number that a word or digits mean."""
    said = said.lower()
    return (WORDS | ORDINALS)[said] if said in WORDS | ORDINALS else float(re.sub("[,']", "", said))


def find(path, pattern):
    """The number in the pattern's one group, in a file of the tree."""
    found = re.search(pattern, read(path))
    if not found:
        raise LookupError(f"{path} has no /{pattern}/ any more: say in COUNTS where it is now")
    return value(found[1])


def constant(path, name):
    return find(path, rf"\b{name}\s*=\s*({NUMBER})")


def enumerators(path, name):
    body = re.search(rf"enum class {name}\b[^{{]*{{(.*?)}}", re.sub("//.*", "", read(path)), re.S)[1]
    return re.findall(r"\w+", re.sub(r"=[^,]*", "", body))


def key(section, name):
    """(what values are allowed, default) of a key of scene files."""
    text = read("docs/scene-format.md").split(f"\n## {section}\n")[1].split("\n## ")[0]
    return re.search(rf"^\| `{name}` \| ([^|]*) \| `?([^|`]*)`? \|", text, re.M).groups()


def default(section, name):
    return float(key(section, name)[1])


def largest(section, name):
    return value(re.search(rf"(?:to|<=) ({NUMBER})", key(section, name)[0])[1])


def scene(name):
    return json.loads(read(f"scenes/{name}.json"))


def scenes(kind=None):
    """Names of the shipped scenes, or of those with an object of a kind."""
    names = sorted(path.stem for path in ROOT.glob("scenes/*.json"))
    return [name for name in names if kind is None or any(o["kind"] == kind for o in scene(name)["objects"])]


def bodies(name, kind):
    return sum(o["kind"] == kind for o in scene(name)["objects"])


def measured(form, threads, what):
    return next(result[what] for result in json.loads(read("docs/measured/bench.json"))["results"]
                if (result["name"], result["size"], result["form"], result["threads"]) == ("cloth", 200, form, threads))


def equal_strain(engine, what):
    """Of the hanging cloth on one thread."""
    return next(row[what] for row in json.loads(read("docs/measured/equal.json"))["results"]["rows"]
                if (row["motion"], row["engine"], row["threads"]) == ("hanging", engine, 1))


def initializers(path, struct):
    """{field: its initializer} of a struct, as text."""
    body = re.search(rf"struct {struct} {{(.*?)\n}};", re.sub("//.*", "", read(path)), re.S)[1]
    body = re.sub(r"friend .*", "", body)
    return dict(re.findall(r"\b(\w+)\s*(?:=|(?={))\s*([^;]*);", body))


def preset(name, field, otherwise=0):
    fields = re.search(rf"Material {name}{{(.*?)}};", read("souple/objects/materials.cpp"), re.S)[1]
    found = re.search(rf"\.{field} = ({NUMBER})", fields)
    return value(found[1]) if found else otherwise


def shaken(test):
    """Particles in the box that a test shakes."""
    sides = re.findall(r"^  shake\((\d+), (\d+), (\d+),", read("tests/physics/test_fluid_robustness.cpp"), re.M)[test]
    across, high, deep = map(int, sides)
    return across * high // 2 * deep


STAGES = enumerators("souple/world/report.h", "Stage")
SEGMENT_TESTS = enumerators("souple/collision/detection.h", "SegmentTest")
INTEGRATORS = enumerators("souple/stages/settings.h", "Integrator")
CLOTH_TESTS = "tests/physics/test_collision_cloth.cpp"
COLUMN_TESTS = "tests/physics/test_fluid_column.cpp"
SOFT_TESTS = "tests/physics/test_collision_soft.cpp"
LIQUID_TESTS = "tests/render/test_liquid.cpp"
MESH_TESTS = "tests/surface/test_fluid_surface.cpp"
EXACT_TESTS = "tests/collision/segment_triangle/test_exact.cpp"
RESOLVER = "souple/intersections/intersection_resolver.cpp"

# Page, pattern with one group for the number (a space stands for any white space), the truth.
COUNTS = [
    ("CONTRIBUTING.md", r"the fuzzers and ([\d,]+) mutated files", lambda: find("script/fuzz", r"count=\$\(\(\((\d+) \+")),
    ("CONTRIBUTING.md", r"test \((\d+) frames, ", lambda: constant("tests/golden/test_golden.cpp", "usual_frames")),
    ("CONTRIBUTING.md", r"frames, (\d+) with fluids\)", lambda: constant("tests/golden/test_golden.cpp", "usual_fluid_frames")),
    ("CONTRIBUTING.md", r"slow \((\d+)\), bits", lambda: constant("tests/golden/test_golden.cpp", "all_frames")),
    ("CONTRIBUTING.md", r"bits and builds with clang \((\d+)\)", lambda: find(".ci/run", r"lane_clang\(\)[^}]*?GOLDEN_FRAMES=(\d+)")),
    ("CONTRIBUTING.md", r"asan and builds with debug \((\d+)\)", lambda: find(".ci/run", r"lane_debug\(\)[^}]*?GOLDEN_FRAMES=(\d+)")),
    ("README.md", r"(\w+) visible, timed stages", lambda: len(STAGES)),
    ("README.md", r"(\w+) integrators;", lambda: len(INTEGRATORS)),
    ("README.md", r'alt="(\w+) jelly ducks"', lambda: bodies("jelly_armada", "soft_body")),
    ("README.md", r"below 2 % in ([\d.]+) ms a frame", lambda: round(equal_strain("Souple, automatic", "ms_per_frame"), 1)),
    ("README.md", r"Bullet's strain is \[([\d.]+) % at", lambda: round(100 * equal_strain("Bullet", "largest_strain"), 1)),
    ("README.md", r"% at ([\d.]+) ms\]", lambda: round(equal_strain("Bullet", "ms_per_frame"))),
    ("README.md", r"CMake ([\d.]+)", lambda: find("CMakeLists.txt", r"cmake_minimum_required\(VERSION ([\d.]+)\)")),
    ("README.md", r"columns of (\d+) layers", lambda: max(map(int, re.findall(r"Case{[\d.]+, (\d+),", read(COLUMN_TESTS))))),
    ("README.md", r"right height and pressure \(within (\d+) %",
     lambda: 100 * find(COLUMN_TESTS, r'"height / H", height, 1, ([\d.]+)')),
    ("README.md", r"on screen by (\w+) filters", lambda: len(enumerators("render/renderer.h", "LiquidFilter")) - 1),
    ("README.md", r"vertices and ([\d,]+) constraints", lambda: measured("plain", 1, "constraints")),
    ("README.md", r"a frame of (\w+) substeps", lambda: measured("plain", 1, "substeps")),
    ("README.md", r"takes ([\d.]+) ms for a frame", lambda: round(measured("plain", 1, "ms_per_step"), 1)),
    ("README.md", r"\((\d+) million constraints a second",
     lambda: round(measured("plain", 1, "constraints_per_second") / 1e6)),
    ("README.md", r"([\d.]+) ms on two;", lambda: round(measured("plain", 2, "ms_per_step"), 1)),
    ("README.md", r"([\d.]+) and [\d.]+ ms in the displacement form",
     lambda: round(measured("displacement", 1, "ms_per_step"), 1)),
    ("README.md", r"and ([\d.]+) ms in the displacement form", lambda: round(measured("displacement", 2, "ms_per_step"), 1)),

    ("docs/architecture.md", r"whole packs of (\d+)", lambda: constant("souple/threads/work_partition.h", "pack")),
    ("docs/architecture.md", r"a cap of (\d+) times the weight", lambda: constant("souple/host/grab.cpp", "strength")),
    ("docs/embedding.md", r"no harder than (\d+) weights", lambda: constant("souple/host/grab.cpp", "strength")),
    ("docs/radium.md", r"no harder than (\d+) times its weight", lambda: constant("souple/host/grab.cpp", "strength")),
    ("docs/embedding.md", r"`longest_step` \(([\d.]+) s\)", lambda: constant("souple/host/clock.h", "longest_step")),

    ("docs/collisions.md", r"some of (\d+) groups", lambda: 1 + largest("cloth", "collision_groups")),
    ("docs/collisions.md", r"group numbers from 0 to (\d+)", lambda: largest("cloth", "collision_groups")),
    ("docs/collisions.md", r"a whole number from 0 to (\d+)", lambda: largest("cloth", "layer")),
    ("docs/collisions.md", r"\*(\d+) x \d+ vertices with `self_collision`",
     lambda: find(CLOTH_TESTS, r"drop_and_look\((\d+),")),
    ("docs/collisions.md", r"in chunks of (\d+)\.", lambda: constant("souple/contacts/surfaces/pair_chunks.h", "chunk_size")),
    ("docs/collisions.md", r"If (\w+) rounds do not", lambda: constant("souple/contacts/surfaces/motion_filter.cpp", "correction_passes")),
    ("docs/collisions.md", r"than `speed` \(([\d.]+) m/s,", lambda: default("sleeping", "speed")),
    ("docs/collisions.md", r"for `seconds` \(([\d.]+) s\)", lambda: default("sleeping", "seconds")),
    ("docs/collisions.md", r"a cloth of (\d+) x \d+ falls on",
     lambda: find(CLOTH_TESTS, r"drape_fold_and_look\((\d+), GetParam")),
    ("docs/collisions.md", r"twisted by (\w+) turns",
     lambda: find(CLOTH_TESTS, r"TenTurns.*?\{\s*twist_and_look\(\d+, (\d+),")),
    ("docs/collisions.md", r"(\w+) soft balls, 30 s", lambda: find(SOFT_TESTS, r"drop_and_look\((\d+), 30,")),
    ("docs/collisions.md", r"soft balls, (\d+) s", lambda: find(SOFT_TESTS, r"drop_and_look\(50, (\d+),")),
    ("docs/collisions.md", r"grains at (\d+) m/s at a cloth",
     lambda: find("tests/physics/test_collision_fast.cpp", r"shot_at\(what, n, grains, (\d+)\)")),
    ("docs/collisions.md", r"with the default (\d+) substeps", lambda: default("scene", "substeps")),
    ("docs/collisions.md", r"every (\w+) step if driven", lambda: find("souple/world/contacts.cpp", r"interval = (\d+);")),
    ("docs/collisions.md", r"objects (\d+) directions and", lambda: constant(RESOLVER, "all_directions")),
    ("docs/collisions.md", r"directions and (\d+) distances are", lambda: constant(RESOLVER, "distances")),
    ("docs/collisions.md", r"within a (\w+) of the lower object's size",
     lambda: 1 / constant("souple/intersections/layers.cpp", "range_part")),
    ("docs/collisions.md", r"exact at grid points within (\d+) spacings",
     lambda: constant("souple/collision/signed_distance_field.h", "fine_cells")),

    ("docs/fluids.md", r"0 to (\d+)\. With 0 a substep", lambda: largest("fluid_settings", "iterations")),
    ("docs/fluids.md", r"Above ([\d.]+) the step raises",
     lambda: constant("souple/world/step_report.cpp", "max_fluid_step")),
    ("docs/fluids.md", r"measured inside the drop, from (\d+) to",
     lambda: find("souple/fluid/surface_tension.cpp", r"degrees\[\] = {[^}]*, (\d+)}")),
    ("docs/fluids.md", r"measured inside the drop, from \d+ to (\d+)\.",
     lambda: find("souple/fluid/surface_tension.cpp", r"degrees\[\] = {(\d+),")),
    ("docs/fluids.md", r"tested with (\w+) substeps where",
     lambda: find(COLUMN_TESTS, r"expect_rest\((\d+), [\d.]+, {\.kernel")),
    ("docs/fluids.md", r"where the default has (\w+)\.", lambda: find(COLUMN_TESTS, r"expect_rest\((\d+), [\d.]+, {}\)")),
    ("docs/fluids.md", r"`water` \((\d+) kg", lambda: preset("water", "density")),
    ("docs/fluids.md", r"kg/m\^3, (\d+) mPa s\), `oil`", lambda: 1000 * preset("water", "viscosity")),
    ("docs/fluids.md", r"`oil` \((\d+),", lambda: preset("oil", "density")),
    ("docs/fluids.md", r"`oil` \(\d+, (\d+) mPa", lambda: 1000 * preset("oil", "viscosity")),
    ("docs/fluids.md", r"`honey` \((\d+),", lambda: preset("honey", "density")),
    ("docs/fluids.md", r"`honey` \(\d+, (\d+) Pa", lambda: preset("honey", "viscosity")),
    ("docs/fluids.md", r"volume of a ball of diameter 20 d .* \| (\d+) % \|",
     lambda: 100 * find(MESH_TESTS, r"/ volume, 1, ([\d.]+)")),
    ("docs/fluids.md", r"deviation of a pool's mesh, lattice .* \| ([\d.]+) d \|",
     lambda: find(MESH_TESTS, r"still\.deviation, ([\d.]+)")),
    ("docs/fluids.md", r"steps of curvature flow, 1 to (\d+)", lambda: constant("render/renderer.h", "max_liquid_steps")),
    ("docs/fluids.md", r"area covered within (\d+) %", lambda: 100 * find(LIQUID_TESTS, r"compared\.area, 1, ([\d.]+)")),
    ("docs/fluids.md", r"depth within ([\d.]+) d for", lambda: find(LIQUID_TESTS, r"too_deep, [\d.]+\), ([\d.]+) \*")),
    ("docs/fluids.md", r"0.75 d for (\d+) % of pixels", lambda: 100 * find(LIQUID_TESTS, r"too_deep, ([\d.]+)\)")),
    ("docs/fluids.md", r"`wide_wendland`, support ([\d.]+) d",
     lambda: find("souple/fluid/smoothing.cpp", r"wide_wendland:\s*return shape_of<[\w:]+>\(([\d.]+),")),
    ("docs/fluids.md", r"The tests shake ([\d,]+) particles", lambda: shaken(0)),
    ("docs/fluids.md", r"slowly, ([\d,]+) for 20 s", lambda: shaken(1)),
    ("docs/fluids.md", r"balloon.json` 10 kg of water hang in 1.8 kg of cloth \((\d+) kg",
     lambda: scene("water_balloon")["objects"][1]["material"]["areal_density"]),
    ("docs/fluids.md", r"kg/m\^2, (\d+) substeps\)\. With 1", lambda: scene("water_balloon")["substeps"]),
    ("docs/fluids.md", r"honey_coil.json`: (\d+) Pa s", lambda: scene("honey_coil")["objects"][0]["material"]["viscosity"]),

    ("docs/index.md", r"\): (\w+) tests side by side", lambda: len(SEGMENT_TESTS)),
    ("docs/integrators.md", r"[Tt]he (\w+) integrators", lambda: len(INTEGRATORS)),
    ("docs/known-limits.md", r"coarse relative to them \(([\d.]+) of",
     lambda: constant("souple/contacts/collider_element_contacts.cpp", "coarse_part")),
    ("docs/known-limits.md", r"the scene uses (\d+) iterations", lambda: scene("sand_pile")["iterations"]),
    ("docs/materials.md", r"!\[(\w+) jelly ducks", lambda: bodies("jelly_armada", "soft_body")),
    ("docs/performance.md", r"1/60 s: (\d+) substeps of one", lambda: default("scene", "substeps")),
    ("docs/performance.md", r"the median of (\d+) steps", lambda: constant("app/bench_measure.h", "runs")),
    ("docs/performance.md", r"# about (\w+) minutes; docs", lambda: find("script/measure", r"about (\w+) minutes")),
    ("docs/performance.md", r"at most (\d+) bytes a particle",
     lambda: find("tests/world/test_memory.cpp", r"report\.simulation\), (\d+) \*")),

    ("docs/rendering.md", r"`--size` \| `(\d+)x720`", lambda: find("app/pictures.h", r"PictureSize size{(\d+), 720}")),
    ("docs/rendering.md", r"`\.webp` `(\d+)x360`", lambda: find("app/render.cpp", r"size = {(\d+), 360}")),
    ("docs/rendering.md", r"of a sheet `(\d+)x270`", lambda: find("app/render.cpp", r"size = {(\d+), 270}")),
    ("docs/rendering.md", r"each side from 1 to (\d+)",
     lambda: find("app/picture_arguments.cpp", r"two_numbers\(text, (\d+)\)")),
    ("docs/rendering.md", r"`--samples` \| (\d+), of films", lambda: find("app/render.cpp", r"samples = still \? (\d+) :")),
    ("docs/rendering.md", r"of films and folders (\d+) \|",
     lambda: find("app/render.cpp", r"samples = still \? \d+ : (\d+);")),
    ("docs/rendering.md", r"to at most (\d+) colors", lambda: find("app/render.cpp", r"colors > (\d+)\)")),
    ("docs/rendering.md", r"steps of curvature flow, 1 to (\d+)", lambda: constant("render/renderer.h", "max_liquid_steps")),
    ("docs/rendering.md", r"best, and at most (\d+) pictures a second",
     lambda: find("render/film.cpp", r"Kind::gif\) return (\d+);")),

    ("docs/segment-triangle.md", r"(\w+) tests implement the", lambda: len(SEGMENT_TESTS)),
    ("docs/segment-triangle.md", r"only one of the (\w+) that let", lambda: len(SEGMENT_TESTS)),
    ("docs/segment-triangle.md", r"no leak of any of the (\w+) in", lambda: len(SEGMENT_TESTS)),
    ("docs/segment-triangle.md", r"parameter and weights: ([\d,]+) cases",
     lambda: find(EXACT_TESTS, r"float>\(([\d']+), 1\)")),
    ("docs/segment-triangle.md", r"in double, (\w+) million of each",
     lambda: find(EXACT_TESTS, r"float>\(([\d']+), 3\)") / 1e6),
    ("docs/segment-triangle.md", r"every (\d+)th case", lambda: find(EXACT_TESTS, r"i % (\d+) == 0")),
    ("docs/segment-triangle.md", r"tests (\d+) triangles, all",
     lambda: constant("app/bench_segments.h", "default_segments_size")),

    ("docs/solvers.md", r"linear forms; (\d+) rows of constraints", lambda: constant("souple/linear_solvers/dense.h", "max_rows")),
    ("docs/solvers.md", r"More than (\d+) rows are refused", lambda: constant("souple/linear_solvers/dense.h", "max_rows")),
    ("docs/solvers.md", r"singular value is below ([\de-]+) of", lambda: constant("souple/linear_solvers/dense.cpp", "singular")),
    ("docs/solvers.md", r"from the (\w+) iteration of a substep on",
     lambda: 1 + constant("souple/solver/chebyshev.h", "delay")),
    ("docs/solvers.md", r"a number of colors instead: 1 to (\d+),", lambda: largest("scene", "colors")),
    ("docs/solvers.md", r"tested within ([\de-]+) of the particles' displacements",
     lambda: find("tests/solver/test_partition.cpp", r"Form::plain \? 1e-2 : ([\de-]+)")),
    ("docs/solvers.md", r"is halved, at most (\w+) times",
     lambda: constant("souple/linear_solvers/linearized_solver.cpp", "max_halvings")),
    ("docs/solvers.md", r"changes nothing: a strain of ([\de-]+) in",
     lambda: constant("souple/solver/linear_system.cpp", "floor_strain")),
    ("docs/solvers.md", r"more than ([\de]+) multiplications",
     lambda: constant("souple/linear_solvers/direct.cpp", "max_operations")),
    ("docs/solvers.md", r"ends at ([\de-]+) of the first residual",
     lambda: constant("souple/linear_solvers/conjugate_gradient.h", "tolerance")),
    ("docs/solvers.md", r"or after (\d+) products",
     lambda: find("souple/linear_solvers/conjugate_gradient.cpp", r"std::max\((\d+),")),
    ("docs/solvers.md", r"no two closer than ([\d.]+) mean links",
     lambda: constant("souple/multilevel/hierarchical_levels.cpp", "coarsening")),
    ("docs/solvers.md", r"coarse to fine; (\d+) sweeps a level",
     lambda: find("souple/multilevel/hierarchical.cpp", r"int sweeps = (\d+)")),
    ("docs/solvers.md", r"sweeps a level, (\d+) on the coarsest",
     lambda: constant("souple/multilevel/hierarchical.cpp", "coarsest_sweeps")),
    ("docs/solvers.md", r"\(([\d,]+) rigid constraints\)", lambda: measured("plain", 1, "constraints")),
    ("docs/viewer.md", r"The display modes 1 to (\d+) are", lambda: len(enumerators("render/display.h", "Display"))),
]

SWEEP = re.compile(rf"(?<![\w.,-])(?:\d[\d,]*|{'|'.join(sorted(list(WORDS)[2:], key=len, reverse=True))})\s+"
                   r"(?:[a-z-]+,?\s+){0,2}?(?:scenes|tests|stages|lanes|fuzzers|formats|constraints|presets|"
                   r"instruction sets|solvers|integrators|commands|benchmarks)\b", re.I)
# (page, the words): why it is no count of the tree's.
ALLOWED = {
    ("README.md", "Two commands"): "a heading; the block below it shows both",
    ("README.md", "six pressure solvers"): "of another library",
    ("docs/integrators.md", "1 kg, no constraints"): "a mass",
    ("docs/solvers.md", "two constraints"): "those of a drawing",
}

# What README calls the constraints of souple/constraints/kinds.h.
CONSTRAINTS = {"Distance": "distance", "DihedralBending": "dihedral bending", "IsometricBending": "isometric and",
               "TriangleMembrane": "membrane", "TetVolume": "tet volume", "NeoHookean": "neo-Hookean",
               "RopeBending": "bending of ropes", "ParticleContact": "contact", "Attachment": "attachment",
               "BallJoint": "ball joint", "ConeLimit": "cone and", "TwistLimit": "twist limits", "Tether": "tether"}

# Tables of presets in docs/materials.md: how the head begins, then the fields of each further column.
PRESETS = {
    "cloth | kg/m^2": [["areal_density"], ["membrane_stiffness", "weft_stiffness"], ["shear_stiffness"],
                       ["bending_stiffness"], ["thickness"], ["friction"]],
    "soft body | E [Pa]": [["young_modulus"], ["poisson_ratio"], ["density"]],
    "rope | radius [mm]": [["radius"], ["young_modulus"], ["density"], ["bending_stiffness"]],
    "grains | radius [mm]": [["radius"], ["density"], ["friction"]],
    "fluid | kg/m^3": [["density"], ["viscosity"]],
}
IN_MILLIMETERS = {"thickness", "radius"}

# Tables of defaults in docs/fluids.md: the head's first cell, the struct, rows whose default is told in words.
DEFAULTS = [
    ("`FluidMaterial`, `material`", "souple/objects/materials.h", "FluidMaterial", []),
    ("`Settings::fluid`, `fluid` of a scene", "souple/fluid/fluid_settings.h", "FluidSettings", ["foam"]),
    ("`Settings::fluid.foam`, `fluid.foam` of a scene", "souple/fluid/foam_parameters.h", "FoamParameters", []),
    ("", "souple/surface/surface_options.h", "SurfaceOptions", ["spacing", "cell", "level"]),
]


def numbers(text):
    return [float(n) for n in re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e-?\d+)?", text)]


def rows_below(page, head):
    """Cells of a table's rows, each list without the empty ends."""
    if head not in read(page):
        raise LookupError(f"{page} has no table any more that begins with {head.strip()!r}: mend this test with it")
    for line in read(page).split(head, 1)[1].split("\n")[2:]:
        if not line.startswith("|"):
            return
        yield [cell.strip() for cell in line.strip("|").split("|")]


def without_code(text):
    """Fenced blocks become empty lines, so that lines keep their numbers."""
    text = re.sub(r"^```.*?^```", lambda block: "\n" * block[0].count("\n"), text, flags=re.M | re.S)
    return re.sub(r"`[^`\n]*`", lambda code: "`" * len(code[0]), text)


def anchors(page):
    """Of the page's headings, as the built site and GitHub name them."""
    text = re.sub(r"^```.*?^```", "", read(page), flags=re.M | re.S)
    titles = re.findall(r"^#+ +(.+?)\s*$", text, re.M)
    return {re.sub(r"[\s-]+", "-", re.sub(r"[^\w\s-]", "", title).strip().lower()) for title in titles}


class Counts(unittest.TestCase):
    longMessage = False

    def line(self, page, offset):
        return f"{page}:{read(page).count(chr(10), 0, offset) + 1}"

    def test_each_sentence_says_what_is_true(self):
        for page, pattern, truth in COUNTS:
            with self.subTest(page=page, sentence=pattern):
                found = list(re.finditer(pattern.replace(" ", r"\s+"), read(page)))
                self.assertTrue(found, f"{page} says no more what /{pattern}/ looks for: mend COUNTS with the sentence")
                for match in found:
                    true = truth()
                    self.assertAlmostEqual(value(match[1]), true, delta=1e-6 * abs(true), msg=
                                           f"{self.line(page, match.start(1))} says {match[1]!r}, and it is {true:g}: "
                                           f"{' '.join(match[0].split())!r}")

    def test_no_count_is_unchecked(self):
        for page in PAGES:
            text = read(page)
            covered = [match.span(1) for where, pattern, _ in COUNTS if where == page
                       for match in re.finditer(pattern.replace(" ", r"\s+"), text)]
            for match in SWEEP.finditer(text):
                words = " ".join(match[0].split())
                if (page, words) in ALLOWED:
                    continue
                with self.subTest(page=page, words=words):
                    self.assertTrue(any(match.start() <= begin < match.end() for begin, _ in covered),
                                    f"{self.line(page, match.start())} counts {words!r}, and nothing checks it: "
                                    f"leave the number out, or add it to COUNTS")

    def test_what_is_allowed_is_still_said(self):
        for page, words in ALLOWED:
            self.assertRegex(read(page), words.replace(" ", r"\s+"),
                             f"{page} says no more {words!r}: take it out of ALLOWED")


class Tables(unittest.TestCase):
    def test_defaults_of_fluids_are_those_of_the_structs(self):
        for head, path, struct, told in DEFAULTS:
            fields = initializers(path, struct)
            head = f"\n| {head} | default |" if head else "\n| | default |"
            seen = set()
            for cells in rows_below("docs/fluids.md", head):
                names = re.findall(r"`(\w+)`", cells[0])
                seen |= set(names)
                wanted = " ".join(fields[name] for name in names)
                if set(names) <= set(told):
                    continue
                with self.subTest(struct=struct, row=cells[0]):
                    said = numbers(cells[1])
                    if said:
                        self.assertEqual(said, numbers(wanted), f"docs/fluids.md: default of {cells[0]}")
                    else:
                        self.assertIn(cells[1].strip("`"), wanted, f"docs/fluids.md: default of {cells[0]}")
            self.assertEqual(seen, set(fields), f"docs/fluids.md: the table of {struct}")

    def test_presets_are_those_of_the_program(self):
        seen = set()
        for head, columns in PRESETS.items():
            for cells in rows_below("docs/materials.md", f"\n| {head} |"):
                seen.add(cells[0])
                for cell, fields in zip(cells[1:], columns):
                    true = [preset(cells[0], field) * (1000 if field in IN_MILLIMETERS else 1) for field in fields]
                    said = numbers(cell)
                    with self.subTest(preset=cells[0], fields=fields):
                        for a, b in zip(said + [0] * (len(true) - len(said)), true):
                            self.assertAlmostEqual(a, b, delta=1e-6 * abs(b), msg=f"docs/materials.md: {cells[0]}, {fields}")
        names = re.search(r"names\(\) {\s*return {(.*?)};", read("souple/objects/materials.cpp"), re.S)[1]
        self.assertEqual(seen, set(re.findall(r'"(\w+)"', names)), "docs/materials.md: presets")


class Lists(unittest.TestCase):
    def test_gallery_shows_every_scene(self):
        gallery = read("docs/gallery.md").split("<!-- gallery")[1].split("<!-- end of gallery")[0]
        self.assertEqual(sorted(re.findall(r"souple view (\w+)", gallery)), scenes(), "docs/gallery.md")

    def test_density_error_is_given_of_every_scene_with_a_fluid(self):
        said = [cells[0] for cells in rows_below("docs/fluids.md", "\n| scene | mean |")]
        self.assertEqual(said, scenes("fluid"), "docs/fluids.md: Density error")

    def test_scenes_that_pages_name_are_shipped(self):
        for page in PAGES:
            text = read(page)
            named = set(re.findall(r"\bscenes/(\w+)\b(?!/)", text))
            named |= set(re.findall(r"souple (?:run|view|render|surface|check) ([a-z_]+)(?![\w./])", text))
            self.assertLessEqual(named, set(scenes()), page)

    def test_citation_names_the_version_and_license(self):
        citation = read("CITATION.cff")
        version = re.search(r"project\(souple VERSION ([\d.]+)", read("CMakeLists.txt"))[1]
        self.assertIn(f"\nversion: {version}\n", citation)
        self.assertIn("\nlicense: MIT\n", citation)
        self.assertTrue(read("LICENSE").startswith("MIT License"))

    def test_constraints_of_readme(self):
        lists = re.findall(r"(\w+Constraints) =\s*std::tuple<(.*?)>", read("souple/constraints/kinds.h"), re.S)
        self.assertEqual([name for name, _ in lists], ["MeshConstraints", "OtherConstraints"])
        kinds = {kind for _, kinds in lists for kind in re.findall(r"\w+", kinds)}
        self.assertEqual(kinds, set(CONSTRAINTS), "CONSTRAINTS of this test")
        row = next(line for line in read("README.md").split("\n") if line.startswith("| constraints |"))
        for kind, words in CONSTRAINTS.items():
            self.assertIn(words, row, f"README.md: constraints have no {kind}")

    def test_stages_of_architecture(self):
        said = [cells[0].strip("`") for cells in rows_below("docs/architecture.md", "\n| stage | once per |")]
        self.assertEqual(said, STAGES, "docs/architecture.md: A step")

    def test_floors_of_architecture(self):
        spec = importlib.util.spec_from_file_location("check_floors", ROOT / "script/check_floors.py")
        check_floors = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(check_floors)
        true = {folder: floor for folder, floor in check_floors.FLOORS.items() if (ROOT / folder).is_dir()}
        said = {}
        section = read("docs/architecture.md").split("## The floors")[1].split("## ")[0]
        for line in re.findall(r"^\d[\d.]* +\w.*", section, re.M):
            floor, rest = line.split(maxsplit=1)
            said |= {folder.rstrip("/"): float(floor) for folder in re.findall(r"[\w/]+/(?= |$)", rest.split("   ")[0])}
        self.assertEqual({re.sub("^plugins/.*", "plugins", folder): floor for folder, floor in said.items()}, true)

    def test_tests_of_segments_and_kinds_of_solvers(self):
        said = [cells[0].split("`")[1] for cells in rows_below("docs/segment-triangle.md", "\n| `segment_test` | paper |")]
        self.assertEqual(said, SEGMENT_TESTS, "docs/segment-triangle.md")
        said = {cells[0].strip("`") for cells in rows_below("docs/solvers.md", "\n| `solver.kind` |")
                if cells[0].startswith("`")}
        self.assertEqual(said, set(enumerators("souple/solver/solver_settings.h", "SolverKind")), "docs/solvers.md")

    def test_instruction_sets_of_performance(self):
        said = re.search(r"`SOUPLE_SIMD=([\w|]+)`", read("docs/performance.md"))[1].split("|")
        self.assertEqual(said, enumerators("souple/simd/instruction_set.h", "InstructionSet"), "docs/performance.md")

    def test_index_lists_every_page(self):
        said = set(re.findall(r"\]\(([\w-]+\.md)\)", read("docs/index.md")))
        self.assertEqual(said | {"index.md"}, {path.name for path in ROOT.glob("docs/*.md")}, "docs/index.md")


class Where(unittest.TestCase):
    HEAD = "\n| Where do I change ... | open first |"

    def test_each_row_names_files_that_exist(self):
        for cells in rows_below("docs/architecture.md", self.HEAD):
            spans = re.findall(r"`([^`]+)`", cells[1])
            paths = [span for span in spans if re.fullmatch(r"[\w./-]+(?:/|\.\w+|/[\w-]+)", span)]
            with self.subTest(row=cells[0]):
                self.assertEqual(len(cells), 2)
                self.assertTrue(paths, f"docs/architecture.md: no file to change {cells[0]}")
                for path in paths:
                    self.assertTrue((ROOT / path).exists(), f"docs/architecture.md: {path} does not exist")

    def test_readme_links_to_the_table(self):
        self.assertIn("(docs/architecture.md#where-do-i-change)", read("README.md"))


class Links(unittest.TestCase):
    longMessage = False

    def test_links_and_pictures_are_there(self):
        for page in [*PAGES, "CHANGELOG.md", "benchmarks/README.md"]:
            text = without_code(read(page))
            links = [*re.finditer(r"\]\(([^)\s]+)\)", text), *re.finditer(r'<(?:img src|a href)="([^"]+)"', text)]
            for link in links:
                path, _, anchor = link[1].partition("#")
                if re.match(r"\w+:", path):
                    continue
                where = f"{page}:{text.count(chr(10), 0, link.start()) + 1}: {link[1]}"
                target = ((ROOT / page).parent / path).resolve() if path else ROOT / page
                with self.subTest(link=where):
                    self.assertTrue(target.exists(), f"{where}: there is no such file")
                    if anchor and target.suffix == ".md":
                        self.assertIn(anchor, anchors(target.relative_to(ROOT)), f"{where}: there is no such heading")


if __name__ == "__main__":
    unittest.main()
