#pragma once

#include "app/view/additions.h"
#include "app/view/keys.h"
#include "app/view/mouse.h"
#include "app/view/notices.h"
#include "app/view/scene_list.h"
#include "app/view/session.h"
#include "app/view/view_target.h"
#include "render/camera.h"
#include "render/display.h"
#include "render/film.h"
#include "render/image.h"
#include "render/renderer.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace souple::viewer {

class Recording;
class Simulation;

struct ViewerOptions {
  std::filesystem::path folder = ".";  ///< where screenshots and films are written
  bool paused = false;
  bool half_resolution = false;  ///< of the scene on screen: a quarter of the pixels to draw
};

/// The viewer without its window: content, reactions to mouse and keys, and panels. Reads input only from
/// ImGui's IO and draws into any framebuffer, so tests can drive it off-screen like a window.
class Viewer {
 public:
  /// Uses the current OpenGL context; a Ui must exist. Throws Error when the context lacks a feature.
  Viewer(SceneList scenes, std::unique_ptr<Session> session, ViewerOptions options = {});
  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  /// One frame, of the size in ImGui's IO: handles the input, advances by `seconds` of real time, and draws.
  /// For a window without area it does all but draw. Throws Error when OpenGL fails.
  void frame(double seconds, std::uint32_t framebuffer = 0);
  /// Whether Esc was pressed twice within three seconds.
  bool done() const { return done_; }

  /// Shows another scene or run, or adds a mesh file to the scene, under the mouse. If the file cannot be opened,
  /// shows an error and keeps the current one.
  void open(const std::filesystem::path& path);
  void act(Action action);

  const Session& session() const { return *session_; }
  Simulation* simulation();  ///< nullptr when a recording is shown
  Recording* recording();    ///< nullptr when a simulation is shown
  const SceneList& scenes() const { return scenes_; }
  const Mouse& mouse() const { return mouse_; }
  render::Camera& camera() { return camera_; }
  const render::DisplayOptions& display() const { return display_; }
  render::RenderOptions& rendering() { return rendering_; }
  std::vector<std::string> notices() const { return notices_.texts(); }
  const ViewArea& area() const { return area_; }
  bool panels_shown() const { return panels_shown_; }
  const Ball& ball() const { return ball_; }
  bool filming() const { return film_ != nullptr; }

 private:
  void guarded(const std::function<void()>& what);
  void advance(double seconds);
  void show(std::unique_ptr<Session> session);
  std::size_t first_with_material();
  void open_entry(std::size_t entry);
  void report_failure();

  // input
  void handle_keys();
  void handle_character(unsigned character);
  void handle_mouse();
  std::optional<Mouse::PickedVertex> pick(int x, int y);
  void frame_all();

  // additions
  Simulation& simulation_for(const char* what);
  Vec3f point_under_mouse();
  void throw_ball();
  void ask_addition();
  void add(const NewObject& object, const Vec3f& point);
  void draw_add_menu();

  // pictures
  std::filesystem::path new_file(const std::string& ending) const;
  void take_screenshot();
  void toggle_film();
  void add_to_film();
  void update_layout();
  void update_subject();
  void update_list();
  void draw_scene(std::uint32_t framebuffer);

  // panels
  void draw_panel();
  void scene_section();
  void transport_section();
  void rewind_row(Simulation& simulation);
  void additions_section();
  bool shows_fluids() const;
  void recording_section(const Recording& recording);
  void simulation_sections(Simulation& simulation);
  void draw_status();
  void draw_failure();
  static float time_slider_height();
  void draw_time_slider();
  static float key_list_height(float width);
  void draw_key_list();

  SceneList scenes_;
  std::unique_ptr<Session> session_;
  std::uint64_t session_number_ = 0;
  ViewerOptions options_;
  render::Camera camera_;
  render::DisplayOptions display_;
  render::RenderOptions rendering_;
  render::Renderer renderer_;
  render::SubjectDrawing drawing_;
  render::Subject subject_;
  ViewTarget target_;
  Mouse mouse_;
  Notices notices_;
  ViewArea area_;
  int width_ = 0, height_ = 0;  // of the window [pixels]
  bool panels_shown_ = true, done_ = false, failure_reported_ = false;
  double quit_asked_ = 0;  // time left for a second Esc [s]
  unsigned key_down_ = 0;  // character of the pressed key; 0: none
  std::size_t chosen_object_ = 0;
  Ball ball_;
  float addition_size_ = 1;  // m
  Vec3f addition_point_{};   // of the open menu
  bool addition_asked_ = false;

  std::unique_ptr<render::Film> film_;
  std::filesystem::path film_file_;
  int film_width_ = 0, film_height_ = 0;
  std::uint64_t film_frame_ = 0, film_frames_ = 0;
};

}  // namespace souple::viewer
