#include "render/constraint_lines.h"
#include "render/display.h"
#include "render/legend.h"
#include "render/vertex_colors.h"
#include "souple/geometry/builders.h"
#include "souple/world/debug_draw.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace souple::render::test_render_display {

/// One object of each kind and one collider of each shape.
struct Everything {
  World world{{.substeps = 4}};
  ObjectId cloth, lump, box, rope, grains;
  ColliderId floor, ball;

  Everything() {
    cloth = world.add_cloth(grid(8, 6, 1.0), {}, {.transform = {.translation = {0, 1, 0}}});
    world.pin(cloth, vertices({0, 7}));
    world.attach(cloth, vertices({40}));
    lump =
        world.add_soft_body(sphere(2, 0.2), {}, {.cells = 80}, {.transform = {.translation = {2, 0.18, 0}}});
    box = world.add_soft_body(tet_bar(2, 2, 2, {0.3, 0.3, 0.3}), {.model = SoftBodyModel::shape_matching},
                              {.transform = {.translation = {3, 0.14, 0}}});
    rope = world.add_rope(std::vector<Vec3d>{{-1, 1, 0}, {-1, 1, 1}}, 10,
                          {.radius = 0.02f, .bending_stiffness = 1e-4f});
    world.pin(rope, vertices({0}));
    world.add_tethers(rope);
    grains = world.add_grains(std::vector<Vec3d>{{-2, 0.02, 0}, {-2, 0.06, 0}, {-2, 0.1, 0.01}},
                              {.radius = 0.02f});
    floor = world.add_collider(Plane{{0, 1, 0}, 0.01f});
    ball = world.add_collider(Sphere{{0, 0.6f, 0}, 0.3f});
    world.add_collider(Box{{5, 0, 0}});
    world.add_collider(Capsule{{6, 0, 0}});
    world.add_collider(Cylinder{{7, 0, 0}});
    world.add_collider(Plane{{1, 1, 0}, -20});
  }
  void run(int steps) {
    for (int i = 0; i < steps; ++i) world.step(1.0 / 60);
  }
};

constexpr std::size_t bodies = 5, colliders = 6;

std::vector<ConstraintDisplay> all_constraint_displays() {
  std::vector<ConstraintDisplay> result;
  for (std::size_t i = 0; i < constraint_display_count; ++i)
    result.push_back(static_cast<ConstraintDisplay>(i));
  return result;
}

void expect_valid(const DrawList& list, const std::string& where) {
  for (const Surface& s : list.surfaces) {
    EXPECT_TRUE(s.normals.empty() || s.normals.size() == s.positions.size()) << where;
    EXPECT_TRUE(s.texture.empty() || s.texture.size() == s.positions.size()) << where;
    EXPECT_TRUE(s.colors.empty() || s.colors.size() == s.positions.size()) << where;
    EXPECT_FALSE(s.triangles.empty()) << where;
    EXPECT_NE(s.key, 0u) << where;
    for (const Vec3f& x : s.positions) EXPECT_TRUE(is_finite(x)) << where;
    for (const Vec3f& n : s.normals) EXPECT_TRUE(is_finite(n)) << where;
    for (const Vec3f& t : s.texture) EXPECT_TRUE(is_finite(t)) << where;
    for (const Triangle& t : s.triangles)
      for (const std::uint32_t v : t) EXPECT_LT(v, s.positions.size()) << where;
    EXPECT_GT(s.look.roughness, 0) << where;
  }
  for (const Spheres& s : list.spheres) {
    EXPECT_TRUE(s.radii.empty() || s.radii.size() == s.centers.size()) << where;
    EXPECT_TRUE(s.colors.empty() || s.colors.size() == s.centers.size()) << where;
    for (const Vec3f& x : s.centers) EXPECT_TRUE(is_finite(x)) << where;
    for (const float r : s.radii) EXPECT_GT(r, 0) << where;
    EXPECT_GT(s.radius, 0) << where;
  }
  for (const auto* lines : {&list.lines, &list.top_lines})
    for (const Line& line : *lines)
      EXPECT_TRUE(is_finite(line.a) && is_finite(line.b) && line.width > 0) << where;
  for (const Label& label : list.labels) EXPECT_FALSE(label.text.empty()) << where;
}

template <class T>
bool same(std::span<const T> a, std::span<const T> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end());
}

bool legend_names(const DrawList& list, const std::string& word) {
  return std::any_of(list.labels.begin(), list.labels.end(),
                     [&](const Label& label) { return label.text.find(word) != std::string::npos; });
}

/// The surface drawn for a body.
const Surface* surface_of(const DrawList& list, std::uint32_t pick) {
  for (const Surface& s : list.surfaces)
    if (s.pick == pick) return &s;
  return nullptr;
}
const Spheres* spheres_of(const DrawList& list, std::uint32_t pick) {
  for (const Spheres& s : list.spheres)
    if (s.pick == pick) return &s;
  return nullptr;
}

TEST(Legend, WritesNumbersAsUsersReadThem) {
  EXPECT_EQ(short_number(0), "0");
  EXPECT_EQ(short_number(0.01234), "0.0123");
  EXPECT_EQ(short_number(120), "120");
  EXPECT_EQ(short_number(123'456), "123000");
  EXPECT_EQ(short_number(-1234), "-1230");
  EXPECT_EQ(short_number(1.2e9), "1.2e+09");
}

TEST(Display, EveryDisplayOfEveryKindIsSound) {
  Everything all;
  all.run(5);
  const Subject subject = subject_of(all.world);
  ASSERT_EQ(subject.bodies.size(), bodies);
  ASSERT_EQ(subject.colliders.size(), colliders);
  SubjectDrawing drawing;
  for (std::size_t i = 0; i < display_count; ++i)
    for (const ConstraintDisplay constraints : all_constraint_displays()) {
      const auto display = static_cast<Display>(i);
      const std::string where =
          std::string(display_name(display)) + " " + std::string(constraint_display_name(constraints));
      const DrawList& list = drawing.update(subject, {.display = display, .constraints = constraints});
      expect_valid(list, where);
      // Every body and every collider but the ground can be picked, with a unique number.
      std::multiset<std::uint32_t> picks;
      for (const Surface& s : list.surfaces) picks.insert(s.pick);
      for (const Spheres& s : list.spheres) picks.insert(s.pick);
      for (std::uint32_t pick = 1; pick <= bodies + colliders; ++pick)
        EXPECT_EQ(picks.count(pick), pick == bodies + 1 ? 0u : 1u) << where << " pick " << pick;
      std::set<std::uint64_t> keys;
      for (const Surface& s : list.surfaces) EXPECT_TRUE(keys.insert(s.key).second) << where;
      keys.clear();
      for (const Spheres& s : list.spheres) EXPECT_TRUE(keys.insert(s.key).second) << where;
    }
}

TEST(Display, ACacheWithoutAWorldIsDrawnInEveryDisplay) {
  Everything all;
  all.run(2);
  Subject subject = subject_of(all.world);
  subject.world = nullptr;
  for (Body& body : subject.bodies) body.velocities = {};
  SubjectDrawing drawing;
  for (std::size_t i = 0; i < display_count; ++i) {
    const DisplayOptions options{.display = static_cast<Display>(i), .constraints = ConstraintDisplay::kind};
    const DrawList& list = drawing.update(subject, options);
    expect_valid(list, std::string(display_name(options.display)));
    EXPECT_TRUE(list.top_lines.empty());
    EXPECT_TRUE(legend_names(list, "no constraints"));
    for (std::uint32_t pick = 1; pick <= bodies; ++pick)
      EXPECT_TRUE(surface_of(list, pick) || spheres_of(list, pick)) << display_name(options.display);
  }
}

TEST(Display, TheSameStateGivesTheSameList) {
  Everything a, b;
  a.run(4);
  b.run(4);
  SubjectDrawing first, second;
  for (std::size_t i = 0; i < display_count; ++i)
    for (const ConstraintDisplay constraints : all_constraint_displays()) {
      const DisplayOptions options{.display = static_cast<Display>(i), .constraints = constraints};
      const DrawList& x = first.update(subject_of(a.world), options);
      const DrawList& y = second.update(subject_of(b.world), options);
      ASSERT_EQ(x.surfaces.size(), y.surfaces.size());
      for (std::size_t s = 0; s < x.surfaces.size(); ++s) {
        EXPECT_TRUE(same(x.surfaces[s].positions, y.surfaces[s].positions));
        EXPECT_TRUE(same(x.surfaces[s].colors, y.surfaces[s].colors));
        EXPECT_TRUE(same(x.surfaces[s].texture, y.surfaces[s].texture));
        EXPECT_EQ(x.surfaces[s].look.color, y.surfaces[s].look.color);
        EXPECT_NE(x.surfaces[s].key, y.surfaces[s].key);  // two drawings may share a renderer
      }
      ASSERT_EQ(x.spheres.size(), y.spheres.size());
      for (std::size_t s = 0; s < x.spheres.size(); ++s) {
        EXPECT_TRUE(same(x.spheres[s].centers, y.spheres[s].centers));
        EXPECT_TRUE(same(x.spheres[s].colors, y.spheres[s].colors));
      }
      ASSERT_EQ(x.top_lines.size(), y.top_lines.size());
      for (std::size_t l = 0; l < x.top_lines.size(); ++l) {
        EXPECT_EQ(x.top_lines[l].a, y.top_lines[l].a);
        EXPECT_EQ(x.top_lines[l].color, y.top_lines[l].color);
      }
      ASSERT_EQ(x.labels.size(), y.labels.size());
      for (std::size_t l = 0; l < x.labels.size(); ++l) EXPECT_EQ(x.labels[l].text, y.labels[l].text);
    }
}

TEST(Display, VersionsChangeWhenAndOnlyWhenSomethingDid) {
  Everything all;
  SubjectDrawing drawing;
  const DisplayOptions shaded;
  const auto look = [&](const DisplayOptions& options) {
    const DrawList& list = drawing.update(subject_of(all.world), options);
    std::vector<std::array<std::uint64_t, 3>> result;
    for (const Surface& s : list.surfaces) result.push_back({s.key, s.topology, s.version});
    for (const Spheres& s : list.spheres) result.push_back({s.key, 0, s.version});
    return result;
  };
  const auto before = look(shaded);
  EXPECT_EQ(look(shaded), before);  // there is no change to upload
  all.world.step(1.0 / 60);
  const auto after = look(shaded);
  ASSERT_EQ(after.size(), before.size());
  EXPECT_EQ(after[0][1], before[0][1]);              // same triangles
  EXPECT_NE(after[0][2], before[0][2]);              // moved
  EXPECT_EQ(after[bodies - 1], before[bodies - 1]);  // a collider, after the four bodies with surfaces
  EXPECT_NE(look({.display = Display::speed})[0][2], after[0][2]);  // other colors
  const auto paused = look(shaded);
  std::vector<Vec3f> moved(all.world.positions(all.cloth).begin(), all.world.positions(all.cloth).end());
  moved[3].y += 0.1f;
  all.world.set_positions(all.cloth, moved);
  EXPECT_NE(look(shaded)[0][2], paused[0][2]);  // without a step
}

TEST(Display, ObjectsAndCollidersComeAndGo) {
  Everything all;
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject_of(all.world), {});
  const Color lump = surface_of(list, 2)->look.color;
  const std::uint64_t key = surface_of(list, 2)->key;
  all.world.remove(all.cloth);
  all.world.remove(all.floor);
  drawing.update(subject_of(all.world), {});
  expect_valid(list, "removed");
  EXPECT_FALSE(list.ground.shown);
  EXPECT_EQ(surface_of(list, 1)->look.color, lump);  // its index decreased and its look is unchanged
  EXPECT_EQ(surface_of(list, 1)->key, key);
  const ObjectId added = all.world.add_cloth(grid(5, 5, 0.5));
  drawing.update(subject_of(all.world), {});
  expect_valid(list, "added");
  EXPECT_EQ(surface_of(list, bodies)->positions.data(), all.world.positions(added).data());
  all.world.set_collider(all.ball, Sphere{{0, 0, 0}, 0.7f}, {});
  drawing.update(subject_of(all.world), {});
  const Surface* ball = surface_of(list, bodies + 1);
  for (const Vec3f& x : ball->positions) ASSERT_NEAR(length(x), 0.7f, 1e-5);
}

TEST(Display, AnotherWorldIsDrawnAfresh) {
  Everything all;
  World other;
  const ObjectId sheet = other.add_cloth(grid(3, 3, 1.0));
  SubjectDrawing drawing;
  drawing.update(subject_of(all.world, 1), {});
  const DrawList& list = drawing.update(subject_of(other, 2), {});
  ASSERT_EQ(list.surfaces.size(), 1u);
  EXPECT_EQ(list.surfaces[0].positions.data(), other.positions(sheet).data());
  EXPECT_EQ(list.surfaces[0].texture.size(), 9u);
}

TEST(Display, StretchedClothIsHotAndClothAtRestIsCold) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(6, 6, 1.0));
  SubjectDrawing drawing;
  const DisplayOptions options{.display = Display::strain, .max_strain = 0.1f};
  const DrawList& list = drawing.update(subject_of(world), options);
  for (const PackedColor c : list.surfaces[0].colors) EXPECT_EQ(c, pack(heat(0)));
  std::vector<Vec3f> x(world.positions(cloth).begin(), world.positions(cloth).end());
  for (Vec3f& p : x) p.x *= 1.1001f;
  world.set_positions(cloth, x);
  drawing.update(subject_of(world), options);
  for (const PackedColor c : list.surfaces[0].colors) EXPECT_EQ(c, pack(heat(1)));
  EXPECT_TRUE(legend_names(list, "10 %"));
  for (Vec3f& p : x) p.x *= 0.5f;  // compressed
  world.set_positions(cloth, x);
  drawing.update(subject_of(world), options);
  for (const PackedColor c : list.surfaces[0].colors) EXPECT_EQ(c, pack(heat(0)));
}

TEST(Display, AStretchedRopeIsHotWhereItIsStretched) {
  World world;
  const ObjectId rope = world.add_rope(std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}}, 10);
  std::vector<Vec3f> x(world.positions(rope).begin(), world.positions(rope).end());
  for (std::size_t i = 5; i < x.size(); ++i) x[i].x += 0.02f;  // the segment from 4 to 5, by 20 %
  for (std::size_t i = 8; i < x.size(); ++i) x[i].x += 0.02f;  // and that from 7 to 8
  world.set_positions(rope, x);
  SubjectDrawing drawing;
  const Subject subject = subject_of(world);
  const Surface tube =
      drawing.update(subject, {.display = Display::strain, .max_strain = 0.1f}).surfaces.at(0);
  for (std::uint32_t v = 0; v < tube.positions.size(); ++v) {
    const std::uint32_t point = drawing.vertex_of(subject, 1, v);
    const float at = tube.positions[v].x;
    const float away = std::min(std::abs(at - 0.46f), std::abs(at - 0.78f));
    if (away < 0.05f) {
      EXPECT_EQ(tube.colors[v], pack(heat(1))) << point;
    }
    if (away > 0.2f) {
      EXPECT_EQ(tube.colors[v], pack(heat(0))) << point;
    }
  }
}

TEST(Display, SpeedIsShownOnItsScale) {
  World world({.gravity = {}});
  world.add_cloth(grid(4, 4, 1.0), {}, {.velocity = {0, 1.5f, 0}});
  world.add_grains(std::vector<Vec3d>{{5, 0, 0}}, {}, {.velocity = {3, 0, 0}});
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject_of(world), {.display = Display::speed, .max_speed = 3});
  const HeatScale scale;
  for (const PackedColor c : list.surfaces.at(0).colors) EXPECT_EQ(c, scale(0.5f));
  EXPECT_EQ(list.spheres.at(0).colors[0], scale(1));
  EXPECT_TRUE(legend_names(list, "3 m/s"));
}

TEST(Display, NormalsAreColorsAndLines) {
  World world;
  world.add_cloth(grid(4, 4, 1.0));
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject_of(world), {.display = Display::normals});
  for (const PackedColor c : list.surfaces.at(0).colors) {
    EXPECT_NEAR(static_cast<int>(c & 0xff), 127, 1);
    EXPECT_EQ(c >> 8 & 0xff, 255u);  // +y
    EXPECT_NEAR(static_cast<int>(c >> 16 & 0xff), 127, 1);
  }
  ASSERT_EQ(list.lines.size(), 16u);
  for (const Line& line : list.lines) {
    const Vec3f along = normalized(line.b - line.a);
    EXPECT_NEAR(along.y, 1, 1e-5);
  }
}

TEST(Display, ALevelFloorIsTheGroundAtItsHeight) {
  World world;
  world.add_cloth(grid(4, 4, 1.0));
  world.add_collider(Plane{{0, 2, 0}, 0.6f},
                     {.motion = ColliderMotion::fixed({.translation = {3, 0.25, 0}})});
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject_of(world), {});
  EXPECT_TRUE(list.ground.shown);
  EXPECT_NEAR(list.ground.height, 0.55, 1e-6);
  EXPECT_EQ(list.surfaces.size(), 1u);
  drawing.update(subject_of(world), {.colliders = false});
  EXPECT_FALSE(list.ground.shown);
}

TEST(Display, ALevelFloorHasTheColorOfItsPlane) {
  World world;
  world.add_cloth(grid(4, 4, 1.0));
  world.add_collider(Plane{});
  Subject subject = subject_of(world);
  SubjectDrawing drawing;
  EXPECT_EQ(drawing.update(subject, {}).ground.color, Ground().color);
  const Color green = srgb(0x306020);
  subject.colliders[0].color = green;
  const Ground& ground = drawing.update(subject, {}).ground;
  EXPECT_NEAR((ground.color.g + ground.second.g) / 2, green.g, 1e-6);
  EXPECT_NEAR((ground.color.r + ground.second.r) / 2, green.r, 1e-6);
  EXPECT_GT(ground.color.g, ground.second.g);
}

TEST(Display, ATiltedPlaneIsASquareOnItUnderTheObjects) {
  World world;
  world.add_cloth(grid(4, 4, 1.0), {}, {.transform = {.translation = {8, 3, 0}}});
  const double angle = 0.3;
  world.add_collider(
      Plane{}, {.motion = ColliderMotion::fixed(
                    {.translation = {1, 0.5, 0}, .rotation = Quatd::from_axis_angle({0, 0, 1}, angle)})});
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject_of(world), {});
  EXPECT_FALSE(list.ground.shown);
  const Surface* plane = surface_of(list, 2);
  ASSERT_NE(plane, nullptr);
  const Vec3d normal{-std::sin(angle), std::cos(angle), 0}, on{1, 0.5, 0};
  Vec3d middle{};
  for (const Vec3f& x : plane->positions) {
    const Vec3d p = plane->pose.point(Vec3d(x));
    EXPECT_NEAR(dot(p - on, normal), 0, 1e-5);
    middle += p / 4.0;
  }
  const Vec3d cloth{8, 3, 0};
  EXPECT_NEAR(length(middle - (cloth - normal * dot(cloth - on, normal))), 0, 0.1);
}

TEST(Display, CollidersAreDrawnWhereTheyAre) {
  World world;
  const ColliderId ball =
      world.add_collider(Sphere{{}, 0.5f}, {.motion = ColliderMotion::fixed({.translation = {1, 2, 3}})});
  SubjectDrawing drawing;
  const Surface surface = drawing.update(subject_of(world), {}).surfaces.at(0);
  for (const Vec3f& x : surface.positions)
    EXPECT_NEAR(length(surface.pose.point(Vec3d(x)) - Vec3d{1, 2, 3}), 0.5, 1e-5);
  EXPECT_EQ(surface.pose.translation, world.collider_pose(ball).translation);
}

TEST(Display, ParticlesAreTheWorlds) {
  Everything all;
  const Subject subject = subject_of(all.world);
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject, {.display = Display::particles, .pins = false});
  std::size_t drawn = 0, known = 0;
  for (const Spheres& s : list.spheres) drawn += s.centers.size();
  DebugDraw count;
  count.particle = [&](const DebugParticle&) { ++known; };
  all.world.debug_draw(count);
  EXPECT_EQ(drawn, known);
  EXPECT_TRUE(legend_names(list, "particles: " + std::to_string(known)));
  for (std::size_t i = 0; i < list.surfaces.size(); ++i) EXPECT_GT(list.surfaces[i].pick, bodies);
  // A particle of the cloth maps to the vertex at its position.
  const Spheres* cloth = spheres_of(list, 1);
  for (std::uint32_t i = 0; i < cloth->centers.size(); ++i)
    EXPECT_EQ(subject.bodies[0].positions[drawing.vertex_of(subject, 1, i)], cloth->centers[i]);
}

TEST(Display, TheLatticeShowsEveryTetEdge) {
  Everything all;
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject_of(all.world), {.display = Display::lattice});
  std::size_t edges = 0;
  DebugDraw count;
  count.tet_edge = [&](const Vec3f&, const Vec3f&) { ++edges; };
  all.world.debug_draw(count);
  EXPECT_GT(edges, 100u);
  EXPECT_EQ(list.lines.size(), edges);
  EXPECT_TRUE(legend_names(list, std::to_string(edges) + " edges"));
}

TEST(Display, ContactsPointFromTheColliderToTheObject) {
  World world;
  world.add_cloth(grid(6, 6, 0.4), {}, {.transform = {.translation = {0, 0.003, 0}}});
  world.add_collider(Plane{});
  for (int i = 0; i < 10; ++i) world.step(1.0 / 60);
  ASSERT_FALSE(world.contacts().empty());
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject_of(world), {.display = Display::contacts});
  EXPECT_EQ(list.top_lines.size(), world.contacts().size());
  for (const Line& line : list.top_lines) EXPECT_GT(line.b.y, line.a.y);
  EXPECT_TRUE(legend_names(list, "with colliders  " + std::to_string(world.contacts().size())));
}

TEST(Display, PinnedVerticesHaveBallsThatCannotBePicked) {
  Everything all;
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject_of(all.world), {});
  const Spheres* pins = spheres_of(list, 0);
  ASSERT_NE(pins, nullptr);
  ASSERT_EQ(pins->centers.size(), 3u);
  EXPECT_EQ(pins->centers[0], all.world.positions(all.cloth)[0]);
  EXPECT_EQ(pins->centers[2], all.world.positions(all.rope)[0]);
  drawing.update(subject_of(all.world), {.pins = false});
  EXPECT_EQ(spheres_of(list, 0), nullptr);
}

TEST(Display, TheLegendNamesEveryKindOfConstraint) {
  Everything all;
  all.run(3);
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject_of(all.world), {.constraints = ConstraintDisplay::kind});
  std::set<std::string> kinds;
  DebugDraw draw;
  draw.constraint = [&](const DebugConstraint& c) { kinds.emplace(c.kind); };
  all.world.debug_draw(draw);
  EXPECT_GE(kinds.size(), 6u);
  std::set<PackedColor> colors, in_use;
  for (const std::string& kind : kinds) {
    EXPECT_TRUE(legend_names(list, kind)) << kind;
    colors.insert(kind_color(kind));
  }
  EXPECT_EQ(colors.size(), kinds.size());                                           // distinguishable
  for (const Line& line : list.top_lines) in_use.insert(line.color | 0xff000000u);  // tethers are transparent
  EXPECT_EQ(in_use, colors);
}

TEST(Display, StrainOfConstraintsIsShownWhereThereIsOne) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(4, 3, 1.0));  // bending has no strain
  std::vector<Vec3f> x(world.positions(cloth).begin(), world.positions(cloth).end());
  for (Vec3f& p : x) p = p * 1.05f;
  world.set_positions(cloth, x);
  SubjectDrawing drawing;
  const DrawList& list =
      drawing.update(subject_of(world), {.constraints = ConstraintDisplay::strain, .max_strain = 0.1f});
  EXPECT_EQ(list.top_lines.size(), 3u * 3 + 4 * 2 + 6);
  const HeatScale scale;
  for (const Line& line : list.top_lines)
    EXPECT_TRUE(line.color == scale(0.5f) || line.color == scale(0.498f) || line.color == scale(0.502f));
  EXPECT_TRUE(legend_names(list, "distance"));
  EXPECT_FALSE(legend_names(list, "bending"));
}

TEST(Display, SegmentsOfDistancesLieOnTheEdgesOfTheCloth) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(4, 3, 1.0), {.bending_stiffness = 0});
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject_of(world), {.constraints = ConstraintDisplay::kind});
  const auto x = world.positions(cloth);
  std::size_t edges = 0;
  for (const Line& line : list.top_lines) {
    EXPECT_NE(std::find(x.begin(), x.end(), line.a), x.end());
    EXPECT_NE(std::find(x.begin(), x.end(), line.b), x.end());
    ++edges;
  }
  EXPECT_EQ(edges, 3u * 3 + 4 * 2 + 6);  // along, across, diagonals
}

TEST(Display, RopesAreHitOnTheTubeAndFoundAsPoints) {
  Everything all;
  const Subject subject = subject_of(all.world);
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject, {});
  const std::uint32_t pick = 4;
  const Surface* tube = surface_of(list, pick);
  const Body& rope = subject.bodies[pick - 1];
  ASSERT_EQ(rope.kind, ObjectKind::rope);
  for (std::uint32_t v = 0; v < tube->positions.size(); ++v) {
    const std::uint32_t point = drawing.vertex_of(subject, pick, v);
    ASSERT_LT(point, rope.positions.size());
    EXPECT_LT(length(tube->positions[v] - rope.positions[point]), 0.055f);  // half a segment and a radius
  }
  EXPECT_EQ(drawing.vertex_of(subject, 1, 17), 17u);  // the vertices of a cloth are drawn directly
}

TEST(Display, ABlockKeepsItsEdgesAndABallIsSmooth) {
  World world;
  const ObjectId block = world.add_soft_body(tet_bar(2, 2, 2, {0.4, 0.4, 0.4}));
  const ObjectId ball =
      world.add_soft_body(sphere(2, 0.3), {}, {.cells = 60}, {.transform = {.translation = {1, 0, 0}}});
  SubjectDrawing drawing;
  const Subject subject = subject_of(world);
  const DrawList& list = drawing.update(subject, {});
  const Surface& faces = list.surfaces.at(0);
  for (const Triangle& t : faces.triangles)
    for (const std::uint32_t v : t) {
      const Vec3f& n = faces.normals[v];  // of one face, not a mean of several
      EXPECT_NEAR(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}), 1, 1e-5);
    }
  std::vector<int> copies(world.positions(block).size());
  for (std::uint32_t v = 0; v < faces.positions.size(); ++v) {
    const std::uint32_t vertex = drawing.vertex_of(subject, 1, v);
    EXPECT_EQ(faces.positions[v], world.positions(block)[vertex]);
    ++copies[vertex];
  }
  EXPECT_EQ(std::count(copies.begin(), copies.end(), 3), 8);   // corners
  EXPECT_EQ(std::count(copies.begin(), copies.end(), 2), 12);  // middles of edges
  EXPECT_EQ(list.surfaces.at(1).positions.data(), world.positions(ball).data());
}

TEST(Display, TheCheckerOfAFlatClothHasSquareFieldsAlongItsSides) {
  World world;
  const Transform turned{.translation = {1, 2, 3}, .rotation = Quatd::from_euler_xyz({0.4, 0.8, -0.3})};
  const ObjectId cloth = world.add_cloth(grid(17, 9, 2.0), {}, {.transform = turned});
  SubjectDrawing drawing;
  const Surface surface = drawing.update(subject_of(world), {}).surfaces.at(0);
  ASSERT_EQ(surface.texture.size(), 17u * 9);
  EXPECT_GT(surface.look.checker_size, 0);
  // Fields are an eighth of the shorter side, 1 m; lengths are preserved.
  const auto x = world.positions(cloth);
  EXPECT_NEAR(length(surface.texture[16] - surface.texture[0]), 8 * length(x[16] - x[0]), 0.15);
  for (const Vec3f& t : surface.texture) EXPECT_EQ(t.y, 0.25f);  // away from borders
  for (const std::size_t corner : {0u, 16u, 136u, 152u})
    for (const float c : {surface.texture[corner].x, surface.texture[corner].z})
      EXPECT_NEAR(c, std::round(c), 0.08);  // whole fields, except for the rim
  EXPECT_EQ(drawing.update(subject_of(world), {.display = Display::plain}).surfaces[0].look.checker_size, 0);
}

/// A small pool of each of three fluids.
struct Fluids {
  World world;
  std::vector<ObjectId> pools;

  Fluids() {
    world.add_collider(Plane{});
    float x = 0;
    for (const float density : {998.0f, 920.0f, 1420.0f}) {
      std::vector<Vec3d> centers;
      centers.reserve(64);
      for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
          for (int k = 0; k < 4; ++k) centers.emplace_back(double(x) + 0.02 * i, 0.01 + 0.02 * j, 0.02 * k);
      pools.push_back(world.add_fluid(centers, {.spacing = 0.02f, .density = density}));
      x += 1;
    }
  }
};

TEST(Display, FluidsAreLiquidsWhereNothingIsMeasured) {
  Fluids fluids;
  const Subject subject = subject_of(fluids.world);
  SubjectDrawing drawing;
  for (std::size_t i = 0; i < display_count; ++i) {
    const auto display = static_cast<Display>(i);
    const DrawList& list =
        drawing.update(subject, {.display = display, .liquid_splats = SplatShape::spheres});
    const bool by_particles = display == Display::particles || display == Display::speed ||
                              display == Display::strain || display == Display::normals;
    EXPECT_EQ(list.liquids.size(), by_particles ? 0u : 3u) << display_name(display);
    for (const Liquid& liquid : list.liquids) {
      const Body& body = subject.bodies[liquid.pick - 1];
      EXPECT_TRUE(same(liquid.centers, body.positions));
      EXPECT_FLOAT_EQ(liquid.spacing, 0.02f);
      EXPECT_EQ(drawing.vertex_of(subject, liquid.pick, 7), 7u);
    }
    for (std::uint32_t pick = 1; pick <= 3; ++pick)
      EXPECT_EQ(spheres_of(list, pick) != nullptr, by_particles) << display_name(display);
  }
  EXPECT_TRUE(drawing.update(subject, {.constraints = ConstraintDisplay::kind}).liquids.empty());
}

TEST(Display, LiquidsAreEllipsoidsWhereTheseAreAskedFor) {
  Fluids fluids;
  const Subject subject = subject_of(fluids.world);
  SubjectDrawing drawing;
  const auto first = [&](SplatShape splats) {
    return drawing.update(subject, {.liquid_splats = splats}).liquids.at(0);
  };
  const Liquid spheres = first(SplatShape::spheres), ellipsoids = first(SplatShape::ellipsoids);
  EXPECT_TRUE(spheres.ellipsoids.empty());
  ASSERT_EQ(ellipsoids.ellipsoids.size(), subject.bodies[0].positions.size());
  EXPECT_NE(ellipsoids.version, spheres.version);
  for (std::size_t i = 0; i < ellipsoids.centers.size(); ++i)
    EXPECT_LT(length(ellipsoids.centers[i] - spheres.centers[i]), 0.02f);
  EXPECT_EQ(first(SplatShape::ellipsoids).version, ellipsoids.version) << "nothing has changed";
  EXPECT_TRUE(first(SplatShape::spheres).ellipsoids.empty());
}

/// As written by `souple surface`.
TEST(Display, MeshesOfFluidsAreSurfaces) {
  const TriangleMesh mesh = sphere(2, 0.2);
  std::vector<Vec3f> positions;
  for (const Vec3d& x : mesh.positions) positions.emplace_back(x);
  Body body;
  body.name = "water";
  body.kind = ObjectKind::fluid;
  body.positions = positions;
  body.triangles = mesh.triangles;
  Subject subject;
  subject.bodies.push_back(body);
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject, {});
  EXPECT_TRUE(list.liquids.empty());
  ASSERT_EQ(list.surfaces.size(), 1u);
  EXPECT_EQ(list.surfaces[0].triangles.size(), mesh.triangles.size());
}

TEST(Display, LiquidsHaveTheColorOfTheirMaterialOrTheirOwn) {
  Fluids fluids;
  Subject subject = subject_of(fluids.world);
  SubjectDrawing drawing;
  const auto look = [&](std::size_t i) { return drawing.update(subject, {}).liquids.at(i).look; };
  // Water absorbs red most, oil and honey blue; honey absorbs more of it than oil.
  EXPECT_GT(look(0).absorption.x, 2 * look(0).absorption.z);
  EXPECT_GT(look(1).absorption.z, 2 * look(1).absorption.x);
  EXPECT_GT(look(2).absorption.y, 1.5f * look(1).absorption.y);
  EXPECT_FLOAT_EQ(look(0).refractive_index, 1.333f);
  subject.bodies[1].color = srgb(0xff0000);
  EXPECT_EQ(look(1).absorption.x, 0);
  EXPECT_GT(look(1).absorption.y, 10 * look(2).absorption.x);
}

TEST(Display, FoamIsDrawnWithItsLiquid) {
  Fluids fluids;
  Subject subject = subject_of(fluids.world);
  const std::vector<Vec3f> bubbles{{0, 0.1f, 0}, {0.01f, 0.1f, 0}};
  subject.bodies[0].foam = bubbles;
  SubjectDrawing drawing;
  const DrawList& list = drawing.update(subject, {});
  ASSERT_EQ(list.foams.size(), 1u);
  EXPECT_TRUE(same(list.foams[0].centers, std::span<const Vec3f>(bubbles)));
  EXPECT_TRUE(drawing.update(subject, {.display = Display::speed}).foams.empty());
}

}  // namespace souple::render::test_render_display
