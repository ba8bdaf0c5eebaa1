#include "app/view/widgets.h"

#include "app/view/ui.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <imgui.h>

namespace souple::viewer {

namespace {

constexpr float name_share = 0.42f;

void hint_for_last_item(const char* hint) {
  if (hint != nullptr && ImGui::IsItemHovered()) {
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(ImGui::GetFontSize() * 22);
    ImGui::TextUnformatted(hint);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
  }
}

/// Literal text as a slider's format: what is shown does not depend on the number that it moves.
std::string literal(const std::string& text) {
  std::string format;
  for (const char c : text) {
    format += c;
    if (c == '%') format += c;
  }
  return format;
}

/// A field to type the number in, opened by Ctrl + click on the slider before it.
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

/// ImGui's own logarithmic slider takes everything below a thousandth for zero; a cloth bends with 1e-6 N m.
bool logarithmic_slider(const std::string& id, float& value, const SliderRange& range, const char* unit) {
  const float lo = std::log10(range.lo), hi = std::log10(range.hi);
  float at = value > 0 ? std::clamp(std::log10(value), lo, hi) : lo;
  const std::string format = literal(with_unit(value, unit));
  const bool moved = ImGui::SliderFloat(id.c_str(), &at, lo, hi, format.c_str(), ImGuiSliderFlags_NoInput) &&
                     !ImGui::GetIO().KeyCtrl;
  float rounded = value;
  if (moved) {
    // Three digits: what is shown is what is set, and what stands in the copied scene.
    char text[32];
    std::snprintf(text, sizeof(text), "%.3g", std::pow(10.0, static_cast<double>(at)));
    rounded = std::strtof(text, nullptr);
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
  ImGui::PushStyleColor(ImGuiCol_Text, ui_colour(theme::dim));
  ImGui::TextUnformatted(name);
  ImGui::PopStyleColor();
  hint_for_last_item(hint);
  const float start = ImGui::GetWindowContentRegionMin().x;
  const float width = ImGui::GetWindowContentRegionMax().x - start;
  ImGui::SameLine(start + name_share * width);
  ImGui::SetNextItemWidth(-1);
}

std::string with_unit(double value, const char* unit) {
  char text[64];
  const char* gap = unit[0] == '\0' ? "" : " ";
  std::snprintf(text, sizeof(text), "%.3g%s%s", value, gap, unit);
  return text;
}

bool slider_row(const char* name, const std::string& id, float& value, const SliderRange& range,
                const char* unit, const char* hint) {
  row(name, hint);
  if (range.logarithmic) return logarithmic_slider(id, value, range, unit);
  const std::string format = std::string("%.3g ") + literal(unit);
  return ImGui::SliderFloat(id.c_str(), &value, range.lo, range.hi, format.c_str());
}

bool count_row(const char* name, const std::string& id, int& value, int lo, int hi, const char* hint) {
  row(name, hint);
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
