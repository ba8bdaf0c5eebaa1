#include "souple/souple.h"
#include "tests/expect_error.h"
#include "tests/host/player.h"

#include <algorithm>

#include <gtest/gtest.h>

// Rigid bodies of a host program.

namespace souple::host::test_host_session_rigid_bodies {

TEST(SessionRigidBodies, MoveAsInAPureRunToTheBit) {
  const Corners crate(box({0.3, 0.2, 0.3}, {2, 2, 2}));
  const At above(0.125f, 0.5f, 0);
  Player host;
  MeshOptions options;
  options.transform = above;
  const Handle body = host.session.add_rigid_body(crate.soup(), options);
  host.session.add_plane();
  EXPECT_EQ(host.session.object(body).kind, Kind::rigid_body);
  EXPECT_STREQ(kind_name(Kind::rigid_body), "rigid_body");
  host.play(60);

  World world;
  TriangleMesh placed = VertexWelder(crate.soup()).mesh();
  for (Vec3d& x : placed.positions) x += Vec3d(0.125, 0.5, 0);
  const ObjectId pure = world.add_rigid_body(placed);
  world.add_collider(Plane{});
  for (int i = 0; i < 60; ++i) ASSERT_TRUE(world.step(dt).ok());
  EXPECT_EQ(host.session.hash(), world.hash());
  EXPECT_NEAR(world.rigid_body(pure).pose.translation.y, 0.1, 2e-3);
  EXPECT_GT(host.session.statistics().contacts, 0u);
  const std::vector<float> x = drawn(host.session, body);
  const VertexWelder weld(crate.soup());
  for (std::size_t v = 0; v < crate.count(); ++v)
    EXPECT_EQ(vertex(x, v),
              Vec3f(Vec3d(world.positions(pure)[weld.particle_of()[v]]) - Vec3d(0.125, 0.5, 0)));
}

TEST(SessionRigidBodies, AreGrabbedAndReset) {
  Player host;
  const Corners crate(box({0.3, 0.3, 0.3}, {1, 1, 1}));
  const Handle body = host.session.add_rigid_body(crate.soup());
  host.session.set_gravity(0, 0, 0);
  const std::vector<float> before = drawn(host.session, body);
  ASSERT_TRUE(host.session.grab_vertex(body, 0, {{0, 0, 5}, {0, 0, -1}}));
  host.session.drag({{1, 1, 5}, {0, 0, -1}});
  host.play(30);
  EXPECT_GT(vertex(drawn(host.session, body), 0).x, vertex(before, 0).x + 0.2f);
  host.session.release();
  host.session.reset();
  EXPECT_EQ(drawn(host.session, body), before);
}

TEST(SessionRigidBodies, HaveTunablesAndRefusePinsInWords) {
  Player host;
  const Corners crate(box({0.3, 0.3, 0.3}, {1, 1, 1}));
  const Handle body = host.session.add_rigid_body(crate.soup());
  const std::vector<Parameter> parameters = host.session.parameters(body);
  EXPECT_TRUE(std::any_of(parameters.begin(), parameters.end(),
                          [](const Parameter& p) { return p.name == "friction"; }));
  host.session.set_parameter(body, "friction", 0.25);
  EXPECT_TRUE(host.session.presets(body).empty());
  expect_error([&] { host.session.set_pinned(body, 0, true); }, {"rigid body"});
}

}  // namespace souple::host::test_host_session_rigid_bodies
