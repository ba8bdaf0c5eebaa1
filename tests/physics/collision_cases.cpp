#include "tests/physics/collision_cases.h"

#include "tests/collision/random.h"

#include <algorithm>
#include <cmath>

namespace souple::test {
namespace {

Vec3d curve_point(const std::vector<Vec3d>& points, std::size_t k, double s) {
  const auto at = [&](std::size_t i) { return points[std::min(i, points.size() - 1)]; };
  const Vec3d a = at(k == 0 ? 0 : k - 1), b = at(k), c = at(k + 1), d = at(k + 2);
  // Catmull-Rom.
  return (b * 2.0 + (c - a) * s + (a * 2.0 - b * 5.0 + c * 4.0 - d) * (s * s) +
          (b * 3.0 - a - c * 3.0 + d) * (s * s * s)) *
         0.5;
}

// The smooth curve through `points`, sampled at steps of about `step`.
std::vector<Vec3d> smooth_curve(const std::vector<Vec3d>& points, double step) {
  constexpr int fine = 200;
  std::vector<Vec3d> dense;
  for (std::size_t k = 0; k + 1 < points.size(); ++k)
    for (int i = 0; i < fine; ++i) dense.push_back(curve_point(points, k, double(i) / fine));
  dense.push_back(points.back());
  double total = 0;
  for (std::size_t i = 1; i < dense.size(); ++i) total += length(dense[i] - dense[i - 1]);
  const double each = total / std::round(total / step);
  std::vector<Vec3d> even{dense.front()};
  double since = 0;
  for (std::size_t i = 1; i < dense.size(); ++i) {
    const double span = length(dense[i] - dense[i - 1]);
    for (since += span; since >= each; since -= each)
      even.push_back(dense[i] + (dense[i - 1] - dense[i]) * ((since - each) / span));
  }
  return even;
}

// A strip on edge along a curve: `across` vertices upward at each of its points.
TriangleMesh strip_along(const std::vector<Vec3d>& curve, int across, double width) {
  TriangleMesh mesh = grid(across, static_cast<int>(curve.size()), width);
  for (std::size_t row = 0; row < curve.size(); ++row)
    for (std::size_t k = 0; k < std::size_t(across); ++k)
      mesh.positions[row * std::size_t(across) + k] =
          curve[row] + Vec3d{0, width * (double(k) / (across - 1) - 0.5), 0};
  return mesh;
}

TriangleMesh tube(int around, int along, double radius, double length) {
  TriangleMesh mesh;
  for (int k = 0; k <= along; ++k)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * pi * i / around;
      mesh.positions.push_back({radius * std::cos(angle), length * k / along, radius * std::sin(angle)});
    }
  const auto at = [&](int k, int i) { return static_cast<std::uint32_t>(k * around + i % around); };
  for (int k = 0; k < along; ++k)
    for (int i = 0; i < around; ++i) {
      const std::uint32_t a = at(k, i), b = at(k, i + 1), c = at(k + 1, i), d = at(k + 1, i + 1);
      if ((k + i) % 2 == 0) {
        mesh.triangles.push_back({a, c, d});
        mesh.triangles.push_back({a, d, b});
      } else {
        mesh.triangles.push_back({a, c, b});
        mesh.triangles.push_back({b, c, d});
      }
    }
  return mesh;
}

}  // namespace

Watched run_without_crossings(World& world, int frames, int every) {
  Watched watched;
  for (int frame = 1; frame <= frames; ++frame) {
    const StepReport& report = world.step(1.0 / 60);
    watched.ok = watched.ok && report.ok();
    watched.kept_apart += report.kept_apart;
    watched.largest_strain = std::max(watched.largest_strain, report.largest_strain);
    if (frame % every != 0 && frame != frames) continue;
    watched.crossings = crossings(world);
    if (watched.crossings == 0) continue;
    watched.first_crossed = frame;
    break;
  }
  return watched;
}

double top_speed(const World& world, ObjectId object) {
  double top = 0;
  for (const Vec3f& v : world.velocities(object)) top = std::max(top, double(length(v)));
  return top;
}

const char* support_name(Support support) {
  return support == Support::ball ? "ball" : support == Support::ring ? "ring" : "corner";
}

DrapeAndFold drape_and_fold(int n, Support support) {
  DrapeAndFold scene{World(), {}, 1.2, 3.5};
  World& world = scene.world;
  const double edge = 1.0 / (n - 1);
  const auto at = [](double x, double y, double z) { return Transform{.translation = {x, y, z}}; };
  const ObstacleMaterial wood{.thickness = 0.01f, .friction = 0.4f};
  world.add_collider(Plane{}, {.friction = 0.6f});
  if (support == Support::ball) world.add_collider(Sphere{{0, 0.25f, 0}, 0.25f}, {.friction = 0.4f});
  if (support == Support::ring)
    world.add_obstacle(torus(0.17, 0.08, 40, 16), wood, {}, {.transform = at(0, 0.42, 0)});
  if (support == Support::corner)
    world.add_obstacle(box({0.6, 0.4, 0.6}, 6), wood, {}, {.transform = at(0.15, 0.3, -0.15)});
  const double t = scene.fold_at;
  const auto path = ColliderMotion::keyframes({{t, {-0.32, 0.36, 0}},
                                               {t + 0.4, {-0.3, 0.66, 0}},
                                               {t + 0.7, {0, 0.75, 0}},
                                               {t + 1.0, {0.3, 0.62, 0}},
                                               {t + 1.8, {1.2, 0.62, 0}}});
  const Transform along_z{.rotation = Quatd::from_axis_angle({1, 0, 0}, pi / 2)};
  world.add_obstacle(capsule(0.025, 1.2, 12, 3, 24), wood, {.pose = path},
                     {.name = "bar", .transform = along_z});
  ObjectOptions options{.transform = at(0, 0.56, 0)};
  options.self_collision = SelfCollision::surfaces;
  scene.cloth = world.add_cloth(grid(n, n, 1),
                                {.areal_density = 0.2f,
                                 .bending_stiffness = 2e-5f,
                                 .thickness = static_cast<float>(0.4 * edge),
                                 .friction = 0.4f,
                                 .damping = 1},
                                options);
  return scene;
}

Heap sheet_on_edge(int n) {
  constexpr double side = 2;
  Heap heap{World(), {}};
  heap.cloth = heap.world.add_cloth(grid(n, n, side), {.thickness = static_cast<float>(0.35 * side / n)},
                                    {.transform = {.translation = {0, 0.5 * side + 0.02, 0},
                                                   .rotation = Quatd::from_axis_angle({0, 0, 1}, 1.48)},
                                     .self_collision = SelfCollision::surfaces});
  heap.world.add_collider(Plane{});
  return heap;
}

// When the tube is twisted into a rope of radius r = sqrt(2 R thickness), its outer fibers are helices. For
// their length L to stay constant, the rims must approach by L - sqrt(L^2 - (2 pi turns r)^2).
TwistedTube twisted_tube(int around, double turns, double seconds) {
  constexpr double radius = 0.06;
  const double edge = 2 * pi * radius / around, thickness = 0.3 * edge;
  const double core = 2 * pi * turns * std::sqrt(2 * radius * thickness);
  const double length = 1.5 * core + 0.2;
  const double nearer = length - std::sqrt(length * length - core * core);
  const int along = static_cast<int>(std::lround(length / edge));
  // Levels do not feel contacts and fight a cloth that is wrung (docs/notes/solvers.md).
  TwistedTube scene{World({.solver = {.kind = SolverKind::gauss_seidel}}), {}, seconds};
  World& world = scene.world;
  ObjectOptions options{.self_collision = SelfCollision::surfaces};
  const TriangleMesh mesh = tube(around, along, radius, length);
  scene.tube = world.add_cloth(mesh,
                               {.areal_density = 0.2f,
                                .bending_stiffness = 1e-5f,
                                .thickness = static_cast<float>(thickness),
                                .damping = 2},
                               options);
  std::vector<std::uint32_t> lower, upper;
  for (std::uint32_t i = 0; i < std::uint32_t(around); ++i) {
    lower.push_back(i);
    upper.push_back(std::uint32_t(along * around) + i);
  }
  world.pin(scene.tube, vertices(lower));
  const std::vector<Vec3d> rest = mesh.positions;
  world.pin(scene.tube, vertices(upper), [=](std::uint32_t vertex, double t) {
    const double part = std::clamp(t / seconds, 0.0, 1.0);
    const Vec3d turned = rotate(Quatd::from_axis_angle({0, 1, 0}, 2 * pi * turns * part), rest[vertex]);
    return turned - Vec3d{0, nearer * part * part, 0};
  });
  return scene;
}

// The left strip lies flat in a loop. The right strip passes over that loop, under both of its legs and over
// them from behind: over, under, over; over, under, over. Both stand on edge.
Knot reef_knot(int across, double pull) {
  constexpr double width = 0.08, h = 0.12;
  const double edge = width / (across - 1);
  std::vector<Vec3d> left{{-1.6, 0, 0.32}, {-1, 0, 0.32}, {-0.4, 0, 0.32}, {0, 0, 0.32}, {0.2, 0, 0.25}};
  left.push_back({0.31, 0, 0});
  std::vector<Vec3d> right{{1.6, h, 0.14},         {1, h, 0.14},           {0.5, h, 0.14},
                           {0.28, h, 0.15},        {0.1, 0, 0.2},          {-0.05, -h, 0.28},
                           {-0.15, -h, 0.36},      {-0.3, -0.7 * h, 0.5},  {-0.48, 0, 0.53},
                           {-0.64, 0.8 * h, 0.46}, {-0.74, 1.1 * h, 0.32}, {-0.78, 1.1 * h, 0}};
  for (std::vector<Vec3d>* points : {&left, &right})
    for (std::size_t i = points->size() - 1; i-- > 0;)
      points->push_back({(*points)[i].x, (*points)[i].y, -(*points)[i].z});
  Knot knot{World({.substeps = 30, .gravity = {}, .drag = 0.5f}), {}, {}};
  World& world = knot.world;
  const ClothMaterial material{.areal_density = 1,
                               .bending_stiffness = 1e-5f,
                               .thickness = static_cast<float>(0.3 * edge),
                               .friction = 0.4f,
                               .damping = 2};
  const auto add = [&](const char* name, const std::vector<Vec3d>& points, double direction) {
    ObjectOptions options{.name = name};
    options.self_collision = SelfCollision::surfaces;
    const TriangleMesh mesh = strip_along(smooth_curve(points, edge), across, width);
    const ObjectId strip = world.add_cloth(mesh, material, options);
    // Springs on `across` vertices; without motion of the strip each would stretch by at most 1.2 m.
    constexpr double span = 1.2;
    std::vector<std::uint32_t> ends;
    for (std::uint32_t k = 0; k < std::uint32_t(across); ++k) {
      ends.push_back(k);
      ends.push_back(static_cast<std::uint32_t>(mesh.positions.size()) - 1 - k);
    }
    const std::vector<Vec3d> rest = mesh.positions;
    world.attach(
        strip, vertices(ends),
        [=](std::uint32_t vertex, double t) {
          return rest[vertex] + Vec3d{direction * span * std::min(t / 1.5, 1.0), 0, 0};
        },
        static_cast<float>(span * across / pull));
    return strip;
  };
  knot.left = add("left", left, -1);
  knot.right = add("right", right, 1);
  return knot;
}

namespace {

// Revolves a closed profile (radius, height), first and last point on the axis, about Y.
TriangleMesh lathe(const std::vector<std::array<double, 2>>& profile, int segments) {
  TriangleMesh mesh;
  const std::size_t rings = profile.size() - 2;
  mesh.positions.push_back({0, profile.front()[1], 0});
  for (std::size_t ring = 1; ring <= rings; ++ring)
    for (int s = 0; s < segments; ++s) {
      const double angle = 2 * pi * s / segments;
      const auto [r, y] = profile[ring];
      mesh.positions.push_back({r * std::cos(angle), y, r * std::sin(angle)});
    }
  mesh.positions.push_back({0, profile.back()[1], 0});
  const auto last = static_cast<std::uint32_t>(mesh.positions.size()) - 1;
  const auto at = [&](std::size_t ring, int s) {
    return static_cast<std::uint32_t>(1 + ring * std::size_t(segments) + std::size_t(s % segments));
  };
  for (int s = 0; s < segments; ++s) mesh.triangles.push_back({0, at(0, s), at(0, s + 1)});
  for (std::size_t ring = 0; ring + 1 < rings; ++ring)
    for (int s = 0; s < segments; ++s) {
      mesh.triangles.push_back({at(ring, s), at(ring + 1, s), at(ring + 1, s + 1)});
      mesh.triangles.push_back({at(ring, s), at(ring + 1, s + 1), at(ring, s + 1)});
    }
  for (int s = 0; s < segments; ++s) mesh.triangles.push_back({last, at(rings - 1, s + 1), at(rings - 1, s)});
  return mesh;
}

}  // namespace

TriangleMesh glass_mesh(double radius, double height, double wall, int segments) {
  const double outer = radius + wall;
  std::vector<std::array<double, 2>> profile{{0, 0}, {outer / 2, 0}, {outer, 0}};
  constexpr int parts = 6;
  for (int k = 1; k <= parts; ++k) profile.push_back({outer, (height + wall) * k / parts});
  for (int k = 0; k <= parts; ++k) profile.push_back({radius, wall + height * (parts - k) / parts});
  profile.push_back({radius / 2, wall});
  profile.push_back({0, wall});
  return lathe(profile, segments);
}

Glass balls_in_glass(int count, const Settings& settings) {
  constexpr double ball = 0.05, spacing = 0.115, wall = 0.03;
  const int per_layer = count >= 30 ? 7 : 3;
  Glass scene{
      World(settings), tet_ball(1, 2, ball), {}, per_layer == 7 ? 0.21 : 0.15, per_layer == 7 ? 0.9 : 0.4};
  World& world = scene.world;
  world.add_obstacle(glass_mesh(scene.radius, scene.height, wall, 36),
                     {.thickness = 0.004f, .friction = 0.3f});
  for (int k = 0; k < count; ++k) {
    const int place = k % per_layer, layer = k / per_layer;
    const double ring = per_layer == 7 && place == 0 ? 0 : per_layer == 7 ? spacing : spacing * 0.6;
    const double angle = 2 * pi * place / (per_layer == 7 ? 6 : 3) + 0.5 * layer;
    const Vec3d at{ring * std::cos(angle), scene.height + 0.1 + spacing * layer, ring * std::sin(angle)};
    scene.balls.push_back(world.add_soft_body(
        scene.ball,
        {.young_modulus = 5e4f, .thickness = 0.004f, .friction = 0.3f, .damping_time = 0.005f, .damping = 1},
        {.transform = {.translation = at}}));
  }
  return scene;
}

double shared_volume(const World& world, const std::vector<ObjectId>& bodies, const TetMesh& mesh) {
  const auto volume = [](const Vec3d& o, const Vec3d& x, const Vec3d& y, const Vec3d& z) {
    return dot(x - o, cross(y - o, z - o)) / 6;
  };
  struct Body {
    std::vector<Vec3d> x;
    Vec3d lo, hi;
  };
  std::vector<Body> placed;
  for (const ObjectId id : bodies) {
    Body body{{}, Vec3d{1, 1, 1} * 1e30, Vec3d{1, 1, 1} * -1e30};
    for (const Vec3f& p : world.positions(id)) {
      body.x.emplace_back(p);
      for (int axis = 0; axis < 3; ++axis) {
        body.lo[axis] = std::min(body.lo[axis], double(p[axis]));
        body.hi[axis] = std::max(body.hi[axis], double(p[axis]));
      }
    }
    placed.push_back(std::move(body));
  }
  const auto holds = [&](const Body& body, const Vec3d& p) {
    for (int axis = 0; axis < 3; ++axis)
      if (p[axis] < body.lo[axis] || p[axis] > body.hi[axis]) return false;
    for (const Tet& t : mesh.tets) {
      const Vec3d &a = body.x[t[0]], &b = body.x[t[1]], &c = body.x[t[2]], &d = body.x[t[3]];
      if (volume(p, b, c, d) > 0 && volume(a, p, c, d) > 0 && volume(a, b, p, d) > 0 &&
          volume(a, b, c, p) > 0)
        return true;
    }
    return false;
  };
  Random random(1);
  double all = 0, shared = 0;
  constexpr int samples = 4;
  for (std::size_t one = 0; one < placed.size(); ++one)
    for (const Tet& t : mesh.tets) {
      const std::vector<Vec3d>& x = placed[one].x;
      const double part = volume(x[t[0]], x[t[1]], x[t[2]], x[t[3]]) / samples;
      all += samples * part;
      for (int k = 0; k < samples; ++k) {
        double weight[4], sum = 0;
        for (double& w : weight) sum += w = -std::log(random.unit() + 1e-9);
        Vec3d p;
        for (std::size_t c = 0; c < 4; ++c) p += x[t[c]] * (weight[c] / sum);
        for (std::size_t other = 0; other < placed.size(); ++other)
          if (other != one && holds(placed[other], p)) {
            shared += part;
            break;
          }
      }
    }
  return shared / all;
}

// Grains as light as table tennis balls, cloth as strong as that of a vest.
Shot shot_at(ShotAt what, int n, int grains, double speed) {
  constexpr double radius = 0.01, spacing = 2.1 * radius;
  Shot shot{World({.substeps = 20}), {}, {}};
  World& world = shot.world;
  if (what == ShotAt::cloth) {
    shot.target = world.add_cloth(
        grid(n, n, 1), {.areal_density = 1, .membrane_stiffness = 1e5f, .thickness = float(0.3 / (n - 1))},
        {.self_collision = SelfCollision::surfaces});
  } else {
    const double cell = 1.0 / (n - 1);
    shot.target = world.add_soft_body(tet_bar(n - 1, 1, n - 1, {1, cell, 1}),
                                      {.young_modulus = 1e6f, .thickness = float(0.3 * cell)});
  }
  for (const double side : {-0.5, 0.5}) {
    const float lo = float(side - 1e-3), hi = float(side + 1e-3);
    world.pin(shot.target, in_box({lo, -1, -1}, {hi, 1, 1}));
    world.pin(shot.target, in_box({-1, -1, lo}, {1, 1, hi}));
  }
  std::vector<Vec3d> lattice;
  for (int x = -9; x <= 9; ++x)
    for (int y = -9; y <= 9; ++y)
      for (int z = -9; z <= 9; ++z) lattice.push_back(Vec3d{double(x), double(y), double(z)} * spacing);
  std::stable_sort(lattice.begin(), lattice.end(),
                   [](const Vec3d& a, const Vec3d& b) { return dot(a, a) < dot(b, b); });
  lattice.resize(std::size_t(grains));
  ObjectOptions thrown{.transform = {.translation = {0.013, 0.4, 0.007}}, .velocity = {0, float(-speed), 0}};
  shot.grains = world.add_grains(lattice, {.radius = float(radius), .density = 100}, thrown);
  return shot;
}

// A vertical line up from a grain crosses the target once if the grain is below it. A body of one layer is
// crossed twice, or once from inside.
std::size_t grains_that_passed(const Shot& shot) {
  const World& world = shot.world;
  const auto x = world.positions(shot.target);
  std::size_t count = 0;
  for (const Vec3f& grain : world.positions(shot.grains)) {
    bool below = false;
    for (const Triangle& t : world.triangles(shot.target)) {
      const auto side = [&](std::uint32_t i, std::uint32_t j) {
        return (double(x[i].x) - double(grain.x)) * (double(x[j].z) - double(grain.z)) -
               (double(x[i].z) - double(grain.z)) * (double(x[j].x) - double(grain.x));
      };
      const double a = side(t[1], t[2]), b = side(t[2], t[0]), c = side(t[0], t[1]), sum = a + b + c;
      if (!((a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0)) || sum == 0) continue;
      const double height = (a * double(x[t[0]].y) + b * double(x[t[1]].y) + c * double(x[t[2]].y)) / sum;
      below = below != (height > double(grain.y) && world.kind(shot.target) == ObjectKind::cloth);
      if (world.kind(shot.target) != ObjectKind::cloth) below = below || height > double(grain.y);
    }
    count += below ? 1 : 0;
  }
  return count;
}

// A cone of height H and radius R has its center of mass at H / 4 and a mean distance from the axis of R / 2.
double slope_of_heap(const World& world, ObjectId grains, double radius) {
  double height = 0, distance = 0;
  Vec3d middle;
  const auto x = world.positions(grains);
  for (const Vec3f& p : x) middle += Vec3d(p) / double(x.size());
  for (const Vec3f& p : x) {
    height += (double(p.y) - radius) / double(x.size());
    distance += std::hypot(double(p.x) - middle.x, double(p.z) - middle.z) / double(x.size());
  }
  return 2 * height / distance;
}

}  // namespace souple::test
