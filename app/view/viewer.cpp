#include "app/view/viewer.h"

#include "app/pictures.h"
#include "app/view/recording.h"
#include "app/view/simulation.h"
#include "app/view/ui.h"
#include "souple/error.h"
#include "souple/objects/kind_traits.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <epoxy/gl.h>
#include <imgui.h>
#include <imgui_internal.h>
#include <utility>

#include <fmt/core.h>

namespace souple::viewer {

namespace fs = std::filesystem;

namespace {

constexpr float panel_width = 350;  // maximum, in units of an ordinary screen
constexpr double quit_seconds = 3;  // within which a second Esc quits
constexpr int still_samples = 8;    // of screenshots and films
constexpr int max_picture_size = 8192;

}  // namespace

Viewer::Viewer(SceneList scenes, std::unique_ptr<Session> session, ViewerOptions options)
    : scenes_(std::move(scenes)), options_(std::move(options)) {
  show(std::move(session));
  if (options_.paused) session_->set_playing(false);
}

Viewer::~Viewer() {
  mouse_.release();  // a grab is released while its world still exists
}

Simulation* Viewer::simulation() {
  return dynamic_cast<Simulation*>(session_.get());
}
Recording* Viewer::recording() {
  return dynamic_cast<Recording*>(session_.get());
}

/// Shows an error on screen when a requested action fails; the viewer continues.
void Viewer::guarded(const std::function<void()>& what) {
  try {
    what();
  } catch (const Error& error) {
    notices_.error(error.what());
  }
}

// --- one picture ---------------------------------------------------------------------------------

void Viewer::frame(double seconds, std::uint32_t framebuffer) {
  Ui::begin();
  update_layout();
  notices_.advance(seconds);
  quit_asked_ = std::max(quit_asked_ - seconds, 0.0);
  guarded([&] { handle_keys(); });
  update_layout();  // a key may have hidden the panels
  guarded([&] { handle_mouse(); });
  guarded([&] { advance(seconds); });
  report_failure();
  if (panels_shown_) {
    draw_panel();
    draw_key_list();
  }
  draw_add_menu();
  draw_time_slider();
  update_list();
  draw_status();
  const float slider = recording() != nullptr ? time_slider_height() : 0;
  notices_.draw(static_cast<float>(area_.x) / area_.scale + 12,
                static_cast<float>(area_.height) / area_.scale - slider - 12,
                std::max(static_cast<float>(area_.width) / area_.scale - 24, 1.0f));
  draw_failure();
  ImGui::Render();
  guarded([&] { add_to_film(); });
  draw_scene(framebuffer);
}

void Viewer::advance(double seconds) {
  try {
    // A film contains every frame, however long drawing takes.
    session_->advance(film_ ? 1 / session_->frame_rate() : seconds);
  } catch (const Error&) {
    session_->set_playing(false);  // report the error once, not with every frame
    throw;
  }
}

void Viewer::update_layout() {
  const ImGuiIO& io = ImGui::GetIO();
  area_.scale = io.DisplayFramebufferScale.x > 0 ? io.DisplayFramebufferScale.x : 1;
  width_ = static_cast<int>(std::lround(io.DisplaySize.x * area_.scale));
  height_ = static_cast<int>(std::lround(io.DisplaySize.y * area_.scale));
  const float preferred = panel_width * ImGui::GetFontSize() / 15 * area_.scale;
  area_.x = panels_shown_ ? static_cast<int>(std::min(preferred, 0.45f * static_cast<float>(width_))) : 0;
  area_.y = 0;
  area_.width = width_ - area_.x;
  area_.height = height_;
  if (!panels_shown_) return;
  const float bar = key_list_height(static_cast<float>(area_.width) / area_.scale) * area_.scale;
  area_.height -= static_cast<int>(std::min(bar, 0.4f * static_cast<float>(height_)));
}

/// Each session numbers its worlds from 1. Adds the session's number: otherwise a scene would be drawn with
/// the triangles of another.
void Viewer::update_subject() {
  subject_ = session_->subject();
  subject_.topology += session_number_ << 32;
}

void Viewer::update_list() {
  update_subject();
  drawing_.update(subject_, display_);
  if (mouse_.grabbing()) {
    const render::PackedColor color = render::pack(render::srgb(theme::warm));
    drawing_.list().top_lines.push_back({mouse_.grabbed_point(), mouse_.drag_target(), color, 2.5f});
  }
}

void Viewer::draw_scene(std::uint32_t framebuffer) {
  if (width_ < 1 || height_ < 1) return;
  if (!area_.empty()) {
    const int part = options_.half_resolution ? 2 : 1;
    target_.resize(area_.width / part, area_.height / part);
    const int bottom = height_ - area_.y - area_.height;
    render::RenderOptions rendering = rendering_;
    rendering.labels = false;  // at the full resolution below
    rendering.coarse = true;
    const render::gl::Framebuffer& target = target_.framebuffer();
    renderer_.draw(drawing_.list(), camera_, rendering, target.width(), target.height(), target.id());
    glDisable(GL_SCISSOR_TEST);
    target.copy_to(framebuffer, area_.x, bottom, area_.width, area_.height);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(area_.x, bottom, area_.width, area_.height);
    renderer_.draw_labels(drawing_.list(), area_.width, area_.height);
  }
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, width_, height_);
  Ui::draw();
}

// --- what is shown -------------------------------------------------------------------------------

void Viewer::show(std::unique_ptr<Session> session) {
  mouse_.release();
  subject_ = {};
  session_ = std::move(session);
  ++session_number_;
  chosen_object_ = first_with_material();
  failure_reported_ = false;
  // Another scene may lack what a mode shows, such as links; then only a legend would be left.
  display_.constraints = render::ConstraintDisplay::none;
  if (const std::optional<render::Camera> camera = session_->camera()) {
    camera_ = *camera;
  } else {
    frame_all();
  }
  if (const Simulation* shown = simulation())
    ball_ = ball_for(camera_.distance(), length(shown->scene().settings.gravity));
  addition_size_ = camera_.distance() / 8;
}

/// An obstacle comes first in many scenes; what moves is what a user changes.
std::size_t Viewer::first_with_material() {
  const Simulation* shown = simulation();
  if (shown == nullptr) return 0;
  const std::vector<AnyObjectDescription>& objects = shown->scene().objects;
  for (std::size_t i = 0; i < objects.size(); ++i)
    if (!traits_of(kind_of(objects[i])).driven) return i;
  return 0;
}

void Viewer::open(const fs::path& path) {
  guarded([&] {
    std::error_code error;
    const bool is_mesh = fs::is_regular_file(path, error) && path.extension() != ".json";
    if (!is_mesh || simulation() == nullptr) return show(scenes_.open(path));
    add(described(path), point_under_mouse());
  });
}

void Viewer::open_entry(std::size_t entry) {
  guarded([&] { show(scenes_.open(entry)); });
}

void Viewer::report_failure() {
  const bool failure = session_->failure().has_value();
  if (failure && !failure_reported_) notices_.error(session_->name() + ": " + session_->failure()->message);
  failure_reported_ = failure;
}

void Viewer::frame_all() {
  const float aspect =
      area_.empty() ? 1.6f : static_cast<float>(area_.width) / static_cast<float>(area_.height);
  camera_.frame(app::extent_of(session_->subject()).points(), aspect);
}

// --- keys ----------------------------------------------------------------------------------------

void Viewer::handle_keys() {
  const ImGuiIO& io = ImGui::GetIO();
  const bool any_down =
      std::any_of(std::begin(io.KeysDown), std::end(io.KeysDown), [](bool down) { return down; });
  if (!io.WantTextInput) {
    for (const ImWchar character : io.InputQueueCharacters) handle_character(character);
  }
  if (!any_down) key_down_ = 0;
}

/// Letters arrive as the characters they type, so they follow the keyboard's layout. A pressed key repeats
/// its character, which most keys ignore.
void Viewer::handle_character(unsigned character) {
  const bool again = character == key_down_;
  key_down_ = character;
  if (character > 127) return;
  const char lower = static_cast<char>(std::tolower(static_cast<int>(character)));
  if (lower >= '1' && lower <= '9') display_.display = static_cast<render::Display>(lower - '1');
  for (const Key& key : keys) {
    if (key.character == lower && key.character != 0 && (!again || key.repeats)) act(key.action);
  }
}

void Viewer::act(Action action) {
  switch (action) {
    case Action::pause:
      return session_->set_playing(!session_->playing());
    case Action::step_frame:
      return session_->step_frame();
    case Action::step_substep:
      return session_->step_fine();
    case Action::step_back:
      mouse_.release();
      return session_->step_back();
    case Action::throw_ball:
      return throw_ball();
    case Action::add_object:
      return ask_addition();
    case Action::reset:
      mouse_.release();
      return session_->reset();
    case Action::next_scene:
      return open_entry(scenes_.neighbor(1));
    case Action::previous_scene:
      return open_entry(scenes_.neighbor(-1));
    case Action::frame_all:
      return frame_all();
    case Action::wireframe:
      display_.wireframe = !display_.wireframe;
      return;
    case Action::constraints: {
      const std::size_t next =
          (static_cast<std::size_t>(display_.constraints) + 1) % render::constraint_display_count;
      display_.constraints = static_cast<render::ConstraintDisplay>(next);
      return;
    }
    case Action::display:
      return;  // handled in handle_character
    case Action::screenshot:
      return take_screenshot();
    case Action::film:
      return toggle_film();
    case Action::hide_panel:
      panels_shown_ = !panels_shown_;
      return;
    case Action::quit:
      // Closes an open popup first.
      if (ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup)) return ImGui::ClosePopupToLevel(0, true);
      done_ = quit_asked_ > 0;
      if (!done_) notices_.info("Esc again quits");
      quit_asked_ = quit_seconds;
      return;
  }
}

// --- mouse ---------------------------------------------------------------------------------------

void Viewer::handle_mouse() {
  mouse_.update(camera_, simulation(), area_, [this](int x, int y) { return pick(x, y); });
}

std::optional<Mouse::PickedVertex> Viewer::pick(int x, int y) {
  if (x < 0 || y < 0 || x >= area_.width || y >= area_.height) return std::nullopt;
  update_subject();
  const render::DrawList& list = drawing_.update(subject_, display_);
  const render::Picked picked = renderer_.pick(list, camera_, x, y, area_.width, area_.height);
  if (picked.pick == 0 || picked.pick > subject_.bodies.size()) return std::nullopt;
  const render::Body& body = subject_.bodies[picked.pick - 1];
  const std::uint32_t vertex = drawing_.vertex_of(subject_, picked.pick, picked.element);
  return Mouse::PickedVertex{ObjectId{body.id}, vertex, picked.point};
}

// --- pictures ------------------------------------------------------------------------------------

/// souple-NAME-0001.png, or the first unused number: existing files are never overwritten.
fs::path Viewer::new_file(const std::string& ending) const {
  for (int number = 1; number < 10000; ++number) {
    const fs::path file =
        options_.folder / fmt::format("souple-{}-{:04}{}", session_->name(), number, ending);
    if (std::error_code error; !fs::exists(fs::symlink_status(file, error))) return file.lexically_normal();
  }
  throw Error(options_.folder.string() + ": holds 9999 pictures of " + session_->name() + "; move some away");
}

/// The scene without panels, with more samples than on screen.
void Viewer::take_screenshot() {
  if (area_.empty()) throw Error("the window is too small for a picture");
  const fs::path file = new_file(".png");
  render::RenderOptions rendering = rendering_;
  rendering.samples = still_samples;
  update_list();
  render::write_png(
      file, renderer_.picture(drawing_.list(), camera_, rendering, std::min(area_.width, max_picture_size),
                              std::min(area_.height, max_picture_size)));
  notices_.info("screenshot: " + file.string());
}

void Viewer::toggle_film() {
  if (film_) {
    const std::unique_ptr<render::Film> finished = std::move(film_);
    finished->finish();
    notices_.info(fmt::format("film: {}, {} frames", film_file_.string(), film_frames_));
    return;
  }
  film_width_ = std::min(area_.width, max_picture_size) / 2 * 2;
  film_height_ = std::min(area_.height, max_picture_size) / 2 * 2;
  if (film_width_ < 2 || film_height_ < 2) throw Error("the window is too small for a film");
  film_file_ = new_file(".mp4");
  film_ = std::make_unique<render::Film>(film_file_, session_->frame_rate());
  film_frame_ = ~std::uint64_t{0};
  film_frames_ = 0;
}

/// Adds each frame of the simulation once.
void Viewer::add_to_film() {
  if (!film_ || session_->frame() == film_frame_) return;
  film_frame_ = session_->frame();
  render::RenderOptions rendering = rendering_;
  rendering.samples = still_samples;
  try {
    film_->add(renderer_.picture(drawing_.list(), camera_, rendering, film_width_, film_height_));
  } catch (const Error&) {
    film_.reset();  // report the error once, not with every frame
    throw;
  }
  ++film_frames_;
}

}  // namespace souple::viewer
