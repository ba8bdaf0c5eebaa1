#include "tests/expect_error.h"
#include "tests/radium/radium.h"

#include <Engine/Scene/SystemDisplay.hpp>
#include <algorithm>
#include <array>
#include <cmath>

namespace souple::radium::test_radium_objects {

using host::Handle;
using host::Kind;

Transform moved(float x, float y, float z) {
  Transform transform = Transform::Identity();
  transform.translate(Vector3(x, y, z));
  return transform;
}

std::vector<float> drawn(host::Session& session, Handle object, bool normals = false) {
  std::vector<float> x(3 * session.object(object).vertex_count), n(x.size());
  session.write(object, {x.data(), n.data()}, x.size() / 3);
  return normals ? n : x;
}

TEST_F(Radium, ATriangleSoupBecomesAClothAndMovesInRadium) {
  const Index index = show("sheet", sheet(4, 1));
  const std::vector<float> before = mesh(index).positions();
  bounding_box(index);
  const Handle cloth = system->add(index, Kind::cloth);
  EXPECT_EQ(session().object(cloth).name, "sheet mesh");
  EXPECT_EQ(session().object(cloth).vertex_count, 96u);
  EXPECT_EQ(system->object_of(index), cloth);
  session().set_pinned(cloth, 0, true);
  system->play();
  frames(40);
  EXPECT_EQ(session().statistics().particles, 25u);  // welded
  const std::vector<float> after = mesh(index).positions();
  EXPECT_EQ(after[1], before[1]);
  EXPECT_LT(after[after.size() - 5], -0.3f);
  for (std::size_t a = 0; a < after.size(); a += 3)  // no seam opens
    for (std::size_t b = 0; b < a; b += 3)
      if (std::equal(&before[a], &before[a] + 3, &before[b])) {
        EXPECT_TRUE(std::equal(&after[a], &after[a] + 3, &after[b]));
      }
  for (std::size_t v = 0; v < after.size(); v += 3)
    EXPECT_TRUE(bounding_box(index).contains(Vector3(after[v], after[v + 1], after[v + 2])));
}

TEST_F(Radium, MeshesAreWhatTheSessionSays) {
  Transform turned = moved(1, 2, 3);
  turned.rotate(Ra::Core::AngleAxis(0.7f, Vector3(1, 2, 2).normalized())).scale(Vector3(1, 0.5f, 2));
  const Index index = show("sheet", sheet(4, 1), turned);
  const Handle cloth = system->add(index, Kind::cloth);
  std::vector<std::pair<Index, Handle>> boxes;
  for (const Kind kind : {Kind::soft_body, Kind::rigid_body}) {
    const Index box_index =
        show("box", box({0.2f, 0.2f, 0.2f}), moved(0, 0, 3.0f * static_cast<float>(boxes.size())));
    boxes.emplace_back(box_index, system->add(box_index, kind));
    EXPECT_EQ(session().object(boxes.back().second).kind, kind);
  }
  session().set_pinned(cloth, 0, true);
  system->play();
  frames(20);
  EXPECT_EQ(mesh(index).positions(), drawn(session(), cloth));
  EXPECT_EQ(mesh(index).normals(), drawn(session(), cloth, true));
  for (const auto& [box_index, body] : boxes) {
    EXPECT_EQ(mesh(box_index).positions(), drawn(session(), body));
    EXPECT_NEAR(world_vertex(box_index, 0).y(), 0.2f - 0.5f * 9.81f / 9, 0.02f);  // a third of a second
  }
}

TEST_F(Radium, AMovedObstacleCarriesWhatLiesOnIt) {
  const Index table = show("table", box({0.5f, 0.1f, 0.5f})),
              index = show("sheet", sheet(5, 0.4f), moved(0, 0.12f, 0));
  system->add(table, Kind::obstacle);
  system->add(index, Kind::cloth);
  system->play();
  frames(40);
  const Vector3 before = world_vertex(index, 75);
  EXPECT_NEAR(before.y(), 0.11f, 0.02f);
  Entity& entity = mesh(table).entity();
  for (int frame = 1; frame <= 60; ++frame) {
    const float way = 0.005f * static_cast<float>(frame);
    entity.setTransform(moved(way, way, 0));
    frames();
  }
  const Vector3 after = world_vertex(index, 75);
  EXPECT_NEAR(after.y() - before.y(), 0.3f, 0.03f);
  EXPECT_GT(after.x() - before.x(), 0.15f);
  EXPECT_EQ(words(), "");
}

TEST_F(Radium, LoadedMeshesAreListed) {
  show_points("points", {{0, 0, 0}});
  const Index a = show("a", sheet(2, 1)), b = show("b", box({1, 1, 1}));
  const Handle cloth = system->add(a, Kind::cloth);
  const std::vector<LoadedMesh> list = system->loaded_meshes();
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].render_object.getValue(), a.getValue());
  EXPECT_EQ(list[0].name, "a mesh");
  EXPECT_EQ(list[0].triangle_count, 8u);
  EXPECT_EQ(list[0].object, cloth);
  EXPECT_EQ(list[1].render_object.getValue(), b.getValue());
  EXPECT_EQ(list[1].object, 0u);
}

TEST_F(Radium, WhatCannotBecomeAnObjectIsRefusedInWords) {
  const Index index = show("sheet", sheet(2, 1)), points = show_points("points", {{0, 0, 0}}),
              gone = show("gone", sheet(2, 1));
  const Handle cloth = system->add(index, Kind::cloth);
  component(gone).removeRenderObject(gone);
  const std::uint64_t hash = session().hash();
  expect_error([&] { system->add(index, Kind::obstacle); }, {"sheet mesh", "in the world already"});
  expect_error([&] { system->add(gone, Kind::cloth); }, {"not a mesh that Radium shows"});
  expect_error([&] { system->add(Index(), Kind::cloth); }, {"not a mesh that Radium shows"});
  expect_error([&] { system->add(points, Kind::cloth); }, {"points mesh", "triangles"});
  const Index open = show("open", sheet(2, 1));
  expect_error([&] { system->add(open, Kind::soft_body); }, {"open mesh"});
  expect_error([&] { system->add(open, Kind::rope); },
               {"open mesh", "a cloth, a soft body, a rigid body or an obstacle"});
  expect_error([&] { system->remove(cloth + 7); }, {"no object"});
  EXPECT_EQ(session().hash(), hash);
  EXPECT_EQ(system->object_of(open), 0u);
  system->play();
  frames(3);
  EXPECT_EQ(steps(), 3u);
  EXPECT_EQ(words(), "");
}

TEST_F(Radium, WhatLeavesTheWorldLiesAsItWasLoaded) {
  const Index a = show("a", sheet(3, 1)), b = show("b", sheet(2, 1), moved(0, 3, 0));
  const std::vector<float> first_a = mesh(a).positions(), first_b = mesh(b).positions(),
                           normals = mesh(a).normals();
  const Handle cloth = system->add(a, Kind::cloth);
  system->add(b, Kind::cloth);
  session().set_pinned(cloth, 0, true);
  system->play();
  frames(10);
  ASSERT_NE(mesh(a).positions(), first_a);
  ASSERT_NE(mesh(a).normals(), normals);
  system->remove(cloth);
  EXPECT_EQ(mesh(a).positions(), first_a);
  EXPECT_EQ(mesh(a).normals(), normals);
  EXPECT_EQ(system->object_of(a), 0u);
  frames(3);
  EXPECT_EQ(mesh(a).positions(), first_a);
  ASSERT_NE(mesh(b).positions(), first_b);

  const Handle again = system->add(a, Kind::cloth);
  EXPECT_NE(again, cloth);
  frames(3);
  EXPECT_NE(mesh(a).positions(), first_a);
  system->clear();
  EXPECT_EQ(mesh(a).positions(), first_a);
  EXPECT_EQ(mesh(b).positions(), first_b);
  EXPECT_TRUE(session().objects().empty());
  EXPECT_EQ(component(a).getEntity()->getComponents().size(), 1u);  // no mark is left
  frames(3);
  EXPECT_EQ(words(), "");
}

TEST_F(Radium, AnObjectHasAMarkInRadiumsTree) {
  const Index index = show("sheet", sheet(2, 1));
  const Handle cloth = system->add(index, Kind::cloth);
  Entity& entity = mesh(index).entity();
  EXPECT_NE(entity.getComponent("Souple sheet mesh"), nullptr);
  EXPECT_EQ(system->getEntityComponents(&entity).size(), 1u);
  system->remove(cloth);
  EXPECT_EQ(entity.getComponent("Souple sheet mesh"), nullptr);
}

TEST_F(Radium, ASecondSystemIsNotAdded) {
  EXPECT_EQ(PhysicsSystem::add_to(*engine), nullptr);
  EXPECT_EQ(engine->getSystem(PhysicsSystem::system_name), system);
  frames(2);
}

}  // namespace souple::radium::test_radium_objects
