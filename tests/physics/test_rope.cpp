#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <cmath>

namespace souple::test_physics_rope {

constexpr double L = 2, span = 1.2;
constexpr int N = 100;

// y = a cosh(x/a), of arc length s = a sinh(x/a): 2 a sinh(span / 2a) = L.
double catenary_parameter() {
  double low = 0.05, high = 10;
  for (int i = 0; i < 100; ++i) {
    const double a = (low + high) / 2;
    (2 * a * std::sinh(span / (2 * a)) > L ? low : high) = a;
  }
  return low;
}

// Position of the end of link i; the chain's ends are at (-+ span/2, 0).
Vec3d on_catenary(int i) {
  const double a = catenary_parameter();
  const double x = a * std::asinh((-L / 2 + L * i / N) / a);
  return {x, a * (std::cosh(x / a) - std::cosh(span / (2 * a))), 0};
}

struct Hanging {
  double farthest = 0;    // largest distance of a link's end from the catenary, relative to L
  double elongation = 0;  // of the whole chain, relative to L
};

// Rigid links, released in the shape of a V; drag brings them to rest.
Hanging hang(const Settings& settings, Curves* curves = nullptr, const std::string& series = {}) {
  Settings with_drag = settings;
  with_drag.drag = 2;
  World world(with_drag);
  const Vec3d points[] = {{-span / 2, 0, 0}, {0, -std::sqrt(L * L - span * span) / 2, 0}, {span / 2, 0, 0}};
  const ObjectId chain =
      world.add_rope(points, N, {.radius = 0.002f, .young_modulus = 1e15f, .density = 7800});
  world.pin(chain, vertices({0, N}));
  EXPECT_TRUE(run(world, 1800, 1.0 / 60));
  Hanging result;
  double total = 0;
  const auto x = world.positions(chain);
  for (int i = 0; i <= N; ++i) {
    const Vec3d here(x[static_cast<std::size_t>(i)]);
    if (i > 0) total += length(here - Vec3d(x[static_cast<std::size_t>(i) - 1]));
    result.farthest = std::max(result.farthest, length(here - on_catenary(i)) / L);
    if (curves != nullptr) curves->add(series, here.x, here.y);
  }
  result.elongation = total / L - 1;
  return result;
}

TEST(Chain, HangsInACatenary) {
  const std::string name = "hanging chain, 100 links";
  Curves curves(name, "x [m]", "y [m]");
  for (int i = 0; i <= N; ++i) curves.add("theory: catenary", on_catenary(i).x, on_catenary(i).y);
  const Hanging fine = hang({.substeps = 50}, &curves, "50 substeps of 1 iteration");
  validate_below(name, "50 x 1: farthest from the catenary / L", fine.farthest, 0.01);
  const Hanging iterated =
      hang({.substeps = 20, .iterations = 10, .mode = Mode::xpbd}, &curves, "20 substeps of 10 iterations");
  validate_below(name, "20 x 10: farthest from the catenary / L", iterated.farthest, 0.01);
}

// Gauss-Seidel; the default solver eliminates chains exactly. A sweep moves a chain of N links like springs of
// stiffness m / h^2 per link. It hangs too long by N^2 g h^2 / L times a factor that depends only on its shape.
TEST(Chain, StretchesByTheSquareOfTheStep) {
  const std::string name = "hanging chain, error against N^2 g h^2 / L";
  Curves curves(name, "N^2 g h^2 / L", "elongation");
  double before = 0, coarsest = 0, number = 0;
  for (const int substeps : {10, 20, 40}) {
    SolverSettings sweeps;
    sweeps.kind = SolverKind::gauss_seidel;
    const double elongation = hang({.substeps = substeps, .solver = sweeps}).elongation;
    const double h = 1.0 / 60 / substeps;
    number = N * N * 9.81 * h * h / L;
    coarsest = std::max(coarsest, number);
    const std::string at = std::to_string(substeps) + " substeps";
    state(name, at + ": elongation / (N^2 g h^2 / L)", elongation / number);
    curves.add("measured", number, elongation);
    if (before > 0)
      validate_relative(name, at + ": elongation at half as many substeps / elongation", before / elongation,
                        4, 0.15);
    before = elongation;
  }
  curves.add("theory: a line through the finest", {0, coarsest}, {0, before / number * coarsest});
}

// --- a heavy load on light particles -------------------------------------------------------------

struct Load {
  double elongation = 0;  // mean over the last second, relative to the length
  double largest = 0;     // maximum over the run
  double speed = 0;       // final speed of the load [m/s]
};

// 1 m, 20 links, particles of 1 g; 1 kg joined to the lower end, all rigid, released from rest without slack.
// Drag 2/s.
Load carry(const Settings& settings, Curves& curves, const std::string& series) {
  Settings with_drag = settings;
  with_drag.drag = 2;
  World world(with_drag);
  std::vector<Vec3d> points;
  for (int i = 0; i <= 20; ++i) points.push_back({0, -0.05 * i, 0});
  const ObjectId rope = world.add_grains(points, grain_of_mass(0.001, 0.001f));
  world.pin(rope, vertices({0}));
  const Vec3d end[] = {{0, -1.05, 0}};
  const ObjectId weight = world.add_grains(end, grain_of_mass(1));
  std::vector<std::pair<VertexRef, VertexRef>> links;
  for (std::uint32_t i = 0; i < 20; ++i) links.push_back({{rope, i}, {rope, i + 1}});
  links.push_back({{rope, 20}, {weight, 0}});
  world.connect(links, -1);
  Load result;
  for (int frame = 1; frame <= 600; ++frame) {
    if (!world.step(1.0 / 60).ok()) return {std::nan(""), std::nan(""), std::nan("")};
    const double elongation = -world.center_of_mass(weight).y / 1.05 - 1;
    result.largest = std::max(result.largest, elongation);
    if (frame > 540) result.elongation += elongation / 60;
    if (frame <= 240) curves.add(series, frame / 60.0, 100 * elongation);
  }
  result.speed = length(Vec3d(world.velocities(weight)[0]));
  return result;
}

TEST(Rope, OfOneGramCarriesAKilogram) {
  const std::string name = "rope of 1 g particles carrying 1 kg";
  Curves curves(name, "time [s]", "elongation [%]");
  struct Case {
    const char* words;
    Settings settings;
  };
  const Case cases[] = {{"small steps, 10 x 1", {.substeps = 10}},
                        {"small steps, 50 x 1", {.substeps = 50}},
                        {"xpbd, 10 x 10", {.substeps = 10, .iterations = 10, .mode = Mode::xpbd}},
                        {"xpbd, 1 x 100", {.substeps = 1, .iterations = 100, .mode = Mode::xpbd}},
                        {"pbd, 10 x 10", {.substeps = 10, .iterations = 10, .mode = Mode::pbd}},
                        {"pbd, 1 x 100", {.substeps = 1, .iterations = 100, .mode = Mode::pbd}}};
  for (const Case& c : cases) {
    const Load load = carry(c.settings, curves, c.words);
    state(name, std::string(c.words) + ": elongation at rest [%]", 100 * load.elongation);
    // Stable: after the release it swings to less than twice its sag, like a spring, and comes to rest there.
    validate_below(name, std::string(c.words) + ": largest elongation / at rest",
                   load.largest / load.elongation, 2);
    validate_below(name, std::string(c.words) + ": speed after 10 s [m/s]", load.speed, 0.05);
  }
}

}  // namespace souple::test_physics_rope
