#include "tests/radium/radium.h"

namespace souple::radium::test_radium_grab {

using host::Handle;
using host::Kind;
using Ra::Core::Ray;

const Vector3 down(0, -1, 0);

Ray above(const Vector3& point) {
  return {point + Vector3(0, 2, 0), down};
}
Vector3 vector(const Vec3f& v) {
  return {v.x, v.y, v.z};
}

TEST_F(Radium, APickedVertexOfASoupIsDraggedAndLetGo) {
  const Index index = show("sheet", sheet(3, 1));
  system->add(index, Kind::cloth);
  session().set_gravity(0, 0, 0);
  system->play();
  frames(2);
  const Vector3 vertex = world_vertex(index, 17), goal = vertex + Vector3(0.3f, 0, 0.2f);
  ASSERT_TRUE(system->grab({index, 5, 2}, above(vertex), down));
  EXPECT_LT((vector(session().grabbed_point()) - vertex).norm(), 1e-6f);
  system->drag(above(goal));
  frames(120);
  EXPECT_LT((vector(session().grabbed_point()) - goal).norm(), 0.05f);
  EXPECT_LT((world_vertex(index, 17) - goal).norm(), 0.15f);  // a hand holds those around it as well
  system->release();
  EXPECT_FALSE(session().grabbing());
  system->drag(above(vertex));
  frames(60);
  EXPECT_GT((world_vertex(index, 17) - vertex).norm(), 0.2f);
}

TEST_F(Radium, APickedVertexOfATurnedEntityIsTheOneUnderTheMouse) {
  Transform turned = Transform::Identity();
  turned.translate(Vector3(1, 2, 3)).rotate(Ra::Core::AngleAxis(0.7f, Vector3::UnitY())).scale(2.0f);
  const Index index = show("sheet", sheet(3, 1), turned);
  system->add(index, Kind::cloth);
  const Vector3 vertex = world_vertex(index, 17);
  ASSERT_TRUE(system->grab({index, 5, 2}, above(vertex), down));
  EXPECT_LT((vector(session().grabbed_point()) - vertex).norm(), 1e-5f);
}

TEST_F(Radium, APickedVertexOfAQuadAndOfAPolygonIsThatOfItsTriangle) {
  const std::vector<Vector3> ring = {{0, 0, 0}, {0, 0, 2}, {1, 0, 3}, {2, 0, 2}, {2, 0, 0}};
  const Index quad = show_quads("quad", ring, {{0, 1, 3, 4}, {1, 2, 3, 3}}),
              five = show_polygons("five", ring, {{0, 1, 2, 3, 4}});
  const auto picked = [&](const Index& index, int triangle, int corner) {
    EXPECT_TRUE(system->grab({index, triangle, corner}, above({1, 0, 1}), down));
    return vector(session().grabbed_point());
  };
  system->add(five, Kind::cloth);
  EXPECT_EQ(picked(five, 0, 0), ring[4]);
  EXPECT_EQ(picked(five, 1, 1), ring[1]);
  EXPECT_EQ(picked(five, 2, 2), ring[2]);
  system->add(quad, Kind::cloth);
  EXPECT_EQ(picked(quad, 0, 2), ring[3]);
  EXPECT_EQ(picked(quad, 1, 2), ring[4]);
}

/// Both sides of a cloth are there to be picked, and both hold the same vertex.
TEST_F(Radium, APickedVertexOfEitherSideOfAScenesClothIsTheCloths) {
  system->open_scene(scenes + "tablecloth.json");
  const Handle cloth = session().objects().front().handle;
  const Index index = shown("tablecloth");
  const std::vector<std::uint32_t> own = session().triangles(cloth), drawn = mesh(index).triangles();
  ASSERT_GT(drawn.size(), 2 * own.size());
  std::vector<float> x(3 * session().object(cloth).vertex_count);
  session().write(cloth, {x.data()}, x.size() / 3);
  const int last = static_cast<int>(2 * own.size() / 3) - 1;  // of the sides; then comes the rim
  for (const int triangle : {0, 700, last / 2, last / 2 + 1, last - 700, last}) {
    for (const int corner : {0, 1, 2}) {
      const std::size_t at = drawn[static_cast<std::size_t>(3 * triangle + corner)];
      const Vector3 seen = world_vertex(index, at);
      ASSERT_TRUE(system->grab({index, triangle, corner}, above(seen), down));
      const Vector3 held = vector(session().grabbed_point());
      const float half = session().object(cloth).radius;
      EXPECT_NEAR((held - seen).norm(), half, 1e-5f);  // the side lies half the thickness away
      const std::size_t vertex = at % (x.size() / 3);
      EXPECT_EQ(held, Vector3(x[3 * vertex], x[3 * vertex + 1], x[3 * vertex + 2]));
    }
  }
}

TEST_F(Radium, APickedSplatIsAGrainOrTheNearestVertexOfARope) {
  system->open_scene(scenes + "one_room.json");
  const Index sand = shown("sand"), rope = shown("line");
  const Vector3 grain = world_vertex(sand, 17);
  ASSERT_TRUE(system->grab({sand, 17, 0}, above(grain), down));
  EXPECT_EQ(vector(session().grabbed_point()), grain);
  EXPECT_FALSE(system->grab({sand, 343, 0}, above(grain), down));
  EXPECT_FALSE(system->grab({sand, 17, 1}, above(grain), down));
  const int last = static_cast<int>(mesh(rope).vertex_count()) - 1;
  const Vector3 ball = world_vertex(rope, static_cast<std::size_t>(last));
  ASSERT_TRUE(system->grab({rope, last, 0}, above(ball), down));
  EXPECT_LT((vector(session().grabbed_point()) - ball).norm(), 0.5f * 1.23f / 30);  // half a segment
}

TEST_F(Radium, APickedVertexIsPinnedAndLetGo) {
  const Index index = show("sheet", sheet(3, 1));
  system->add(index, Kind::cloth);
  EXPECT_FALSE(system->set_pinned({index, 18, 0}, true));
  ASSERT_TRUE(system->set_pinned({index, 5, 2}, true));
  system->play();
  frames(20);
  EXPECT_EQ(world_vertex(index, 17).y(), 0);
  EXPECT_LT(world_vertex(index, 0).y(), -0.1f);
  EXPECT_FALSE(system->grab({index, 5, 2}, above(world_vertex(index, 17)), down));
  ASSERT_TRUE(system->set_pinned({index, 5, 2}, false));
  frames(20);
  EXPECT_LT(world_vertex(index, 17).y(), -0.1f);
}

TEST_F(Radium, ARayTakesWhateverItMeetsFirst) {
  const Index low = show("low", sheet(4, 1));
  Transform up = Transform::Identity();
  up.translate(Vector3(0, 1, 0));
  const Index high = show("high", sheet(4, 1), up);
  system->add(low, Kind::cloth);
  system->add(high, Kind::cloth);
  ASSERT_TRUE(system->grab({{0.1f, 3, 0.1f}, down}, down));
  EXPECT_NEAR(session().grabbed_point().y, 1, 1e-5f);
  ASSERT_TRUE(system->grab({{0.1f, -3, 0.1f}, -down}, -down));  // from behind
  EXPECT_NEAR(session().grabbed_point().y, 0, 1e-5f);
  EXPECT_FALSE(system->grab({{9, 3, 9}, down}, down));
}

TEST_F(Radium, WhatIsNoVertexOfAnObjectIsNotGrabbed) {
  const Index index = show("sheet", sheet(3, 1)), other = show("other", sheet(3, 1)),
              obstacle = show("obstacle", box({1, 1, 1}));
  system->add(index, Kind::cloth);
  system->add(obstacle, Kind::obstacle);
  const Ray ray = above({0, 0, 0});
  EXPECT_FALSE(system->grab({}, ray, down));
  EXPECT_FALSE(system->grab({other, 0, 0}, ray, down));
  EXPECT_FALSE(system->grab({obstacle, 0, 0}, ray, down));
  EXPECT_FALSE(system->grab({index, -1, 0}, ray, down));
  EXPECT_FALSE(system->grab({index, 0, 3}, ray, down));
  EXPECT_FALSE(system->grab({index, 18, 0}, ray, down));
  EXPECT_FALSE(session().grabbing());
  system->drag(ray);
  system->release();
  frames(2);
  EXPECT_EQ(words(), "");
}

}  // namespace souple::radium::test_radium_grab
