#include "app/view/widgets.h"

#include "app/view/ui.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <imgui.h>

#include <fmt/core.h>

namespace souple::viewer {

namespace {

constexpr float name_fraction = 0.42f;

void hint_for_last_item(const char* hint) {
  if (hint != nullptr && ImGui::IsItemHovered()) {
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 22);
    ImGui::TextUnformatted(hint);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
  }
}

/// Escapes text for use as a slider's format: then the displayed text does not depend on the slider's
/// internal value.
std::string literal(const std::string& text) {
  std::string format;
  for (const char c : text) {
    format += c;
    if (c == '%') format += c;
  }
  return format;
}

/// A field for typing the number, opened by Ctrl + click on the preceding slider.
bool typed_value(const std::string& id, float& value, const char* unit) {
  const std::string popup = id + ".typed";
  if (ImGui::IsItemHovered() && ImGui::IsMouseClicked(0) && ImGui::GetIO().KeyCtrl)
    ImGui::OpenPopup(popup.c_str());
  bool changed = false;
  if (ImGui::BeginPopup(popup.c_str())) {
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 8);
    float typed = value;
    if (ImGui::InputFloat(unit, &typed, 0, 0, "%g", ImGuiInputTextFlags_EnterReturnsTrue)) {
      value = typed;
      changed = true;
      ImGui::CloseCurrentPopup();
    }
    ImGui::EndPopup();
  }
  return changed;
}

/// Three digits, without the zeros and signs that C adds: 0.15, 4000, 1e9, 2.5e-6.
std::string number_text(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  const double rounded = std::strtod(text.data(), nullptr);
  if (std::fabs(rounded) >= 1000 && std::fabs(rounded) < 1e6)
    std::snprintf(text.data(), text.size(), "%.0f", rounded);
  std::string result = text.data();
  const std::size_t exponent = result.find('e');
  if (exponent == std::string::npos) return result;
  const int power = std::atoi(result.c_str() + exponent + 1);
  return fmt::format("{}{}", result.substr(0, exponent + 1), power);
}

/// While it exists, sliders are drawn as bars filled up to their value.
class Filled {
 public:
  explicit Filled(float share) {
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float width = ImGui::CalcItemWidth(), height = ImGui::GetFrameHeight();
    const float rounding = ImGui::GetStyle().FrameRounding,
                end = at.x + width * std::clamp(share, 0.0f, 1.0f);
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    const bool hovered = ImGui::IsMouseHoveringRect(at, {at.x + width, at.y + height});
    draw.AddRectFilled(at, {at.x + width, at.y + height}, ui_color(hovered ? 0x343b48 : theme::field),
                       rounding);
    if (end > at.x + 1)
      draw.AddRectFilled(at, {end, at.y + height}, ui_color(theme::accent, 0.45f), rounding);
    for (const ImGuiCol part : {ImGuiCol_FrameBg, ImGuiCol_FrameBgHovered, ImGuiCol_FrameBgActive,
                                ImGuiCol_SliderGrab, ImGuiCol_SliderGrabActive})
      ImGui::PushStyleColor(part, ImVec4{0, 0, 0, 0});
  }
  ~Filled() { ImGui::PopStyleColor(5); }
  Filled(const Filled&) = delete;
  Filled& operator=(const Filled&) = delete;
};

/// ImGui's own logarithmic slider treats everything below a thousandth as zero; the bending stiffness of a
/// cloth may be 1e-6 N m.
bool logarithmic_slider(const std::string& id, float& value, const SliderRange& range, const char* unit) {
  const float lo = std::log10(range.lo), hi = std::log10(range.hi);
  float at = value > 0 ? std::clamp(std::log10(value), lo, hi) : lo;
  const std::string format = literal(with_unit(value, unit));
  bool moved = false;
  {
    const Filled filled((at - lo) / (hi - lo));
    moved = ImGui::SliderFloat(id.c_str(), &at, lo, hi, format.c_str(), ImGuiSliderFlags_NoInput);
  }
  float rounded = value;
  if (moved && !ImGui::GetIO().KeyCtrl) {
    // Three digits: the displayed value is the value set and the value in the copied scene.
    rounded = std::strtof(number_text(std::pow(10.0, static_cast<double>(at))).c_str(), nullptr);
  }
  const bool changed = rounded != value;
  value = rounded;
  return typed_value(id, value, unit) || changed;
}

}  // namespace

bool section(const char* name, bool open) {
  ImGui::Dummy({0, 2});
  return ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

void row(const char* name, const char* hint) {
  ImGui::AlignTextToFramePadding();
  ImGui::PushStyleColor(ImGuiCol_Text, ui_color(theme::dim));
  ImGui::TextUnformatted(name);
  ImGui::PopStyleColor();
  hint_for_last_item(hint);
  const float start = ImGui::GetWindowContentRegionMin().x;
  const float width = ImGui::GetWindowContentRegionMax().x - start;
  ImGui::SameLine(start + name_fraction * width);
  ImGui::SetNextItemWidth(-1);
}

std::string with_unit(double value, const char* unit) {
  const char* gap = unit[0] == '\0' ? "" : " ";
  return number_text(value) + gap + unit;
}

bool slider_row(const char* name, const std::string& id, float& value, const SliderRange& range,
                const char* unit, const char* hint) {
  row(name, hint);
  if (range.logarithmic) return logarithmic_slider(id, value, range, unit);
  const std::string format = unit[0] == '\0' ? "%.3g" : std::string("%.3g ") + literal(unit);
  const Filled filled((value - range.lo) / (range.hi - range.lo));
  return ImGui::SliderFloat(id.c_str(), &value, range.lo, range.hi, format.c_str());
}

bool count_row(const char* name, const std::string& id, int& value, int lo, int hi, const char* hint) {
  row(name, hint);
  const double share = std::log(static_cast<double>(value) / lo) / std::log(static_cast<double>(hi) / lo);
  const Filled filled(static_cast<float>(share));
  return ImGui::SliderInt(id.c_str(), &value, lo, hi, "%d", ImGuiSliderFlags_Logarithmic);
}

bool vector_row(const char* name, const std::string& id, float (&value)[3], float speed, const char* unit) {
  row(name, unit);
  return ImGui::DragFloat3(id.c_str(), value, speed, 0, 0, "%.3g");
}

bool choice_row(const char* name, const std::string& id, int& value, const std::vector<const char*>& choices,
                const char* hint) {
  row(name, hint);
  return ImGui::Combo(id.c_str(), &value, choices.data(), static_cast<int>(choices.size()),
                      static_cast<int>(choices.size()));
}

bool check_row(const char* name, const std::string& id, bool& value) {
  row(name);
  return ImGui::Checkbox(id.c_str(), &value);
}

void value_row(const char* name, const std::string& value) {
  row(name);
  ImGui::TextUnformatted(value.c_str());
}

}  // namespace souple::viewer
