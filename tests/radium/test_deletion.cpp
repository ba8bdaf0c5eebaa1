#include "tests/radium/radium.h"

#include <functional>

namespace souple::radium::test_radium_deletion {

using host::Handle;
using host::Kind;

/// A part of a mesh that a user can delete in Radium's tree.
struct Deletion {
  const char* name;
  std::function<void(Ra::Engine::RadiumEngine&, const RenderMesh&, Ra::Engine::Scene::Component&)> run;
};

const Deletion deletions[] = {
    {"RenderObject",
     [](auto&, const RenderMesh& mesh, auto& component) { component.removeRenderObject(mesh.index()); }},
    {"Component", [](auto&, const RenderMesh& mesh,
                     auto& component) { mesh.entity().removeComponent(component.getName()); }},
    {"Mark",
     [](auto&, const RenderMesh& mesh, auto&) {
       Entity& entity = mesh.entity();
       entity.removeComponent(entity.getComponents().back()->getName());
     }},
    {"Entity", [](auto& engine, const RenderMesh& mesh,
                  auto&) { engine.getEntityManager()->removeEntity(&mesh.entity()); }},
};

class DeletedInRadium : public Radium, public testing::WithParamInterface<Deletion> {
 protected:
  void remove_in_radium(const Index& index) { GetParam().run(*engine, mesh(index), component(index)); }
};

TEST_P(DeletedInRadium, ALoadedMeshLeavesTheWorldInWords) {
  const Index index = show("sheet", sheet(3, 1)), other = show("other", sheet(3, 1));
  const Handle cloth = system->add(index, Kind::cloth), kept = system->add(other, Kind::cloth);
  system->play();
  frames(5);
  remove_in_radium(index);
  frames(5);
  EXPECT_EQ(words(), "sheet mesh was deleted in Radium: it has left the world");
  EXPECT_FALSE(session().contains(cloth));
  EXPECT_TRUE(session().contains(kept));
  EXPECT_EQ(steps(), 10u);
  const float y = world_vertex(other, 0).y();
  frames(5);
  EXPECT_LT(world_vertex(other, 0).y(), y);
  system->reset();
  frames(2);
  EXPECT_EQ(session().objects().size(), 1u);
  EXPECT_EQ(words(), "");
}

// Who knows the session can take an object out past the system: its mesh is Radium's again.
TEST_F(Radium, WhatLeftTheSessionIsForgottenInSilence) {
  const Index index = show("sheet", sheet(3, 1));
  const std::vector<float> first = mesh(index).positions();
  const Handle cloth = system->add(index, Kind::cloth);
  system->play();
  frames(5);
  EXPECT_NE(mesh(index).positions(), first);
  session().remove(cloth);
  frames(5);
  EXPECT_EQ(words(), "");
  EXPECT_EQ(system->object_of(index), 0u);
  EXPECT_EQ(mesh(index).positions(), first);
  EXPECT_NE(system->add(index, Kind::cloth), 0u);
}

TEST_P(DeletedInRadium, WhatIsHeldIsLetGo) {
  const Index index = show("sheet", sheet(3, 1));
  system->add(index, Kind::cloth);
  system->play();
  frames(2);
  const Ra::Core::Ray ray({0, 2, 0}, {0, -1, 0}), aside({0.5f, 2, 0}, {0, -1, 0});
  ASSERT_TRUE(system->grab({index, 4, 1}, ray, {0, -1, 0}));
  system->drag(aside);
  frames(2);
  remove_in_radium(index);
  system->drag(ray);
  frames(1);
  EXPECT_FALSE(session().grabbing());
  system->drag(aside);
  system->release();
  frames(3);
  EXPECT_EQ(words(), "sheet mesh was deleted in Radium: it has left the world");
}

TEST_P(DeletedInRadium, ASceneLosesAnObject) {
  system->open_scene(scenes + "one_room.json");
  system->play();
  frames(3);
  const std::size_t objects = session().objects().size();
  for (const char* name : {"sand", "flag", "block"})  // the block hangs on a rope
    remove_in_radium(shown(name));
  frames(3);
  EXPECT_EQ(session().objects().size(), objects - 3);
  EXPECT_EQ(steps(), 6u);
  const std::string said = words();
  for (const char* name : {"sand", "flag", "block"})
    EXPECT_NE(said.find(std::string(name) + " was deleted in Radium"), std::string::npos) << said;
  system->clear();
  frames(2);
  EXPECT_EQ(words(), "");
}

TEST_P(DeletedInRadium, NothingElseIsTakenForIt) {
  const Index index = show("sheet", sheet(3, 1));
  const Handle cloth = system->add(index, Kind::cloth);
  first_frame();
  remove_in_radium(index);
  const Index other = show("other", sheet(3, 1));  // it may have the same number
  EXPECT_EQ(system->object_of(other), 0u);
  const Handle now = system->add(other, Kind::cloth);
  system->play();
  frames(5);
  EXPECT_FALSE(session().contains(cloth));
  EXPECT_EQ(system->object_of(other), now);
  EXPECT_LT(world_vertex(other, 0).y(), 0);
}

TEST_P(DeletedInRadium, TheUserMayRemoveItBeforeTheNextFrame) {
  const Index index = show("sheet", sheet(3, 1)), other = show("other", sheet(3, 1));
  const Handle cloth = system->add(index, Kind::cloth);
  system->add(other, Kind::cloth);
  system->play();
  frames(2);
  remove_in_radium(index);
  system->remove(cloth);
  frames(2);
  EXPECT_EQ(words(), "");

  remove_in_radium(other);
  system->clear();
  frames(2);
  EXPECT_EQ(words(), "");
}

TEST_P(DeletedInRadium, AColliderOfASceneGoesOnUnseen) {
  system->open_scene(scenes + "one_room.json");
  system->play();
  frames(2);
  if (GetParam().name != std::string("Mark")) remove_in_radium(shown("roller"));  // a collider has none
  frames(3);
  EXPECT_EQ(steps(), 5u);
  EXPECT_EQ(words(), "");
}

INSTANTIATE_TEST_SUITE_P(, DeletedInRadium, testing::ValuesIn(deletions),
                         [](const auto& test) { return std::string(test.param.name); });

// --- all at once

TEST_F(Radium, EmptyingRadiumsSceneEmptiesTheWorld) {
  system->open_scene(scenes + "tablecloth.json");
  system->add(show("sheet", sheet(3, 1)), Kind::cloth);
  system->play();
  frames(2);
  engine->getEntityManager()->deleteEntities();
  frames(2);
  EXPECT_TRUE(session().objects().empty());
  EXPECT_NE(words().find("tablecloth was deleted in Radium"), std::string::npos);
}

TEST_F(Radium, ItIsClosedWhileItRuns) {
  system->open_scene(scenes + "one_room.json");
  const Index index = show("sheet", sheet(3, 1));
  system->add(index, Kind::cloth);
  system->play();
  frames(3);
  ASSERT_TRUE(system->grab({index, 4, 1}, {{0, 2, 0}, {0, -1, 0}}, {0, -1, 0}));
  frames(1);
  close();
}

TEST_F(Radium, ItIsClosedRightAfterADeletion) {
  const Index index = show("sheet", sheet(3, 1));
  system->add(index, Kind::cloth);
  system->play();
  frames(3);
  engine->getEntityManager()->removeEntity(&mesh(index).entity());
  close();
}

}  // namespace souple::radium::test_radium_deletion
