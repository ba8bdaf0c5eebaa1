#include "tests/expect_error.h"
#include "tests/radium/radium.h"

#include <Core/Geometry/StandardAttribNames.hpp>
#include <Engine/Data/BlinnPhongMaterial.hpp>
#include <Engine/Data/Mesh.hpp>
#include <Engine/Rendering/RenderObject.hpp>
#include <Engine/Rendering/RenderObjectManager.hpp>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <souple/host/drawable.h>

namespace souple::radium::test_radium_scene {

using host::Drawable;

class Scene : public Radium {
 protected:
  std::size_t entity_count() const { return engine->getEntityManager()->getEntities().size(); }
};

TEST_F(Scene, ItsObjectsAndCollidersAreEntities) {
  const std::size_t before = entity_count();
  system->open_scene(scenes + "one_room.json");
  for (const char* name : {"flag", "tablecloth", "duck", "block", "line", "sand", "floor", "table", "roller"})
    ASSERT_TRUE(engine->getEntityManager()->entityExists(name)) << name;
  EXPECT_EQ(entity_count(), before + 9);
  EXPECT_TRUE(system->loaded_meshes().empty());  // none is to be added again
  EXPECT_EQ(mesh(shown("sand")).triangle_count(), 0u);
  EXPECT_EQ(mesh(shown("sand")).vertex_count(), 343u);
  EXPECT_EQ(mesh(shown("flag")).vertex_count(), 2u * 24 * 16 + 4 * 2 * (23 + 15));  // two sides, a rim
  EXPECT_NE(system->object_of(shown("duck")), 0u);
  EXPECT_EQ(system->object_of(shown("table")), 0u);
  EXPECT_NEAR(bounding_box(shown("table")).max().y(), 0.6f, 1e-5f);
}

TEST_F(Scene, ItsColorsAreLinearLight) {
  system->open_scene(scenes + "one_room.json");
  const auto object = engine->getRenderObjectManager()->getRenderObject(shown("duck"));
  const auto* material = dynamic_cast<Ra::Engine::Data::BlinnPhongMaterial*>(object->getMaterial().get());
  ASSERT_NE(material, nullptr);
  const float linear[] = {0.888f, 0.539f, 0.0296f};  // of #f2c230
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(material->m_kd[i], linear[i], 0.001f);
}

/// Splats are discs without shading: of one color they would be a blot.
TEST_F(Scene, NeighboringGrainsDifferInColor) {
  system->open_scene(scenes + "sand_pile.json");
  const auto object = engine->getRenderObjectManager()->getRenderObject(shown("sand"));
  auto* displayed = dynamic_cast<Ra::Engine::Data::AttribArrayDisplayable*>(object->getMesh().get());
  const auto name = Ra::Core::Geometry::getAttribName(Ra::Core::Geometry::MeshAttrib::VERTEX_COLOR);
  const auto& geometry = displayed->getAttribArrayGeometry();
  const auto& colors = geometry.getAttrib(geometry.getAttribHandle<Ra::Core::Vector4>(name)).data();
  ASSERT_EQ(colors.size(), 1331u);
  int other = 0;
  for (std::size_t i = 1; i < colors.size(); ++i)
    other += std::abs(colors[i].x() - colors[i - 1].x()) > 0.02f ? 1 : 0;
  EXPECT_GT(other, 1000);
  const auto* material = dynamic_cast<Ra::Engine::Data::BlinnPhongMaterial*>(object->getMaterial().get());
  EXPECT_TRUE(material->m_perVertexColor);
}

/// The adapter gives the bits of a session, which has those of the library alone.
TEST_F(Scene, RadiumShowsWhatASessionWithoutRadiumDraws) {
  system->open_scene(scenes + "one_room.json");
  host::Session alone;
  alone.open_scene(scenes + "one_room.json");
  first_frame();
  system->play();
  frames(30);
  for (int frame = 1; frame <= 30; ++frame) alone.advance(frame, double{frame_time});
  EXPECT_EQ(session().hash(), alone.hash());
  // A gust may stretch the worst link of the flag by more than 10 %; there is nothing else to say.
  const std::string said = words();
  EXPECT_EQ(said.find("contact"), std::string::npos) << said;
  EXPECT_EQ(said.find("non-finite"), std::string::npos) << said;
  for (const host::ObjectInfo& info : alone.objects()) {
    Drawable drawable(alone, info.handle, Drawable::Sides::two);
    drawable.update(alone);
    EXPECT_EQ(mesh(shown(info.name)).positions(), drawable.positions()) << info.name;
    if (!drawable.balls()) {
      EXPECT_EQ(mesh(shown(info.name)).normals(), drawable.normals());
    }
  }
}

TEST_F(Scene, AColliderThatMovesIsShownWhereItIs) {
  system->open_scene(scenes + "one_room.json");
  const Vector3 before = bounding_box(shown("roller")).center();
  first_frame();
  system->play();
  frames(100);
  const Vector3 after = bounding_box(shown("roller")).center();
  EXPECT_GT((after - before).norm(), 0.3f);
  const std::vector<host::ColliderShape> shapes = session().colliders();
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const std::array<float, 16> transform = mesh(shown(shapes[i].name)).transform();
    EXPECT_EQ(transform, session().collider_transforms()[i]) << shapes[i].name;
  }
}

TEST_F(Scene, AnotherOneTakesItsPlace) {
  const std::size_t before = entity_count();
  system->open_scene(scenes + "one_room.json");
  system->play();
  frames(3);
  system->open_scene(scenes + "sand_pile.json");
  EXPECT_EQ(entity_count(), before + 2);
  EXPECT_EQ(steps(), 0u);
  EXPECT_FALSE(engine->getEntityManager()->entityExists("duck"));
  frames(5);
  EXPECT_EQ(steps(), 5u);
  system->clear();
  EXPECT_EQ(entity_count(), before);
  frames(2);
  EXPECT_EQ(words(), "");
}

TEST_F(Scene, MeshesOfRadiumJoinAScene) {
  system->open_scene(scenes + "tablecloth.json");
  Transform above = Transform::Identity();
  above.translate(Vector3(0, 1.3f, 0));
  const Index ball = show("box", box({0.1f, 0.1f, 0.1f}), above);
  const host::Handle body = system->add(ball, host::Kind::soft_body);
  system->play();
  frames(60);
  EXPECT_GT(world_vertex(ball, 0).y(), 0.7f);  // it lies on the table
  EXPECT_LT(world_vertex(ball, 0).y(), 1.1f);
  const std::vector<LoadedMesh> list = system->loaded_meshes();
  ASSERT_EQ(list.size(), 1u);
  EXPECT_EQ(list[0].object, body);
}

TEST_F(Scene, OneThatCannotBeOpenedLeavesAllAsItWas) {
  system->open_scene(scenes + "tablecloth.json");
  const Index index = show("sheet", sheet(3, 1));
  system->add(index, host::Kind::cloth);
  system->play();
  frames(5);
  const std::uint64_t hash = session().hash();
  const std::size_t entities = entity_count();
  const std::vector<float> vertices = mesh(index).positions();
  const std::string bad = testing::TempDir() + "radium_bad_scene.json";
  std::ofstream(bad) << R"({"souple": 1, "objects": [{"name": "a", "kind": "clth"}]})";
  expect_error([&] { system->open_scene(scenes + "none.json"); }, {"none.json"});
  expect_error([&] { system->open_scene(bad); }, {"radium_bad_scene.json", "clth"});
  EXPECT_EQ(session().hash(), hash);
  EXPECT_EQ(entity_count(), entities);
  EXPECT_EQ(mesh(index).positions(), vertices);
  EXPECT_TRUE(system->playing());
  frames(3);
  EXPECT_EQ(steps(), 8u);
  EXPECT_EQ(words(), "");
}

/// Radium renames an entity whose name is taken.
TEST_F(Scene, AnEntityOfTheSameNameIsLeftAlone) {
  const Index index = show("tablecloth", sheet(2, 1));
  const std::vector<float> vertices = mesh(index).positions();
  system->open_scene(scenes + "tablecloth.json");
  system->play();
  frames(3);
  EXPECT_EQ(mesh(index).positions(), vertices);
  EXPECT_TRUE(engine->getEntityManager()->entityExists("tablecloth_1"));
  system->clear();
  EXPECT_TRUE(mesh(index).alive());
  EXPECT_FALSE(engine->getEntityManager()->entityExists("tablecloth_1"));
}

}  // namespace souple::radium::test_radium_scene
