// The same scene in Souple and in other engines, frame by frame alternately, so that a slow phase of the
// machine affects all of them: medians, ratios, and the strain of each engine's links at the end.
//   peers [--size N] [--frames N] [--threads N] [--json]
//   peers --strain [--size N] [--frames N] [--longest MS] [--json]    at equal strain: equal_strain.h

#include "benchmarks/peers/equal_strain.h"
#include "benchmarks/peers/peer_scene.h"
#include "souple/geometry/builders.h"
#include "souple/geometry/measures.h"
#include "souple/scene/json.h"
#include "souple/simd/instruction_set.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numeric>

namespace souple::peers {
namespace {

constexpr int substeps = 10;

struct Options {
  int size = 200, frames = 0, threads = 1, longest = 250;
  bool strain = false, json = false;
};

Settings settings(const Options& options) {
  Settings result;
  result.substeps = substeps;
  result.threads = options.threads;
  result.measure_residuals = false;
  result.solver.kind = SolverKind::gauss_seidel;
  return result;
}

/// A scene, and the engines that simulate it.
struct Comparison {
  std::string scene;
  PeerScene input;
  std::vector<std::unique_ptr<PeerEngine>> engines;
};

void add_peers(Comparison& comparison) {
  comparison.engines.push_back(make_bullet(comparison.input, substeps, 1));
  comparison.engines.push_back(make_bullet(comparison.input, 1, substeps));
}

/// The benchmark `cloth`.
Comparison cloth(const Options& options) {
  Comparison comparison;
  comparison.scene = "cloth " + std::to_string(options.size) + " x " + std::to_string(options.size);
  comparison.input = cloth_scene(options.size);
  const auto add = [&](SolverKind solver, std::string name) {
    Settings with_solver = settings(options);
    with_solver.solver.kind = solver;
    comparison.engines.push_back(make_souple_cloth(options.size, with_solver, true, std::move(name)));
  };
  add(SolverKind::gauss_seidel, "Souple");
  add(SolverKind::automatic, "Souple, default solver");
  add_peers(comparison);
  return comparison;
}

/// The bar of the benchmark `tets`: links along the edges of its tets. Souple also preserves the volumes, or
/// simulates a neo-Hookean solid; Bullet's links alone are the minimum for a soft body.
Comparison bar(const Options& options) {
  Comparison comparison;
  const int thick = std::max(2, options.size * 12 / 200), length = 5 * thick;
  const Vec3d size{0.02 * length, 0.02 * thick, 0.02 * thick};
  const TetMesh mesh = tet_bar(length, thick, thick, size);
  comparison.scene = "bar of " + std::to_string(mesh.tets.size()) + " tets";
  PeerScene& input = comparison.input;
  input.positions = mesh.positions;
  input.masses.assign(mesh.positions.size(), 0);
  const std::vector<double> volumes = tet_volumes(mesh);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    for (const std::uint32_t i : mesh.tets[t]) input.masses[i] += 1000 * volumes[t] / 4;
  input.links = unique_edges(mesh.tets);
  for (const SoftBodyModel model : {SoftBodyModel::springs, SoftBodyModel::neo_hookean}) {
    World world(settings(options));
    SoftBodyMaterial material;
    material.model = model;
    material.young_modulus = 1e8f;  // stiff enough that strains show the solver's error
    const ObjectId object = world.add_soft_body(mesh, material);
    const auto end = static_cast<float>(-size.x / 2);
    world.pin(object, in_box({end - 1e-3f, -9, -9}, {end + 1e-3f, 9, 9}));
    for (const std::uint32_t i : world.pinned(object)) input.masses[i] = 0;
    comparison.engines.push_back(make_souple(std::move(world), model == SoftBodyModel::springs
                                                                   ? "Souple, edges and volumes"
                                                                   : "Souple, neo-Hookean"));
  }
  add_peers(comparison);
  return comparison;
}

/// Prints a comparison, or adds it to the list.
void report(Comparison& comparison, const Options& options, scene_format::Json& list) {
  using scene_format::Json;
  const std::vector<double> milliseconds =
      simulate(comparison.engines, options.frames > 0 ? options.frames : 60);
  if (!options.json)
    std::printf("%s\n  %-28s %10s %14s %8s %14s\n", comparison.scene.c_str(), "", "ms/frame", "M constr./s",
                "ratio", "largest strain");
  for (std::size_t k = 0; k < comparison.engines.size(); ++k) {
    const PeerEngine& one = *comparison.engines[k];
    const double rate = one.projections() / (milliseconds[k] * 1e3);
    const double ratio = milliseconds[k] / milliseconds[0];
    const double strain = largest_strain(comparison.input, one.positions());
    if (!options.json)
      std::printf("  %-28s %10.3f %14.1f %8.2f %12.2f %%\n", one.name().c_str(), milliseconds[k], rate, ratio,
                  100 * strain);
    Json row = Json::object();
    row.set("scene", Json::of(comparison.scene));
    row.set("engine", Json::of(one.name()));
    row.set("ms_per_frame", Json::of(static_cast<float>(milliseconds[k])));
    row.set("constraints_per_second", Json::of(static_cast<float>(1e6 * rate)));
    row.set("ratio", Json::of(static_cast<float>(ratio)));
    row.set("largest_strain", Json::of(static_cast<float>(strain)));
    list.items.push_back(std::move(row));
  }
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    int* number = word == "--size"      ? &options.size
                  : word == "--frames"  ? &options.frames
                  : word == "--threads" ? &options.threads
                  : word == "--longest" ? &options.longest
                                        : nullptr;
    if (word == "--json" || word == "--strain") {
      (word == "--json" ? options.json : options.strain) = true;
    } else if (number != nullptr && i + 1 < argc && std::atoi(argv[i + 1]) > 0) {
      *number = std::atoi(argv[++i]);
    } else {
      throw Error(word +
                  ": expected --strain, --size N, --frames N, --threads N, --longest N or --json, N above 0");
    }
  }
  return options;
}

void run(const Options& options) {
  scene_format::Json result = scene_format::Json::object(), list = scene_format::Json::array();
  if (options.strain) {
    list = compare_at_equal_strain({.size = options.size,
                                    .frames = options.frames > 0 ? options.frames : 240,
                                    .max_milliseconds = static_cast<double>(options.longest),
                                    .prints = !options.json});
  } else {
    for (const auto make : {cloth, bar}) {
      Comparison comparison = make(options);
      report(comparison, options, list);
    }
    result.set("threads", scene_format::Json::whole(options.threads));
  }
  if (!options.json) return;
  result.set("size", scene_format::Json::whole(options.size));
  result.set("simd", scene_format::Json::of(std::string(simd_name())));
  result.set("rows", std::move(list));
  std::fputs(dump_json(result).c_str(), stdout);
}

}  // namespace
}  // namespace souple::peers

int main(int argc, char** argv) {
  try {
    souple::peers::run(souple::peers::parse(argc, argv));
    return 0;
  } catch (const souple::Error& error) {
    std::fprintf(stderr, "peers: %s\n", error.what());
    return 2;
  }
}
