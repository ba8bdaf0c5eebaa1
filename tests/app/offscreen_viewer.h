#pragma once

#include "app/view/recording.h"
#include "app/view/simulation.h"
#include "app/view/ui.h"
#include "app/view/view_target.h"
#include "app/view/viewer.h"
#include "render/context.h"
#include "render/image.h"

#include <algorithm>
#include <backends/imgui_impl_opengl3.h>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <imgui.h>
#include <imgui_internal.h>
#include <iterator>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

namespace souple::viewer {

/// A temporary folder, removed at the end.
class TestFolder {
 public:
  TestFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "souple-view-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TestFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, std::string_view text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// A window's size in units of the mouse, and pixels per unit: few, since the processor draws them.
struct WindowSize {
  int width = 1000, height = 2000;
  float scale = 0.2f;
};

/// The viewer with an off-screen window and synthetic mouse and keys. Every frame is checked for OpenGL
/// errors.
class OffscreenViewer {
 public:
  explicit OffscreenViewer(const std::filesystem::path& scene, const WindowSize& size = {},
                           std::vector<app::ShippedScene> shipped = {}, bool half_resolution = false)
      : context_(render::Api::gl33) {
    render::watch_gl_errors();
    ui_ = std::make_unique<Ui>();
    resize(size);
    io().MousePos = {-1, -1};
    // The window's backend maps key codes to ImGui's names.
    io().KeyMap[ImGuiKey_Enter] = 257;
    SceneList scenes(std::move(shipped));
    std::unique_ptr<Session> session = scenes.open(scene);
    viewer_ = std::make_unique<Viewer>(std::move(scenes), std::move(session),
                                       ViewerOptions{folder_.path(), false, half_resolution});
    viewer_->rendering().shadows = viewer_->rendering().ambient_occlusion = false;  // costly on a processor
  }

  /// As after the start: the scene in a window of the usual size, no key or button pressed, no message, no file.
  void begin_again(const std::filesystem::path& scene) {
    std::fill(std::begin(io().MouseDown), std::end(io().MouseDown), false);
    std::fill(std::begin(io().KeysDown), std::end(io().KeysDown), false);
    io().MousePos = {-1, -1};
    io().KeyCtrl = false;
    resize({});
    picture();
    if (viewer_->filming()) type("v");
    if (!viewer_->panels_shown()) type("h");
    if (viewer_->display().wireframe) type("w");
    type("1");
    picture(100);  // messages disappear
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      std::filesystem::remove_all(entry.path());
    viewer_->open(scene);
  }

  Viewer& viewer() { return *viewer_; }
  Simulation& simulation() { return *viewer_->simulation(); }
  const TestFolder& folder() const { return folder_; }
  static ImGuiIO& io() { return ImGui::GetIO(); }

  void resize(const WindowSize& size) {
    io().DisplaySize = {static_cast<float>(size.width), static_cast<float>(size.height)};
    io().DisplayFramebufferScale = {size.scale, size.scale};
    width_ = static_cast<int>(std::lround(static_cast<float>(size.width) * size.scale));
    height_ = static_cast<int>(std::lround(static_cast<float>(size.height) * size.scale));
    if (width_ > 0 && height_ > 0) window_.resize(width_, height_);
  }

  /// Draws one frame, 1/60 s after the last one.
  void picture(double seconds = 1 / 60.0) {
    io().DeltaTime = static_cast<float>(seconds > 0 ? seconds : 1e-3);
    viewer_->frame(seconds, window_.framebuffer().id());
    render::throw_gl_errors();
  }
  void pictures(int count) {
    for (int i = 0; i < count; ++i) picture();
  }
  render::Image image() const {
    return render::read_framebuffer(window_.framebuffer().id(), width_, height_);
  }

  /// Keys that type characters, each released before the next frame.
  void type(const char* characters) {
    for (const char* c = characters; *c != '\0'; ++c) {
      io().AddInputCharacter(static_cast<unsigned char>(*c));
      picture();
    }
  }

  void move(float x, float y) {
    io().MousePos = {x, y};
    picture();
  }
  void press(int button = 0) {
    io().MouseDown[button] = true;
    picture();
  }
  void release(int button = 0) {
    io().MouseDown[button] = false;
    picture();
  }
  void click(float x, float y) {
    move(x, y);
    press();
    release();
  }
  void double_click(float x, float y) {
    click(x, y);
    press();
    release();
    pictures(30);  // so that the next click does not count as a third one
  }

  /// Window position of a point of the scene.
  ImVec2 seen(const Vec3f& point) {
    const ViewArea& area = viewer_->area();
    const auto at = viewer_->camera().project(point, area.width, area.height);
    if (!at) return {-1, -1};
    return {(static_cast<float>(area.x) + at->x) / area.scale,
            (static_cast<float>(area.y) + at->y) / area.scale};
  }

  /// The center of a control in an ImGui window, found by pointing at it as a user does. Remembered until the panel's
  /// layout changes (`invalidate_layout`).
  ImVec2 control(const char* id, const char* window = "##panel", float x = -1) {
    const ImGuiWindow* found = ImGui::FindWindowByName(window);
    if (found == nullptr) return {-1, -1};
    if (x < 0) x = found->Pos.x + 0.75f * found->Size.x;
    const auto place = std::make_pair(found->ID, x);
    if (controls_.count(place) == 0) point_at_all(*found, x, controls_[place]);
    const auto& seen = controls_[place];
    const auto at = seen.find(ImHashStr(id, 0, found->ID));
    return at == seen.end() ? ImVec2{-1, -1} : ImVec2{x, (at->second.first + at->second.second) / 2};
  }
  void invalidate_layout() { controls_.clear(); }

 private:
  using Rows = std::map<ImGuiID, std::pair<float, float>>;  // first and last y of each control

  void point_at_all(const ImGuiWindow& window, float x, Rows& rows) {
    const float end = window.Pos.y + window.Size.y;
    for (float y = window.Pos.y + 1; y < end; y += 10) {
      io().MousePos = {x, y};
      picture(0);
      if (ImGui::GetHoveredID() != 0) rows.try_emplace(ImGui::GetHoveredID(), y, y).first->second.second = y;
    }
  }

  TestFolder folder_;
  render::OffscreenContext context_;
  std::unique_ptr<Ui> ui_;
  ViewTarget window_;
  std::unique_ptr<Viewer> viewer_;
  int width_ = 0, height_ = 0;
  std::map<std::pair<ImGuiID, float>, Rows> controls_;
};

}  // namespace souple::viewer
