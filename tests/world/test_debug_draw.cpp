#include "souple/constraints/distance.h"
#include "souple/solver/custom_constraint.h"
#include "souple/solver/set_projector.h"
#include "tests/world/scene.h"

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

namespace souple::test_world_debug_draw {

/// All output of World::debug_draw, stored.
struct Drawn {
  struct Constraint {
    std::string kind;
    std::vector<Vec3f> points;
    int color;
    float strain, residual;
  };
  std::vector<Constraint> constraints;
  std::vector<DebugContact> contacts;
  std::vector<DebugParticle> particles;
  std::vector<std::pair<Vec3f, Vec3f>> edges;

  explicit Drawn(const World& world) {
    DebugDraw draw;
    draw.constraint = [this](const DebugConstraint& c) {
      constraints.push_back(
          {std::string(c.kind), {c.points.begin(), c.points.end()}, c.color, c.strain, c.residual});
    };
    draw.contact = [this](const DebugContact& c) { contacts.push_back(c); };
    draw.particle = [this](const DebugParticle& p) { particles.push_back(p); };
    draw.tet_edge = [this](const Vec3f& a, const Vec3f& b) { edges.emplace_back(a, b); };
    world.debug_draw(draw);
  }

  std::map<std::string, std::size_t> counts() const {
    std::map<std::string, std::size_t> result;
    for (const Constraint& c : constraints) ++result[c.kind];
    return result;
  }
};

/// One object of each kind, on a floor.
struct Everything {
  World world{{.substeps = 4}};
  ObjectId cloth, balloon, lump, box, rope, grains;

  Everything() {
    cloth = world.add_cloth(grid(6, 5, 1.0), {}, at(0, 1, 0));
    world.pin(cloth, vertices({0, 5}));
    balloon = world.add_cloth(sphere(2, 0.3), {.stretch = StretchModel::membrane}, at(3, 1, 0));
    world.set_enclosed_volume(balloon, 1.1f);
    lump = world.add_soft_body(sphere(2, 0.3), {}, {.cells = 60}, at(6, 0.4, 0));
    box = world.add_soft_body(tet_bar(2, 2, 2, {0.4, 0.4, 0.4}), {.model = SoftBodyModel::shape_matching},
                              at(9, 0.15, 0));
    rope = world.add_rope(std::vector<Vec3d>{{12, 1, 0}, {13, 1, 0}}, 8, {.bending_stiffness = 0.01f});
    const Vec3d centers[] = {{15, 0.05, 0}, {15.02, 0.12, 0}, {15.1, 0.05, 0}};
    grains = world.add_grains(centers, {.radius = 0.05f});
    world.attach(rope, vertices({0}));
    const std::pair<VertexRef, VertexRef> tie[] = {{{rope, 8}, {cloth, 3}}};
    world.connect(tie, 5.0f);
    world.add_tethers(cloth);
    auto custom = std::make_unique<CustomProjector>();
    custom->add(std::make_shared<CallbackConstraint>(
        std::vector<std::uint32_t>{world.particle(cloth, 7), world.particle(cloth, 8)},
        [](std::span<const Vec3f>, std::span<Vec3f>) { return 0.25f; }));
    world.add_projector(std::move(custom));
    world.add_collider(Plane{});
  }
};

TEST(DebugDraw, HandsOutEveryConstraintOfTheReport) {
  Everything e;
  const StepReport& report = e.world.step(1.0 / 60);
  std::map<std::string, std::size_t> expected;
  for (const KindReport& kind : report.kinds) expected[std::string(kind.kind)] += kind.count;
  const Drawn drawn(e.world);
  EXPECT_EQ(drawn.counts(), expected);
  for (const char* kind : {"distance", "isometric_bending", "triangle_membrane", "neo_hookean",
                           "shape_matching", "enclosed_volume", "rope_bending", "attachment", "tether",
                           "custom", "collider contact", "particle contact"})
    EXPECT_TRUE(expected.count(kind)) << kind;
  // The largest residual equals that of the report.
  for (const KindReport& kind : report.kinds) {
    double largest = 0;
    for (const auto& c : drawn.constraints)
      if (c.kind == kind.kind) largest = std::max(largest, static_cast<double>(c.residual));
    double reported = 0;
    for (const KindReport& same : report.kinds)
      if (same.kind == kind.kind) reported = std::max(reported, same.largest);
    EXPECT_NEAR(largest, reported, 1e-6 * reported) << kind.kind;
  }
}

TEST(DebugDraw, ConstraintsOfOneKindAndColorShareNoParticle) {
  Everything e;
  e.world.step(1.0 / 60);
  // Kinds are contiguous, once per projector; two projectors are distances: the objects' and the joints'.
  std::set<std::array<float, 3>> seen;
  std::string kind;
  int color = -1;
  for (const auto& c : Drawn(e.world).constraints) {
    if (c.kind == "particle contact") continue;
    if (c.kind != kind || c.color != color) seen.clear();
    kind = c.kind, color = c.color;
    for (const Vec3f& x : c.points) EXPECT_TRUE(seen.insert({x.x, x.y, x.z}).second) << kind << ' ' << color;
  }
}

TEST(DebugDraw, StrainAndResidualAreThoseOfTheShape) {
  World world;
  const ObjectId rope = world.add_rope(std::vector<Vec3d>{{1000, 0, 0}, {1001, 0, 0}}, 1);
  world.set_positions(rope, std::vector<Vec3f>{{1000, 0, 0}, {1001.05f, 0, 0}});
  const Drawn drawn(world);
  ASSERT_EQ(drawn.constraints.size(), 1u);
  EXPECT_EQ(drawn.constraints[0].kind, "distance");
  EXPECT_NEAR(drawn.constraints[0].strain, 0.05, 1e-4);  // floats have a resolution of 6e-5 m here
  EXPECT_NEAR(drawn.constraints[0].residual, 0.05, 1e-4);
  ASSERT_EQ(drawn.constraints[0].points.size(), 2u);
  EXPECT_EQ(drawn.constraints[0].points[1].x + drawn.constraints[0].points[0].x, 2001.05f);
}

TEST(DebugDraw, AnInequalityHasAResidualWhereItIsViolated) {
  World world;
  const ObjectId cloth = world.add_cloth(grid(2, 2, 1.0));
  world.pin(cloth, vertices({0}));
  world.add_tethers(cloth, 0.5f);
  const auto largest = [&] {
    float result = 0;
    for (const auto& c : Drawn(world).constraints) {
      if (c.kind == "tether") result = std::max(result, c.residual);
    }
    return result;
  };
  EXPECT_EQ(largest(), 0);
  std::vector<Vec3f> x(world.positions(cloth).begin(), world.positions(cloth).end());
  x[1].x += 1;  // 2 m from the pin, with a tether of 1.5 m
  world.set_positions(cloth, x);
  EXPECT_NEAR(largest(), 0.5, 1e-6);
}

TEST(DebugDraw, EachEdgeOfATetMeshOnce) {
  World world;
  const TetMesh mesh = tet_bar(3, 2, 2, {1, 1, 1});
  world.add_soft_body(mesh);
  using Edge = std::pair<std::array<float, 3>, std::array<float, 3>>;
  const auto edge = [](const Vec3f& a, const Vec3f& b) {
    const std::array<float, 3> first{a.x, a.y, a.z}, second{b.x, b.y, b.z};
    return first < second ? Edge{first, second} : Edge{second, first};
  };
  std::set<Edge> expected;
  for (const Tet& tet : mesh.tets)
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b)
        expected.insert(edge(Vec3f(mesh.positions[tet[a]]), Vec3f(mesh.positions[tet[b]])));
  std::multiset<Edge> drawn;
  for (const auto& [a, b] : Drawn(world).edges) drawn.insert(edge(a, b));
  EXPECT_EQ(std::vector<Edge>(drawn.begin(), drawn.end()),
            std::vector<Edge>(expected.begin(), expected.end()));
}

TEST(DebugDraw, ParticlesSayWhatTheyAre) {
  Everything e;
  const Drawn drawn(e.world);
  std::map<std::uint32_t, std::size_t> pinned, count;
  for (const DebugParticle& p : drawn.particles) {
    ++count[p.object];
    if (p.pinned) ++pinned[p.object];
    EXPECT_EQ(p.pinned, p.inverse_mass == 0);
    if (p.object == e.grains.value) {
      EXPECT_EQ(p.radius, 0.05f);
    }
  }
  EXPECT_EQ(pinned, (std::map<std::uint32_t, std::size_t>{{e.cloth.value, 2}}));
  EXPECT_EQ(count[e.cloth.value], 30u);
  EXPECT_EQ(count[e.rope.value], 9u);
  EXPECT_EQ(count.size(), 6u);
}

TEST(DebugDraw, ContactsAreThoseOfTheLastStep) {
  World world;
  world.add_grains(std::vector<Vec3d>{{0, 0.05, 0}, {1, 0.05, 0}, {2, 5, 0}}, {.radius = 0.05f});
  const ColliderId floor = world.add_collider(Plane{});
  world.step(1.0 / 60);
  const Drawn drawn(world);
  ASSERT_EQ(drawn.contacts.size(), 2u);
  for (const DebugContact& contact : drawn.contacts) {
    EXPECT_NEAR(contact.point.y, 0, 1e-5);
    EXPECT_EQ(contact.normal, Vec3f(0, 1, 0));
    EXPECT_GT(contact.impulse, 0);
  }
  // A collider or object of a contact may have been removed.
  world.remove(floor);
  EXPECT_TRUE(Drawn(world).contacts.empty());
  EXPECT_TRUE(world.contacts().empty());
  EXPECT_EQ(Drawn(world).counts()["collider contact"], 0u);
}

TEST(DebugDraw, ContactsAreForgottenWithTheirObject) {
  World world;
  const ObjectId first = world.add_grains(std::vector<Vec3d>{{0, 0.05, 0}}, {.radius = 0.05f});
  world.add_collider(Plane{});
  world.step(1.0 / 60);
  const Snapshot snapshot = world.snapshot();
  EXPECT_EQ(world.contacts().size(), 1u);
  world.restore(snapshot);
  EXPECT_TRUE(world.contacts().empty());
  world.step(1.0 / 60);
  EXPECT_EQ(world.contacts().size(), 1u);
  world.remove(first);
  EXPECT_TRUE(world.contacts().empty());
  EXPECT_TRUE(Drawn(world).constraints.empty());
  EXPECT_EQ(world.elastic_energy(), 0);
}

TEST(DebugDraw, ContactsAskedForDuringAStepAreNotThoseAfterIt) {
  World world({.substeps = 2});
  world.add_grains(std::vector<Vec3d>{{0, 0.05, 0}}, {.radius = 0.05f});
  world.add_collider(Plane{});
  // No contact has applied a correction yet.
  world.before(Stage::solve, [](World& w) { (void)w.contacts(); });
  world.step(1.0 / 60);
  EXPECT_EQ(world.contacts().size(), 1u);
}

TEST(DebugDraw, LookingChangesNothing) {
  Everything seen, unseen;
  for (int frame = 0; frame < 5; ++frame) {
    seen.world.step(1.0 / 60);
    unseen.world.step(1.0 / 60);
    const std::uint64_t hash = seen.world.hash();
    const Snapshot before = seen.world.snapshot();
    (void)Drawn(seen.world);
    seen.world.debug_draw({});  // without callbacks
    EXPECT_EQ(seen.world.hash(), hash);
    EXPECT_EQ(seen.world.snapshot().bytes, before.bytes);
    EXPECT_EQ(seen.world.hash(), unseen.world.hash());
  }
}

TEST(DebugDraw, WorksInACallbackAndInAnEmptyWorld) {
  World empty;
  const Drawn nothing(empty);
  EXPECT_TRUE(nothing.constraints.empty() && nothing.particles.empty() && nothing.edges.empty());
  Everything e;
  std::size_t constraints = 0;
  e.world.after(Stage::solve, [&](World& w) { constraints = Drawn(w).constraints.size(); });
  EXPECT_TRUE(e.world.step(1.0 / 60).ok());
  EXPECT_GT(constraints, 100u);
}

}  // namespace souple::test_world_debug_draw
