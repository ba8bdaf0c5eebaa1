#pragma once

#include "app/view/additions.h"
#include "render/camera.h"
#include "render/display.h"
#include "render/renderer.h"
#include "web/src/held_world.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace souple::web {

/// A canvas that shows a world, and the camera that looks at it. Points are pixels of the picture, from the top left.
class PageView {
 public:
  /// Uses the current WebGL context. Throws Error that names what it lacks.
  PageView() = default;

  /// Shows a world from its scene's camera; nullptr: none. The world must stay until another is shown.
  void show(HeldWorld* world, int width, int height);
  void draw(int width, int height);
  /// Adds real time [s] to the world, if it plays.
  void advance(double seconds);

  bool grab(float x, float y);
  void drag(float x, float y);
  /// Pins the vertex at a point, or releases it. False if nothing is there.
  bool toggle_pin(float x, float y);
  void throw_ball(float x, float y);
  void add(viewer::Addition addition, float x, float y);
  /// Adds a mesh file above the middle of the scene.
  void add(const std::filesystem::path& mesh);
  void frame_all();

  render::Camera& camera() { return camera_; }
  render::DisplayOptions& display() { return display_; }
  render::RenderOptions& rendering() { return rendering_; }
  int height() const { return height_; }

 private:
  HeldWorld& world() const;
  render::Subject subject() const;
  host::Ray ray(float x, float y) const;
  float reach() const;
  Vec3f point_at(float x, float y) const;

  render::Renderer renderer_;
  render::SubjectDrawing drawing_;
  render::DisplayOptions display_;
  render::RenderOptions rendering_{.labels = false};
  render::Camera camera_;
  HeldWorld* world_ = nullptr;
  std::uint64_t number_ = 0;  // of the world
  int width_ = 1, height_ = 1;
};

}  // namespace souple::web
