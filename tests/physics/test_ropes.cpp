#include "tests/physics/motion.h"
#include "tests/physics/validation.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace souple::test_physics_ropes {

constexpr double chain = 2, span = 1.2;
constexpr int N = 100;

// y = a cosh(x/a), of arc length s = a sinh(x/a): 2 a sinh(span / 2a) = chain.
double catenary_parameter() {
  double low = 0.05, high = 10;
  for (int i = 0; i < 100; ++i) {
    const double a = (low + high) / 2;
    (2 * a * std::sinh(span / (2 * a)) > chain ? low : high) = a;
  }
  return low;
}

// Position of the end of link i; the chain's ends are at (-+ span/2, 0).
Vec3d on_catenary(int i) {
  const double a = catenary_parameter();
  const double x = a * std::asinh((-chain / 2 + chain * i / N) / a);
  return {x, a * (std::cosh(x / a) - std::cosh(span / (2 * a))), 0};
}

struct Hanging {
  double farthest = 0;    // largest distance of a link's end from the catenary, relative to chain
  double elongation = 0;  // of the whole chain, relative to chain
};

// Rigid links, released in the shape of a V; drag brings them to rest.
Hanging hang(const Settings& settings, Curves* curves = nullptr, const std::string& series = {}) {
  Settings with_drag = settings;
  with_drag.drag = 2;
  World world(with_drag);
  const Vec3d points[] = {
      {-span / 2, 0, 0}, {0, -std::sqrt(chain * chain - span * span) / 2, 0}, {span / 2, 0, 0}};
  const ObjectId rope =
      world.add_rope(points, N, {.radius = 0.002f, .young_modulus = 1e15f, .density = 7800});
  world.pin(rope, vertices({0, N}));
  EXPECT_TRUE(run(world, 1800, 1.0 / 60));
  Hanging result;
  double total = 0;
  const auto x = world.positions(rope);
  for (int i = 0; i <= N; ++i) {
    const Vec3d here(x[static_cast<std::size_t>(i)]);
    if (i > 0) total += length(here - Vec3d(x[static_cast<std::size_t>(i) - 1]));
    result.farthest = std::max(result.farthest, length(here - on_catenary(i)) / chain);
    if (curves != nullptr) curves->add(series, here.x, here.y);
  }
  result.elongation = total / chain - 1;
  return result;
}

TEST(Chain, HangsInACatenary) {
  const std::string name = "hanging chain, 100 links";
  Curves curves(name, "x [m]", "y [m]");
  for (int i = 0; i <= N; ++i) curves.add("theory: catenary", on_catenary(i).x, on_catenary(i).y);
  const Hanging fine = hang({.substeps = 50}, &curves, "50 substeps of 1 iteration");
  validate_below(name, "50 x 1: farthest from the catenary / length", fine.farthest, 0.01);
  const Hanging iterated =
      hang({.substeps = 20, .iterations = 10, .mode = Mode::xpbd}, &curves, "20 substeps of 10 iterations");
  validate_below(name, "20 x 10: farthest from the catenary / length", iterated.farthest, 0.01);
}

// Gauss-Seidel; the default solver eliminates chains exactly. A sweep moves a chain of N links like springs of
// stiffness m / h^2 per link. It hangs too long by N^2 g h^2 / length times a factor that depends only on its shape.
TEST(Chain, StretchesByTheSquareOfTheStep) {
  const std::string name = "hanging chain, error against N^2 g h^2 / length";
  Curves curves(name, "N^2 g h^2 / length", "elongation");
  double before = 0, coarsest = 0, number = 0;
  for (const int substeps : {10, 20, 40}) {
    SolverSettings sweeps;
    sweeps.kind = SolverKind::gauss_seidel;
    const double elongation = hang({.substeps = substeps, .solver = sweeps}).elongation;
    const double h = 1.0 / 60 / substeps;
    number = N * N * 9.81 * h * h / chain;
    coarsest = std::max(coarsest, number);
    const std::string at = std::to_string(substeps) + " substeps";
    state(name, at + ": elongation / (N^2 g h^2 / length)", elongation / number);
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
  const ObjectId weight = world.add_grains(std::vector<Vec3d>{{0, -1.05, 0}}, grain_of_mass(1));
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

// Ropes of 1 m that carry up to a thousand times their mass, with default settings: 10 substeps of one iteration.

constexpr double L = 1, E = 1e9, radius = 0.005;

struct Loaded {
  World world;
  ObjectId rope, load;
  std::uint32_t segments;
  double mass;    ///< of the load [kg]
  double theory;  ///< elongation at rest

  double worst_strain() {
    double worst = 0;
    const auto x = world.positions(rope);
    for (std::size_t i = 1; i < x.size(); ++i)
      worst = std::max(worst, static_cast<double>(length(x[i] - x[i - 1])) * segments / L - 1);
    return worst;
  }
  double fastest() {
    float fastest = 0;
    for (const Vec3f& v : world.velocities(rope)) fastest = std::max(fastest, length(v));
    return static_cast<double>(fastest);
  }
  double tip(int axis) { return static_cast<double>(world.positions(rope)[segments][axis]); }
};

/// Hangs at `angle` from the vertical; the load, `ratio` times the rope's mass, is joined to its end. A load without
/// contacts: it is wider than a segment.
Loaded load(Settings settings, std::uint32_t segments, double ratio, double angle = 0, Target top = {}) {
  World world(settings);
  const Vec3d end{L * std::sin(angle), -L * std::cos(angle), 0}, path[] = {{0, 0, 0}, end};
  const ObjectId rope =
      world.add_rope(path, segments, {.radius = static_cast<float>(radius), .young_modulus = E});
  world.pin(rope, vertices({0}), std::move(top));
  const double own = world.total_mass(rope), mass = ratio * own;
  const ObjectId weight = world.add_grains({&end, 1}, grain_of_mass(mass));
  world.set_collision_groups(weight, 0, 0);
  const std::pair<VertexRef, VertexRef> tie[] = {{{rope, segments}, {weight, 0}}};
  world.connect(tie, 0);
  const double theory = (mass + own / 2) * 9.81 / (E * pi * radius * radius);
  return {std::move(world), rope, weight, segments, mass, theory};
}

TEST(RopeLoad, StretchesTheRopeByItsWeightAtAnyMassRatio) {
  const std::string name = "rope of 1 m carrying many times its mass, 10 x 1";
  for (const std::uint32_t segments : {50u, 1000u}) {
    for (const double ratio : {1.0, 100.0, 1000.0}) {
      Loaded rope = load({.drag = 2}, segments, ratio);
      ASSERT_TRUE(run(rope.world, 240, 1.0 / 60));
      validate_relative(name,
                        fmt::format("{} segments, load {:g} times its mass: elongation", segments, ratio),
                        -rope.tip(1) / L - 1, rope.theory, 0.02);
      EXPECT_LT(rope.fastest(), 1e-3);
    }
  }
}

/// Largest distance of the tip from the vertical in the third of the swings that begins after five seconds [m].
struct Swing {
  double amplitude = 0, worst_strain = 0;
};
Swing swing(const Settings& settings, double ratio) {
  Loaded rope = load(settings, 50, ratio, 0.7);
  Swing result;
  for (int frame = 0; frame < 438; ++frame) {
    EXPECT_TRUE(rope.world.step(1.0 / 60).ok());
    if (frame > 288) result.amplitude = std::max(result.amplitude, std::abs(rope.tip(0)));
    result.worst_strain = std::max(result.worst_strain, rope.worst_strain());
  }
  return result;
}

// Released at 40 degrees, it never stretches more than a pendulum's tension 3 m g - 2 m g cos 40 and a jump of the load.
TEST(RopeLoad, SwingsAsLongAsWithTenTimesTheSubsteps) {
  const std::string name = "rope of 50 segments, load swinging for 7.3 s";
  for (const double ratio : {1.0, 1000.0}) {
    const Swing coarse = swing({}, ratio), fine = swing({.substeps = 100}, ratio);
    const std::string of = fmt::format("load {:g} times its mass: ", ratio);
    validate_relative(name, of + "amplitude with 10 substeps, relative to 100",
                      coarse.amplitude / fine.amplitude, 1, 0.01);
    EXPECT_LT(coarse.amplitude, std::sin(0.7) * (1.006 + 0.03 * ratio / 1000));  // converged: 1.0055, 1.007
    EXPECT_LT(coarse.worst_strain, 2.5 * load({}, 50, ratio).theory);
  }
  SolverSettings sweeps;
  sweeps.kind = SolverKind::gauss_seidel;
  validate_relative(name, "load 1 times its mass: amplitude, relative to gauss_seidel with 100 substeps",
                    swing({}, 1).amplitude / swing({.substeps = 100, .solver = sweeps}, 1).amplitude, 1,
                    0.03);
}

// The upper end is moved by half a meter in 50 ms; the load jumps, the rope slackens and is caught.
TEST(RopeLoad, IsJerked) {
  const Target top = [](std::uint32_t, double t) {
    return Vec3d{0.5 * std::clamp((t - 0.5) / 0.05, 0.0, 1.0), 0, 0};
  };
  for (const double ratio : {1.0, 100.0, 1000.0}) {
    Loaded rope = load({}, 50, ratio, 0, top);
    double fastest = 0, worst = 0;
    for (int frame = 0; frame < 300; ++frame) {
      ASSERT_TRUE(rope.world.step(1.0 / 60).ok());
      fastest = std::max(fastest, rope.fastest()), worst = std::max(worst, rope.worst_strain());
    }
    EXPECT_LT(fastest, 15) << ratio;
    EXPECT_LT(worst, 0.3) << ratio;
    EXPECT_LT(rope.worst_strain(), 0.001 + 3 * rope.theory) << ratio;
  }
}

// Crumpled into a random walk and thrown, one end held.
TEST(RopeLoad, IsThrown) {
  Settings settings;
  World world(settings);
  const Vec3d path[] = {{0, 0, 0}, {L, 0, 0}};
  const ObjectId rope = world.add_rope(path, 50, {.radius = 0.005f, .young_modulus = 1e9f});
  world.pin(rope, vertices({0}));
  std::vector<Vec3f> x(51), v(51);
  for (std::size_t i = 0; i <= 50; ++i) {
    const auto s = static_cast<double>(i * i);
    const Vec3f step = normalized(Vec3f(Vec3d{std::sin(s), std::cos(2 * s), std::sin(3 * s + 1)}));
    if (i > 0) x[i] = x[i - 1] + step * 0.02f;
    v[i] = {5, 3, static_cast<float>(i % 7) - 3};
  }
  world.set_positions(rope, x);
  world.set_velocities(rope, v);
  double worst = 0;
  for (int frame = 0; frame < 300; ++frame) {
    ASSERT_TRUE(world.step(1.0 / 60).ok());
    const auto now = world.positions(rope);
    for (std::size_t i = 1; i < now.size(); ++i)
      worst = std::max(worst, static_cast<double>(length(now[i] - now[i - 1])) * 50 - 1);
  }
  EXPECT_LT(worst, 0.01);  // Gauss-Seidel with 100 substeps: 1.4 %
}

// A rope over a post, with half of its mass at either end: friction holds it.
TEST(RopeLoad, HangsOverAPost) {
  World world({.gravity = {0, 0, -9.81f}});
  const double R = 0.105, leg = (L - pi * R) / 2;
  std::vector<Vec3d> path{{-R, 0, -leg}};
  for (int i = 0; i <= 24; ++i) path.push_back({-R * std::cos(pi * i / 24), 0, R * std::sin(pi * i / 24)});
  path.push_back({R, 0, -leg});
  const ObjectId rope = world.add_rope(path, 50, {.radius = 0.005f, .young_modulus = 1e9f});
  world.add_collider(Capsule{.radius = 0.1f, .half_height = 1}, {.friction = 0.3f});
  std::vector<std::pair<VertexRef, VertexRef>> ties;
  for (const std::uint32_t end : {0u, 50u}) {
    const Vec3d at[] = {end == 0 ? path.front() : path.back()};
    const ObjectId weight = world.add_grains(at, grain_of_mass(world.total_mass(rope) / 2));
    world.set_collision_groups(weight, 0, 0);
    ties.push_back({{rope, end}, {weight, 0}});
  }
  world.connect(ties, 0);
  ASSERT_TRUE(run(world, 300, 1.0 / 60));
  const auto x = world.positions(rope);
  double worst = 0;
  for (std::size_t i = 1; i < x.size(); ++i)
    worst = std::max(worst, static_cast<double>(length(x[i] - x[i - 1])) * 50 / L - 1);
  EXPECT_LT(worst, 0.005);  // Gauss-Seidel: 12 %
  EXPECT_NEAR(static_cast<double>(x[0].z), -leg, 0.003);
  EXPECT_NEAR(static_cast<double>(x[50].z), -leg, 0.003);
  for (const Vec3f& v : world.velocities(rope)) EXPECT_LT(length(v), 0.005f);
}

// A soft body of a hundred times the rope's mass hangs by one vertex: the tie holds as well as the rope.
TEST(RopeLoad, OfASoftBodyHangsByItsTie) {
  World world;
  const Vec3d path[] = {{0, 0, 0}, {0, -L, 0}};
  const ObjectId rope = world.add_rope(path, 50, {.radius = 0.005f, .young_modulus = 1e9f});
  world.pin(rope, vertices({0}));
  ObjectOptions below{.transform = {.translation = {0, -L - 0.1, 0}}};
  const double mass = 100 * world.total_mass(rope);
  const ObjectId box =
      world.add_soft_body(tet_bar(4, 4, 4, {0.2, 0.2, 0.2}),
                          {.young_modulus = 1e6f, .density = static_cast<float>(mass / 0.008)}, below);
  world.set_collision_groups(rope, 0, 0);
  const std::uint32_t top = world.select(box, nearest({0, -1, 0}))[0];
  const std::pair<VertexRef, VertexRef> tie[] = {{{box, top}, {rope, 50}}};
  world.connect(tie, 0);
  ASSERT_TRUE(run(world, 180, 1.0 / 60));
  const Vec3f end = world.positions(rope)[50];
  EXPECT_LT(length(world.positions(box)[top] - end), 1e-3f);  // Gauss-Seidel: 1 cm
  const double theory = (mass + world.total_mass(rope) / 2) * 9.81 / (E * pi * radius * radius);
  EXPECT_NEAR(-static_cast<double>(end.y) / L - 1, theory, 0.1 * theory);
}

}  // namespace souple::test_physics_ropes
