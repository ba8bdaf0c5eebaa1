// Errors of the default solver, beside the converged state of the same discrete model.
//
//   default_quality [CASE...] [--solver NAME] [--substeps N]
//
// Prints a table per case, see `cases` below; without names all but the slow ones. A hanging model is converged in static equilibrium (Newton, double precision: equilibrium.h), a moving one
// with 100 or 1000 substeps. --solver and --substeps replace the default in the column "default".

#include "souple/error.h"
#include "souple/geometry/adjacency.h"
#include "souple/mesh_files/mesh_file.h"
#include "souple/souple.h"
#include "tests/physics/equilibrium.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

namespace souple {
namespace {

constexpr double dt = 1.0 / 60, gravity = 9.81, percent = 100;
Settings chosen;  // of the column "default"

Settings converged_settings(int substeps, SolverKind solver = SolverKind::gauss_seidel) {
  return {.substeps = substeps, .solver = {.kind = solver}};
}

void head(const char* title, const char* columns) {
  std::printf("\n%s\n\n| %s |\n|", title, columns);
  for (std::string_view rest = columns;;) {
    std::printf("---|");
    const std::size_t bar = rest.find('|');
    if (bar == std::string_view::npos) break;
    rest.remove_prefix(bar + 1);
  }
  std::printf("\n");
}

struct Sheet {
  TriangleMesh mesh;
  ClothMaterial material;
  std::vector<std::uint32_t> pinned;
};

TriangleMesh upright(TriangleMesh mesh) {
  for (Vec3d& x : mesh.positions) x = {x.x, -x.z, 0};
  return mesh;
}

std::vector<std::uint32_t> first(int n) {
  std::vector<std::uint32_t> result(static_cast<std::size_t>(n));
  std::iota(result.begin(), result.end(), 0u);
  return result;
}

ObjectId add(World& world, const Sheet& sheet, const ObjectOptions& options = {}) {
  const ObjectId cloth = world.add_cloth(sheet.mesh, sheet.material, options);
  if (!sheet.pinned.empty()) world.pin(cloth, vertices(sheet.pinned));
  return cloth;
}

template <class Positions>
double worst_edge(const TriangleMesh& mesh, const Positions& positions, std::size_t begin = 0) {
  double worst = -1;
  for (const Edge& edge : unique_edges(mesh.triangles)) {
    const Vec3d x = Vec3d(positions[begin + edge[1]]) - Vec3d(positions[begin + edge[0]]);
    const double rest = length(mesh.positions[edge[1]] - mesh.positions[edge[0]]);
    worst = std::max(worst, length(x) / rest - 1);
  }
  return worst;
}

double top_speed(const World& world, ObjectId object) {
  double top = 0;
  for (const Vec3f& v : world.velocities(object)) top = std::max(top, static_cast<double>(length(v)));
  return top;
}

void run(World& world, double seconds) {
  for (int frame = 0; frame < std::lround(seconds / dt); ++frame)
    if (!world.step(dt).ok()) throw Error("a step failed: " + world.report().message);
}

// --- cloth of cotton that hangs

template <class Positions>
double elongation(int n, const Positions& x) {
  double sum = 0;
  for (int row = 0; row + 1 < n; ++row)
    sum += length(Vec3d(x[static_cast<std::size_t>((row + 1) * n + n / 2)]) -
                  Vec3d(x[static_cast<std::size_t>(row * n + n / 2)]));
  return sum - 1;
}

void hang(int n, StretchModel stretch, bool by_corners, double seconds, bool refer) {
  Sheet sheet{upright(grid(n, n, 1.0)), material::cotton, first(n)};
  sheet.material.stretch = stretch;
  if (by_corners) sheet.pinned = {0, static_cast<std::uint32_t>(n - 1)};
  World world(chosen);
  const ObjectId cloth = add(world, sheet);
  run(world, seconds);
  const auto x = world.positions(cloth);
  std::printf("| %d, %s | %.3f | %.2f | %.2f |", n, stretch == StretchModel::springs ? "springs" : "membrane",
              percent * elongation(n, x), percent * worst_edge(sheet.mesh, x),
              percent * top_speed(world, cloth));
  std::fflush(stdout);
  if (!refer) {
    std::printf("\n");
    return;
  }
  Equilibrium still(2);
  still.add_cloth(sheet.mesh, sheet.material);
  still.pin(sheet.pinned);
  const double unbalanced = still.solve();
  std::printf(" %.3f | %.2f |%s\n", percent * elongation(n, still.positions()),
              percent * worst_edge(sheet.mesh, still.positions()), unbalanced > 1e-6 ? " not converged" : "");
}

void hang_by(bool by_corners, std::initializer_list<int> sizes, double seconds) {
  head(by_corners ? "1 m of cotton by two corners, after 10 s" : "1 m of cotton by a row, after 5 s",
       "N | elongation % | worst edge % | fastest cm/s | converged | worst edge %");
  for (const StretchModel stretch : {StretchModel::springs, StretchModel::membrane})
    for (const int n : sizes) hang(n, stretch, by_corners, seconds, n <= 200);
}

// --- irregular meshes

double random_number(std::uint32_t& state) {  // in [-1, 1)
  state = state * 1664525u + 1013904223u;
  return static_cast<double>(state >> 8) / (1u << 23) - 1;
}

/// A grid whose inner vertices are moved by up to 0.35 cells.
Sheet irregular(int n) {
  Sheet sheet{upright(grid(n, n, 1.0)), material::cotton, first(n)};
  std::uint32_t state = 1;
  for (int row = 1; row + 1 < n; ++row)
    for (int column = 1; column + 1 < n; ++column) {
      Vec3d& x = sheet.mesh.positions[static_cast<std::size_t>(row * n + column)];
      x.x += 0.35 / (n - 1) * random_number(state), x.y += 0.35 / (n - 1) * random_number(state);
    }
  return sheet;
}

/// Rows and columns whose widths grow by a factor of 100 from one corner to the opposite one.
Sheet graded(int n) {
  Sheet sheet{upright(grid(n, n, 1.0)), material::cotton, first(n)};
  const double ratio = std::pow(100.0, 1.0 / (n - 2)), all = (std::pow(ratio, n - 1) - 1);
  const auto at = [&](int i) { return (std::pow(ratio, i) - 1) / all; };
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column)
      sheet.mesh.positions[static_cast<std::size_t>(row * n + column)] = {at(column) - 0.5, 0.5 - at(row), 0};
  return sheet;
}

/// The shirt of the scenes, by its shoulders.
Sheet shirt(const std::string& scenes) {
  Sheet sheet{read_triangle_mesh(scenes + "/meshes/shirt.obj"), material::cotton, {}};
  double top = -1;
  for (const Vec3d& x : sheet.mesh.positions) top = std::max(top, x.y);
  for (std::uint32_t i = 0; i < sheet.mesh.positions.size(); ++i)
    if (sheet.mesh.positions[i].y > top - 0.004) sheet.pinned.push_back(i);
  return sheet;
}

void hang_mesh(const char* name, const Sheet& sheet, int dimensions) {
  World world(chosen);
  const ObjectId cloth = add(world, sheet);
  run(world, 6);
  const auto x = world.positions(cloth);
  std::printf("| %s, %zu vertices, %zu pinned | %.2f | %.2f |", name, sheet.mesh.positions.size(),
              sheet.pinned.size(), percent * worst_edge(sheet.mesh, x), percent * top_speed(world, cloth));
  std::fflush(stdout);
  Equilibrium still(dimensions);
  still.add_cloth(sheet.mesh, sheet.material);
  still.pin(sheet.pinned);
  if (dimensions == 3) still.set_positions(x);
  const double unbalanced = still.solve();
  std::printf(" %.2f |%s\n", percent * worst_edge(sheet.mesh, still.positions()),
              unbalanced > 1e-6 ? " not converged" : "");
}

void meshes() {
  head("Cotton that hangs, after 6 s", "mesh | worst edge % | fastest cm/s | converged %");
  for (const StretchModel stretch : {StretchModel::springs, StretchModel::membrane}) {
    const char* const of = stretch == StretchModel::springs ? "springs" : "membrane";
    const auto with = [&](Sheet sheet) {
      sheet.material.stretch = stretch;
      return sheet;
    };
    const auto named = [&](const char* name) { return std::string(name) + ", " + of; };
    const auto corners = [](Sheet sheet, int n) {
      sheet.pinned = {0, static_cast<std::uint32_t>(n - 1)};
      return sheet;
    };
    hang_mesh(named("irregular, by a row").c_str(), with(irregular(60)), 2);
    hang_mesh(named("irregular, by two corners").c_str(), with(corners(irregular(60), 60)), 2);
    hang_mesh(named("graded, by a row").c_str(), with(graded(60)), 2);
    hang_mesh(named("graded, by two corners").c_str(), with(corners(graded(60), 60)), 2);
    hang_mesh(named("shirt").c_str(), with(shirt("scenes")), 3);
  }
}

// --- two cloths tied edge to edge

enum class Seam { none, connected, attached };

/// Cotton 1 m wide and 1 m long by a row, in one piece or in two halves of rows / 2 cells. Or a cloth whose row is held
/// by rigid attachments instead of pins.
void hang_seam(int n, Seam seam) {
  World world(chosen);
  const int half = n / 2 + 1;
  const auto upper = [&] {
    Sheet sheet{upright(grid(n, seam == Seam::connected ? half : n, 1.0)), material::cotton, first(n)};
    const double top = sheet.mesh.positions[0].y;
    for (Vec3d& x : sheet.mesh.positions) x.y -= top;
    return sheet;
  }();
  Sheet a = upper, b = upper;
  if (seam == Seam::attached) a.pinned.clear();
  const ObjectId cloth = add(world, a);
  if (seam == Seam::attached) world.attach(cloth, vertices(first(n)));
  double worst = 0, lowest = 0, fastest = 0;
  ObjectId lower{};
  if (seam == Seam::connected) {
    const double length = -a.mesh.positions.back().y;
    for (Vec3d& x : b.mesh.positions) x.y -= length;
    b.pinned.clear();
    lower = add(world, b);
    std::vector<std::pair<VertexRef, VertexRef>> pairs;
    pairs.reserve(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i)
      pairs.push_back(
          {{cloth, static_cast<std::uint32_t>((half - 1) * n + i)}, {lower, static_cast<std::uint32_t>(i)}});
    world.connect(pairs);
  }
  run(world, 5);
  const auto see = [&](ObjectId id, const Sheet& sheet) {
    worst = std::max(worst, worst_edge(sheet.mesh, world.positions(id)));
    lowest = std::min(
        lowest, static_cast<double>(
                    world.positions(id)[sheet.mesh.positions.size() - static_cast<std::size_t>(n / 2)].y));
    fastest = std::max(fastest, top_speed(world, id));
  };
  see(cloth, a);
  double rest = -a.mesh.positions.back().y, gap = 0;
  if (seam == Seam::connected) {
    see(lower, b), rest *= 2;
    for (int i = 0; i < n; ++i)
      gap = std::max(gap, static_cast<double>(
                              length(world.positions(cloth)[static_cast<std::size_t>((half - 1) * n + i)] -
                                     world.positions(lower)[static_cast<std::size_t>(i)])));
  }
  const char* const names[] = {"one piece", "two halves, connected", "one piece, row attached"};
  std::printf("| %d, %s | %.3f | %.2f | %.2f | %.2f |\n", n, names[static_cast<int>(seam)],
              percent * (-lowest / rest - 1), percent * worst, percent * fastest, 1000 * gap);
}

void seams() {
  head("1 m of cotton by a row, in halves, after 5 s",
       "N | elongation % | worst edge % | fastest cm/s | gap of the seam mm");
  for (const int n : {20, 50, 100})
    for (const Seam seam : {Seam::none, Seam::connected, Seam::attached}) hang_seam(n, seam);
}

// --- bending

/// A strip of `length` m and three rows, of D = q L^3 / 12, clamped level at an end.
void strip(int n, BendingModel bending) {
  const double L = 0.25, density = 0.1, q = density * gravity, D = q * L * L * L / 12, cell = L / (n - 1.5);
  ClothMaterial material{.areal_density = static_cast<float>(density),
                         .membrane_stiffness = 4000,
                         .bending_stiffness = static_cast<float>(D),
                         .bending = bending};
  Sheet sheet{grid(n, 3, cell * (n - 1)), material, {}};
  for (Vec3d& x : sheet.mesh.positions) x.x += cell * (0.5 * (n - 1) - 0.5);
  for (std::uint32_t i = 0; i < sheet.mesh.positions.size(); ++i)
    if (sheet.mesh.positions[i].x < 0.6 * cell) sheet.pinned.push_back(i);
  Settings settings = chosen;
  settings.drag = 2;
  World world(settings);
  const ObjectId cloth = add(world, sheet);
  run(world, 6);
  const auto tip = static_cast<std::size_t>(n + n - 1);
  std::printf("| cloth, %s, %d | %.4f | %.2f |",
              bending == BendingModel::isometric ? "isometric" : "dihedral", n,
              -static_cast<double>(world.positions(cloth)[tip].y), percent * top_speed(world, cloth));
  std::fflush(stdout);
  sheet.material.bending = BendingModel::isometric;
  Equilibrium still;
  still.add_cloth(sheet.mesh, sheet.material);
  still.pin(sheet.pinned);
  const double unbalanced = still.solve();
  const double converged = -still.positions()[tip].y;
  std::printf(" %.4f | %+.1f |%s\n", converged,
              percent * (-static_cast<double>(world.positions(cloth)[tip].y) / converged - 1),
              unbalanced > 1e-6 ? " not converged" : "");
}

/// A rope of radius 5 mm and 0.5 m, E I = q L^3 / 12, clamped level at an end.
void cantilever(int n) {
  const double L = 0.5;
  RopeMaterial material = material::nylon;
  const auto r = static_cast<double>(material.radius);
  const double q = static_cast<double>(material.density) * 3.14159265 * r * r * gravity, cell = L / (n - 2);
  material.bending_stiffness = static_cast<float>(q * L * L * L / 12);
  std::vector<Vec3d> points;
  points.reserve(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) points.push_back({cell * (i - 1), 0, 0});
  Settings settings = chosen;
  settings.drag = 2;
  World world(settings);
  const ObjectId rope = world.add_rope(points, static_cast<std::uint32_t>(n - 1), material);
  world.pin(rope, vertices({0, 1}));
  run(world, 6);
  const double sag = -static_cast<double>(world.positions(rope).back().y);
  Equilibrium still;
  still.add_rope(points, material);
  const std::uint32_t pinned[] = {0, 1};
  still.pin(pinned);
  const double unbalanced = still.solve(), converged = -still.positions().back().y;
  std::printf("| rope, %d | %.4f | %.2f | %.4f | %+.1f |%s\n", n, sag, percent * top_speed(world, rope),
              converged, percent * (sag / converged - 1), unbalanced > 1e-6 ? " not converged" : "");
}

void strips() {
  head("Clamped level at an end, after 6 s", "vertices | tip's fall m | fastest cm/s | converged m | %");
  for (const BendingModel bending : {BendingModel::isometric, BendingModel::dihedral})
    for (const int n : {17, 33, 65, 129}) strip(n, bending);
  for (const int n : {17, 33, 65, 129}) cantilever(n);
}

// --- motion

struct Motion {
  double largest_strain = 0, amplitude = 0, fastest = 0;
};

enum class Scene { swing, thrown, wind };

Motion move(Scene scene, int n, const Settings& of, double seconds) {
  Settings settings = of;
  if (scene == Scene::wind) settings.wind.velocity = {0, 0, 30};
  World world(settings);
  Sheet sheet{upright(grid(n, n, 1.0)), material::cotton, first(n)};
  sheet.material.damping = 0;
  ObjectOptions options;
  if (scene == Scene::thrown) {
    sheet.pinned.clear();
    options.velocity = {3, 4, 0}, options.angular_velocity = {5, 3, 8};
  }
  const double top = sheet.mesh.positions[0].y, angle = 40 * 3.14159265 / 180;
  if (scene == Scene::swing)
    for (Vec3d& x : sheet.mesh.positions)
      x = {x.x, (x.y - top) * std::cos(angle), (top - x.y) * std::sin(angle)};
  const ObjectId cloth = add(world, sheet, options);
  const auto hem = static_cast<std::size_t>(n * (n - 1) + n / 2);
  Motion result;
  double last = angle, before = angle;  // slope of the hem
  for (int frame = 0; frame < std::lround(seconds / dt); ++frame) {
    if (!world.step(dt).ok()) throw Error("a step failed: " + world.report().message);
    result.largest_strain =
        std::max(result.largest_strain, static_cast<double>(world.report().largest_strain));
    result.fastest = std::max(result.fastest, top_speed(world, cloth));
    const Vec3f x = world.positions(cloth)[hem] - world.positions(cloth)[static_cast<std::size_t>(n / 2)];
    const double now = std::atan2(static_cast<double>(x.z), -static_cast<double>(x.y));
    if (std::fabs(last) > std::fabs(before) && std::fabs(last) > std::fabs(now))
      result.amplitude = std::fabs(last) / angle;
    before = last, last = now;
  }
  return result;
}

void motion(int n, double seconds, double swing_seconds) {
  const char* const names[] = {"swings from 40 degrees", "thrown", "in 30 m/s of wind"};
  for (const Scene scene : {Scene::swing, Scene::thrown, Scene::wind}) {
    const double time = scene == Scene::swing ? swing_seconds : seconds;
    const Motion now = move(scene, n, chosen, time);
    std::printf("| %d, %s | %.2f | %.3f |", n, names[static_cast<int>(scene)], percent * now.largest_strain,
                now.amplitude);
    std::fflush(stdout);
    const Motion fine = move(scene, n, converged_settings(100, SolverKind::automatic), time);
    std::printf(" %.2f | %.3f |\n", percent * fine.largest_strain, fine.amplitude);
    std::fflush(stdout);
  }
}

void motions() {
  head("1 m of cotton in motion: largest strain at any frame, last amplitude of the swing over the first",
       "N | strain % | amplitude | 100 substeps, strain % | amplitude");
  motion(40, 2, 7.4);
}
void large_motions() {
  head("1 m of cotton in motion: largest strain at any frame, last amplitude of the swing over the first",
       "N | strain % | amplitude | 100 substeps, strain % | amplitude");
  motion(200, 1.5, 4);
}

/// Largest speed [m/s] while the pinned row of a hanging cloth moves by 0.5 m in 50 ms, and half a second after it.
double jerk(int n, const Settings& settings, const Vec3d& direction) {
  Sheet sheet{upright(grid(n, n, 1.0)), material::cotton, {}};
  World world(settings);
  const ObjectId cloth = add(world, sheet);
  const double start = 1;
  world.pin(cloth, vertices(first(n)), [&](std::uint32_t vertex, double time) {
    return sheet.mesh.positions[vertex] + direction * (0.5 * std::clamp((time - start) / 0.05, 0.0, 1.0));
  });
  run(world, start);
  double fastest = 0;
  for (int frame = 0; frame < 33; ++frame)
    world.step(dt), fastest = std::max(fastest, top_speed(world, cloth));
  return fastest;
}

void jerks() {
  head("Pins jerked by 0.5 m in 50 ms: fastest vertex m/s",
       "N, direction | default | 100 substeps | 1000, plain");
  for (const int n : {30, 50})
    for (const Vec3d direction : {Vec3d{0, 0, 1}, Vec3d{0, 1, 0}, Vec3d{1, 0, 0}}) {
      std::printf("| %d, %c | %.1f |", n,
                  direction.x > 0   ? 'x'
                  : direction.y > 0 ? 'y'
                                    : 'z',
                  jerk(n, chosen, direction));
      std::printf(" %.1f | %.1f |\n", jerk(n, converged_settings(100, SolverKind::automatic), direction),
                  jerk(n, converged_settings(1000), direction));
      std::fflush(stdout);
    }
}

// --- pleats

/// The scene `curtain`, with self-collision and without ball: width of the hem after 3 s. [m]
double hem(const Settings& settings) {
  Sheet sheet{upright(grid(46, 40, 2.25)), material::cotton, {}};
  for (Vec3d& x : sheet.mesh.positions) x.y += 1.2;
  sheet.material.bending_stiffness = 1e-4f, sheet.material.damping = 1, sheet.material.thickness = 0.03f;
  World world(settings);
  world.add_collider(Plane{});
  ObjectOptions options;
  options.self_collision = SelfCollision::surfaces;
  const ObjectId cloth = add(world, sheet, options);
  for (std::uint32_t ring = 0; ring < 10; ++ring)
    world.pin(cloth, vertices({5 * ring}),
              [=, at = sheet.mesh.positions[std::size_t{5} * ring]](std::uint32_t, double time) {
                const double part = std::clamp((time - 0.2) / 1.5, 0.0, 1.0);
                return at + Vec3d{-0.1125 * ring, 0, ring % 2 == 0 ? -0.08 : 0.08} * part;
              });
  world.add_tethers(cloth, 0.02f);
  run(world, 3);
  double low = 1e9, high = -1e9;
  for (std::size_t i = std::size_t{46} * 39; i < std::size_t{46} * 40; ++i) {
    const auto x = static_cast<double>(world.positions(cloth)[i].x);
    low = std::min(low, x), high = std::max(high, x);
  }
  return high - low;
}

void pleats() {
  head("Curtain with self-collision: width of the hem after 3 s, m",
       "default | automatic, 100 substeps | gauss_seidel, 10 | 100 substeps");
  std::printf("| %.3f |", hem(chosen));
  std::fflush(stdout);
  std::printf(" %.3f |", hem(converged_settings(100, SolverKind::automatic)));
  std::fflush(stdout);
  std::printf(" %.3f | %.3f |\n", hem(converged_settings(10)), hem(converged_settings(100)));
}

struct Case {
  const char* name;
  std::function<void()> print;
  bool slow = false;
};

const std::vector<Case> cases{{"row",
                               [] {
                                 hang_by(false, {20, 50, 100}, 5);
                               }},
                              {"corners",
                               [] {
                                 hang_by(true, {20, 50, 100}, 10);
                               }},
                              {"large_row",
                               [] {
                                 hang_by(false, {200, 400}, 5);
                               },
                               true},
                              {"large_corners", [] { hang_by(true, {200}, 10); }, true},
                              {"meshes", meshes},
                              {"seams", seams},
                              {"strips", strips},
                              {"motion", motions},
                              {"large_motion", large_motions, true},
                              {"jerk", jerks},
                              {"pleats", pleats}};

void print(int count, char** words) {
  std::vector<std::string_view> names;
  for (int i = 1; i < count; ++i) {
    const std::string_view word = words[i];
    if (word == "--substeps" && i + 1 < count) {
      chosen.substeps = std::atoi(words[++i]);
    } else if (word == "--solver" && i + 1 < count) {
      const std::string_view solver = words[++i];
      if (solver == "gauss_seidel") chosen.solver.kind = SolverKind::gauss_seidel;
      if (solver == "hierarchical") chosen.solver.kind = SolverKind::hierarchical;
    } else {
      names.push_back(word);
    }
  }
  for (const Case& one : cases) {
    const bool named =
        std::any_of(names.begin(), names.end(), [&](std::string_view n) { return n == one.name; });
    if (names.empty() ? !one.slow : named) one.print(), std::fflush(stdout);
  }
}

}  // namespace

int measure(int count, char** words) {
  try {
    print(count, words);
    return 0;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}

}  // namespace souple

int main(int count, char** words) {
  return souple::measure(count, words);
}
