#pragma once

#include "tests/app/offscreen_viewer.h"
#include "tests/paths.h"

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Fixtures that tests of the viewer share.

namespace souple::viewer {

inline constexpr const char* cloth = R"({
  "souple": 1, "description": "A cloth that hangs by its upper edge.", "frame_rate": 60, "substeps": 5,
  "camera": {"from": [0, 1, 4], "to": [0, 1, 0], "fov": 40},
  "objects": [
    {"name": "cloth", "kind": "cloth", "mesh": {"grid": {"columns": 11, "rows": 11, "size": 1}},
     "transform": {"translate": [0, 1, 0], "rotate": [90, 0, 0]},
     "material": {"preset": "cotton", "damping": 1}, "pins": [{"vertices": [0, 5, 10]}]}
  ]
})";

inline constexpr const char* grains = R"({
  "souple": 1, "description": "Grains.",
  "objects": [{"name": "sand", "kind": "grains", "points": [[0, 1, 0], [1, 1, 0]], "material": {"radius": 0.1}}]
})";

// A drag too strong for explicit integration: speeds grow sixteenfold each substep.
inline constexpr const char* exploding = R"({
  "souple": 1, "drag": 10000, "integrator": "explicit_euler",
  "objects": [{"name": "sand", "kind": "grains", "points": [[0, 1, 0], [1, 1, 0]]}],
  "wind": {"velocity": [2, 0, 0]}
})";

/// A folder with the scenes above, for a scene list.
struct TestScenes {
  TestFolder folder;
  std::vector<app::ShippedScene> list{
      {"cloth", folder.write("cloth.json", cloth)},
      {"grains", folder.write("grains.json", grains)},
      {"broken", folder.write("broken.json", "{ \"souple\": 1, \"objets\": [] }")}};
};

/// The tests of a suite share one viewer, whose start takes longer than most tests. Each begins with a rebuilt scene of
/// the cloth.
class View : public ::testing::Test {
 public:
  static void SetUpTestSuite() { shared() = std::make_unique<Shared>(); }
  static void TearDownTestSuite() { shared().reset(); }

 protected:
  struct Shared {
    TestScenes scenes;
    OffscreenViewer view{scenes.list[0].file, {}, scenes.list};
  };
  static std::unique_ptr<Shared>& shared() {
    static std::unique_ptr<Shared> it;
    return it;
  }

  View() { view.begin_again(scenes.list[0].file); }

  TestScenes& scenes = shared()->scenes;
  OffscreenViewer& view = shared()->view;

  Vec3f vertex(std::size_t i) { return world().positions(world().find_object("cloth"))[i]; }
  World& world() { return view.simulation().world(); }
  bool said(const std::string& words) {
    const std::vector<std::string> notices = view.viewer().notices();
    return std::any_of(notices.begin(), notices.end(),
                       [&](const std::string& notice) { return notice.find(words) != std::string::npos; });
  }
  void pause() {
    if (view.viewer().session().playing()) view.type(" ");
  }
  std::vector<std::string> files() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(view.folder().path()))
      names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
  }
};

}  // namespace souple::viewer
