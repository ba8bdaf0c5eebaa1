#include "app/view/panels.h"
#include "app/view/recording.h"
#include "app/view/simulation.h"
#include "app/view/ui.h"
#include "app/view/viewer.h"
#include "app/view/widgets.h"
#include "souple/objects/kind_traits.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <imgui.h>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/core.h>

// The panel on the left, and text over the scene.

namespace souple::viewer {

namespace {

bool wide_button(const char* name, float width, bool lit = false) {
  if (lit) ImGui::PushStyleColor(ImGuiCol_Button, ui_color(theme::accent, 0.55f));
  const bool pressed = ImGui::Button(name, {width, 0});
  if (lit) ImGui::PopStyleColor();
  return pressed;
}

float button_width(int buttons) {
  const float gaps = ImGui::GetStyle().ItemSpacing.x * static_cast<float>(buttons - 1);
  return (ImGui::GetContentRegionAvail().x - gaps) / static_cast<float>(buttons);
}

void dim_text(const std::string& text) {
  ImGui::PushStyleColor(ImGuiCol_Text, ui_color(theme::dim));
  ImGui::TextWrapped("%s", text.c_str());
  ImGui::PopStyleColor();
}

/// Right-aligned text on a dark background; (right, y) is its upper right corner.
void text_from_right(float right, float y, unsigned color, const std::string& text) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const float padding = ImGui::GetFontSize() * 0.5f;
  const ImVec2 lo{right - size.x - 2 * padding, y}, hi{right, y + size.y + padding};
  draw.AddRectFilled(lo, hi, ui_color(theme::background, 0.72f), 4);
  draw.AddText({lo.x + padding, y + padding * 0.5f}, color, text.c_str());
}

}  // namespace

void Viewer::draw_panel() {
  const float width = static_cast<float>(area_.x) / area_.scale;
  ImGui::SetNextWindowPos({0, 0});
  ImGui::SetNextWindowSize(
      {std::max(width, 1.0f), std::max(static_cast<float>(height_) / area_.scale, 1.0f)});
  constexpr ImGuiWindowFlags flags = ImGuiWindowFlags_NoDecoration & ~ImGuiWindowFlags_NoScrollbar;
  ImGui::Begin("##panel", nullptr,
               flags | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoBringToFrontOnFocus);
  guarded([&] { scene_section(); });
  guarded([&] { transport_section(); });
  if (Simulation* simulated = simulation()) {
    simulation_sections(*simulated);
  } else if (const Recording* recorded = recording()) {
    recording_section(*recorded);
  }
  ImGui::Dummy({0, 8});
  ImGui::End();
}

void Viewer::scene_section() {
  const float arrow = ImGui::GetFrameHeight(), gap = ImGui::GetStyle().ItemSpacing.x;
  std::size_t wanted = scenes_.entries().size();
  if (ImGui::ArrowButton("##previous", ImGuiDir_Left)) wanted = scenes_.neighbor(-1);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - arrow - gap);
  if (ImGui::BeginCombo("##scene", session_->name().c_str(), ImGuiComboFlags_HeightLarge)) {
    for (std::size_t i = 0; i < scenes_.entries().size(); ++i) {
      ImGui::PushID(static_cast<int>(i));
      if (ImGui::Selectable(scenes_.entries()[i].name.c_str(), i == scenes_.current())) wanted = i;
      ImGui::PopID();
    }
    ImGui::EndCombo();
  }
  ImGui::SameLine();
  if (ImGui::ArrowButton("##next", ImGuiDir_Right)) wanted = scenes_.neighbor(1);
  if (!session_->description().empty()) dim_text(session_->description());
  if (wanted < scenes_.entries().size()) open_entry(wanted);
}

void Viewer::transport_section() {
  const float quarter = button_width(4);
  const bool recorded = recording() != nullptr;
  ImGui::Dummy({0, 2});
  const bool pause =
      wide_button(session_->playing() ? "Pause###play" : "Play###play", quarter, session_->playing());
  ImGui::SameLine();
  const bool fine = wide_button(recorded ? "Back###fine" : "Substep###fine", quarter);
  ImGui::SameLine();
  const bool frame = wide_button("Frame###frame", quarter);
  ImGui::SameLine();
  const bool reset = wide_button("Reset###reset", quarter);
  const float half = button_width(2);
  const bool screenshot = wide_button("Screenshot###screenshot", half);
  ImGui::SameLine();
  const bool film = wide_button(film_ ? "Stop film###film" : "Film###film", half, film_ != nullptr);
  if (pause) act(Action::pause);
  if (fine) act(Action::step_substep);
  if (frame) act(Action::step_frame);
  if (reset) act(Action::reset);
  if (Simulation* simulated = simulation()) rewind_row(*simulated);
  if (screenshot) act(Action::screenshot);
  if (film) act(Action::film);
}

bool Viewer::shows_fluids() const {
  return std::any_of(subject_.bodies.begin(), subject_.bodies.end(),
                     [](const render::Body& body) { return traits_of(body.kind).flows; });
}

void Viewer::simulation_sections(Simulation& simulation) {
  timing_panel(simulation);
  guarded([&] { solver_panel(simulation); });
  guarded([&] { material_panel(simulation, chosen_object_); });
  guarded([&] { forces_panel(simulation); });
  additions_section();
  numbers_panel(simulation);
  display_panel(display_, rendering_, options_.half_resolution, true, shows_fluids());
  ImGui::Dummy({0, 6});
  if (wide_button("Copy as scene file###copy", button_width(1))) {
    simulation.set_camera(camera_);
    ImGui::SetClipboardText(simulation.scene_text().c_str());
    notices_.info("copied the scene with its current settings to the clipboard");
  }
}

void Viewer::recording_section(const Recording& recording) {
  if (section("Recording")) {
    value_row("Frames", fmt::format("{}", recording.frames()));
    value_row("Frame rate", fmt::format("{:.4g} frames/s", recording.frame_rate()));
    std::size_t points = 0;
    for (const render::Body& body : recording.subject().bodies) points += body.positions.size();
    value_row("Points", fmt::format("{}", points));
  }
  display_panel(display_, rendering_, options_.half_resolution, false, shows_fluids());
}

void Viewer::draw_status() {
  const float right = static_cast<float>(width_) / area_.scale - 12;
  const float line = ImGui::GetFontSize() * 1.5f + 6;
  std::string text = fmt::format("{:.2f} s   frame {}", session_->time(), session_->frame());
  text_from_right(right, 12, ui_color(theme::text), text);
  if (film_) {
    text_from_right(right, 12 + line, ui_color(theme::bad), "filming " + film_file_.filename().string());
  } else if (!session_->playing()) {
    text_from_right(right, 12 + line, ui_color(theme::warm), "paused");
  } else if (session_->speed() < 0.9) {
    text_from_right(right, 12 + line, ui_color(theme::warm),
                    fmt::format("runs at {:.2g} of real time", session_->speed()));
  } else {
    text_from_right(right, 12 + line, ui_color(theme::dim), "real time");
  }
}

/// A ring around the particle that became non-finite first, with its name; at the edge if the particle is out
/// of view.
void Viewer::draw_failure() {
  if (!session_->failure() || session_->failure()->object.empty() || area_.empty()) return;
  const Failure& failure = *session_->failure();
  const float radius = ImGui::GetFontSize(), scale = area_.scale;
  const ImVec2 lo{static_cast<float>(area_.x) / scale + 2 * radius, 2 * radius};
  const ImVec2 hi{static_cast<float>(width_) / scale - 2 * radius,
                  static_cast<float>(area_.height) / scale - 2 * radius};
  const auto seen = camera_.project(failure.position, area_.width, area_.height);
  ImVec2 at{(lo.x + hi.x) / 2, (lo.y + hi.y) / 2};
  if (seen)
    at = {(static_cast<float>(area_.x) + seen->x) / scale, (static_cast<float>(area_.y) + seen->y) / scale};
  const bool inside = seen && at.x >= lo.x && at.x <= hi.x && at.y >= lo.y && at.y <= hi.y;
  at = {std::clamp(at.x, lo.x, std::max(lo.x, hi.x)), std::clamp(at.y, lo.y, std::max(lo.y, hi.y))};

  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  draw.AddCircle(at, radius, ui_color(theme::background, 0.8f), 32, 5);
  draw.AddCircle(at, radius, ui_color(theme::bad), 32, 2.5f);
  const std::string name =
      fmt::format("{}, particle {}{}", failure.object, failure.vertex, inside ? "" : " (out of view)");
  const ImVec2 size = ImGui::CalcTextSize(name.c_str());
  const bool leftwards = at.x + radius + size.x + 12 > hi.x;
  const ImVec2 corner{leftwards ? at.x - radius - size.x - 8 : at.x + radius + 8, at.y - size.y / 2};
  draw.AddRectFilled({corner.x - 5, corner.y - 3}, {corner.x + size.x + 5, corner.y + size.y + 3},
                     ui_color(theme::background, 0.85f), 4);
  draw.AddText(corner, ui_color(theme::bad), name.c_str());
}

float Viewer::time_slider_height() {
  return ImGui::GetFrameHeight() + 16;
}

void Viewer::draw_time_slider() {
  Recording* recorded = recording();
  if (recorded == nullptr || area_.empty()) return;
  const float scale = area_.scale, height = time_slider_height();
  ImGui::SetNextWindowPos(
      {static_cast<float>(area_.x) / scale, static_cast<float>(area_.height) / scale - height});
  ImGui::SetNextWindowSize({static_cast<float>(area_.width) / scale, height});
  ImGui::SetNextWindowBgAlpha(0.75f);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {14, 8});
  ImGui::Begin("##time", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings);
  ImGui::PopStyleVar();
  int frame = static_cast<int>(recorded->frame());
  const std::string text = fmt::format("frame %d of {}", recorded->frames());
  ImGui::SetNextItemWidth(-1);
  if (ImGui::SliderInt("##frame_shown", &frame, 1, static_cast<int>(recorded->frames()), text.c_str())) {
    guarded([&] {
      recorded->set_playing(false);
      recorded->seek(static_cast<std::uint64_t>(std::max(frame, 1)));
    });
  }
  ImGui::End();
}

namespace {

/// A key or a mouse gesture with the word for its action.
struct Cap {
  std::string_view key, brief;
  float x = 0, y = 0, key_width = 0;  ///< from the bar's upper left corner
};

struct CapLayout {
  std::vector<Cap> caps;
  float height = 0, font = 0, pad = 0;
};

float width_of(std::string_view text, float font) {
  return ImGui::GetFont()->CalcTextSizeA(font, 1e9f, 0, text.data(), text.data() + text.size()).x;
}

/// Distributes the entries over as many lines as necessary.
CapLayout lay_out_caps(float width) {
  CapLayout layout;
  for (const Key& key : keys) layout.caps.push_back({key.key, key.brief});
  for (const Gesture& gesture : gestures) layout.caps.push_back({gesture.gesture_brief, gesture.brief});
  const float font = layout.font = ImGui::GetFontSize() * 0.87f, margin = 14, line = font * 1.75f;
  layout.pad = font * 0.45f;
  float x = margin, y = font * 0.6f;
  for (Cap& cap : layout.caps) {
    cap.key_width = width_of(cap.key, font) + 2 * layout.pad;
    const float whole = cap.key_width + layout.pad + width_of(cap.brief, font);
    if (x + whole > width - margin && x > margin) x = margin, y += line;
    cap.x = x, cap.y = y;
    x += whole + font * 1.1f;
  }
  layout.height = y + line + font * 0.25f;
  return layout;
}

}  // namespace

float Viewer::key_list_height(float width) {
  return lay_out_caps(width).height;
}

/// A bar below the scene.
void Viewer::draw_key_list() {
  const float scale = area_.scale, left = static_cast<float>(area_.x) / scale;
  const float top = static_cast<float>(area_.height) / scale;
  const float right = static_cast<float>(width_) / scale, bottom = static_cast<float>(height_) / scale;
  const CapLayout layout = lay_out_caps(right - left);
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  draw.AddRectFilled({left, top}, {right, bottom}, ui_color(theme::background));
  for (const Cap& cap : layout.caps) {
    const float x = left + cap.x, y = top + cap.y;
    draw.AddRectFilled({x, y}, {x + cap.key_width, y + layout.font + layout.pad}, ui_color(theme::field), 3);
    const auto write = [&](float at, unsigned color, std::string_view text) {
      draw.AddText(ImGui::GetFont(), layout.font, {at, y + layout.pad * 0.5f}, color, text.data(),
                   text.data() + text.size());
    };
    write(x + layout.pad, ui_color(theme::text), cap.key);
    write(x + cap.key_width + layout.pad, ui_color(theme::dim), cap.brief);
  }
}

}  // namespace souple::viewer
