#include "app/view/notices.h"

#include "app/view/ui.h"

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <imgui.h>

namespace souple::viewer {

namespace {

constexpr std::size_t max_notices = 4;

}  // namespace

void Notices::info(const std::string& text) {
  std::printf("%s\n", text.c_str());
  std::fflush(stdout);
  add(text, false);
}

void Notices::error(const std::string& text) {
  std::fprintf(stderr, "souple: %s\n", text.c_str());
  add(text, true);
}

void Notices::add(const std::string& text, bool is_error) {
  const auto same = [&](const Notice& notice) { return notice.text == text; };
  notices_.erase(std::remove_if(notices_.begin(), notices_.end(), same), notices_.end());
  notices_.push_back({text, is_error, is_error ? 15.0 : 6.0});
  if (notices_.size() > max_notices) notices_.erase(notices_.begin());
}

void Notices::advance(double seconds) {
  for (Notice& notice : notices_) notice.remaining -= seconds;
  const auto over = [](const Notice& notice) { return notice.remaining <= 0; };
  notices_.erase(std::remove_if(notices_.begin(), notices_.end(), over), notices_.end());
}

void Notices::draw(float x, float bottom, float width) {
  ImDrawList& draw = *ImGui::GetBackgroundDrawList();
  const float padding = ImGui::GetFontSize() * 0.6f, stripe = 3;
  const float wrap = std::max(width - 4 * padding, 40.0f);
  float below = bottom;
  for (std::size_t i = notices_.size(); i-- > 0;) {
    const Notice& notice = notices_[i];
    const auto fade = static_cast<float>(std::clamp(notice.remaining / 0.5, 0.0, 1.0));
    const char* text = notice.text.c_str();
    const ImVec2 size = ImGui::CalcTextSize(text, nullptr, false, wrap);
    const float y = below - size.y - 2 * padding;
    const ImVec2 hi{x + size.x + 2 * padding + stripe, below};
    draw.AddRectFilled({x, y}, hi, ui_color(theme::background, 0.88f * fade), 4);
    draw.AddRectFilled({x, y}, {x + stripe, hi.y},
                       ui_color(notice.is_error ? theme::bad : theme::accent, fade), 2);
    draw.AddText(nullptr, 0, {x + padding + stripe, y + padding}, ui_color(theme::text, fade), text, nullptr,
                 wrap);
    below = y - padding;
  }
}

std::vector<std::string> Notices::texts() const {
  std::vector<std::string> texts;
  for (const Notice& notice : notices_) texts.push_back(notice.text);
  return texts;
}

}  // namespace souple::viewer
