#include "app/percent.h"
#include "app/view/panels.h"
#include "app/view/ui.h"
#include "app/view/widgets.h"

#include <algorithm>
#include <array>
#include <imgui.h>
#include <string>

#include <fmt/core.h>

namespace souple::viewer {

namespace {

// Distinguishable for the color-blind; in the order of Stage.
constexpr std::array<unsigned, stage_count> stage_colors{0x5b8def, 0x8d97a6, 0x3fb4e0, 0xf0a35e,
                                                         0x4fb6a8, 0xd7dbe2, 0xc983d6, 0xe0dc7a};

/// Replaces underscores by spaces: "isometric_bending" to "isometric bending".
std::string spaced(std::string_view name) {
  std::string words(name);
  std::replace(words.begin(), words.end(), '_', ' ');
  return words;
}

double sum(const StageTimes& times) {
  double total = 0;
  for (const double ms : times) total += ms;
  return total;
}

/// Mean of the last half second or so.
StageTimes recent_mean(const std::deque<StageTimes>& history) {
  StageTimes mean{};
  const std::size_t count = std::min<std::size_t>(history.size(), 30);
  if (count == 0) return mean;
  for (std::size_t i = history.size() - count; i < history.size(); ++i) {
    for (std::size_t stage = 0; stage < stage_count; ++stage) mean[stage] += history[i][stage];
  }
  for (double& ms : mean) ms /= static_cast<double>(count);
  return mean;
}

/// The stages side by side, as wide as the panel.
void stage_bar(const StageTimes& mean) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = ImGui::GetFontSize() * 0.8f;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(at, {at.x + width, at.y + height}, ui_color(theme::field), 3);
  const double total = std::max(sum(mean), 1e-9);
  float x = at.x;
  for (std::size_t stage = 0; stage < stage_count; ++stage) {
    const float part = width * static_cast<float>(mean[stage] / total);
    if (part >= 0.5f) draw.AddRectFilled({x, at.y}, {x + part, at.y + height}, ui_color(stage_colors[stage]));
    x += part;
  }
  ImGui::Dummy({width, height});
}

/// Upper limit of the chart [ms]: nearly all frames fit, and a single slow frame does not flatten the rest.
/// The line of real time is shown once frames come near it.
double top_of(const std::deque<StageTimes>& history, double budget) {
  std::vector<double> sums;
  sums.reserve(history.size());
  for (const StageTimes& times : history) sums.push_back(sum(times));
  if (sums.empty()) return budget;
  const auto nearly_all = sums.begin() + static_cast<std::ptrdiff_t>(sums.size() * 95 / 100);
  std::nth_element(sums.begin(), nearly_all, sums.end());
  const double top = std::max(*nearly_all * 1.25, 0.02);
  return top > 0.3 * budget ? std::max(top, 1.35 * budget) : top;
}

/// One column for each frame, the newest on the right; a line marks real time.
void history_chart(const std::deque<StageTimes>& history, double budget) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float width = ImGui::GetContentRegionAvail().x, height = ImGui::GetFontSize() * 4;
  ImDrawList& draw = *ImGui::GetWindowDrawList();
  draw.AddRectFilled(at, {at.x + width, at.y + height}, ui_color(theme::field), 3);
  const double top = top_of(history, budget);
  const float column = width / static_cast<float>(Simulation::history_length);
  float x = at.x + width - column * static_cast<float>(history.size());
  for (const StageTimes& times : history) {
    float y = at.y + height;
    for (std::size_t stage = 0; stage < stage_count; ++stage) {
      const float part = std::min((height - 2) * static_cast<float>(times[stage] / top), y - at.y);
      draw.AddRectFilled({x, y - part}, {x + std::max(column, 1.0f), y}, ui_color(stage_colors[stage]));
      y -= part;
    }
    x += column;
  }
  if (1.2 * budget <= top && 4 * budget >= top) {
    const float y = at.y + height - (height - 2) * static_cast<float>(budget / top);
    draw.AddLine({at.x, y}, {at.x + width, y}, ui_color(theme::bad, 0.9f));
    draw.AddText({at.x + 4, y - ImGui::GetFontSize() - 1}, ui_color(theme::bad), "real time");
  }
  ImGui::Dummy({width, height});
}

void legend(const StageTimes& mean) {
  for (std::size_t stage = 0; stage < stage_count; ++stage) {
    if (stage % 2 == 1)
      ImGui::SameLine(ImGui::GetWindowContentRegionMin().x + ImGui::GetWindowContentRegionMax().x * 0.5f);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const float size = ImGui::GetFontSize() * 0.6f, drop = ImGui::GetFontSize() * 0.25f;
    ImGui::GetWindowDrawList()->AddRectFilled({at.x, at.y + drop}, {at.x + size, at.y + drop + size},
                                              ui_color(stage_colors[stage]), 2);
    ImGui::Dummy({size, size});
    ImGui::SameLine();
    const std::string name = spaced(stage_name(static_cast<Stage>(stage)));
    ImGui::TextDisabled("%s", name.c_str());
    ImGui::SameLine();
    ImGui::Text("%.2f", mean[stage]);
  }
}

/// The object that is stretched most by forces out of balance.
void balance_row(const StepReport& report) {
  const auto worst = std::max_element(report.objects.begin(), report.objects.end(),
                                      [](const auto& a, const auto& b) { return a.stretch < b.stretch; });
  if (worst == report.objects.end()) return;
  value_row("Out of balance", fmt::format("{} (stretch {}, {})", app::percent(worst->unbalanced),
                                          app::percent(worst->stretch), worst->name));
}

void residual_table(const StepReport& report) {
  ImGui::TextDisabled("Residuals |C|");
  if (report.kinds.empty() || !ImGui::BeginTable("##residuals", 4, ImGuiTableFlags_SizingStretchProp)) return;
  ImGui::TableSetupColumn("constraint", 0, 3);
  for (const char* name : {"count", "largest", "mean"}) ImGui::TableSetupColumn(name, 0, 1.25f);
  ImGui::PushStyleColor(ImGuiCol_TableHeaderBg, 0);
  ImGui::PushStyleColor(ImGuiCol_Text, ui_color(theme::dim));
  ImGui::TableHeadersRow();
  ImGui::PopStyleColor(2);
  for (const KindReport& kind : report.kinds) {
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(spaced(kind.kind).c_str());
    ImGui::TableNextColumn();
    ImGui::Text("%zu", kind.count);
    ImGui::TableNextColumn();
    ImGui::Text("%.2g", kind.largest);
    ImGui::TableNextColumn();
    ImGui::Text("%.2g", kind.mean);
  }
  ImGui::EndTable();
}

}  // namespace

void timing_panel(const Simulation& simulation) {
  if (!section("Time per frame")) return;
  const StageTimes mean = recent_mean(simulation.history());
  ImGui::Text("%.2f ms", sum(mean));
  ImGui::SameLine();
  ImGui::TextDisabled("of %.1f ms for real time", 1e3 / simulation.frame_rate());
  stage_bar(mean);
  history_chart(simulation.history(), 1e3 / simulation.frame_rate());
  legend(mean);
}

void numbers_panel(const Simulation& simulation) {
  if (!section("Numbers")) return;
  const StepReport& report = simulation.report();
  value_row("Particles", fmt::format("{}", report.particles));
  value_row("Constraints", fmt::format("{}", report.constraints));
  value_row("Contacts", fmt::format("{}", report.contacts));
  value_row("Deepest contact", fmt::format("{:.2g} mm", 1e3 * report.deepest_contact));
  value_row("Largest strain", fmt::format("{:.2g} %", 100 * report.largest_strain));
  balance_row(report);
  residual_table(report);
  if (report.message.empty() || simulation.failure()) return;
  ImGui::PushStyleColor(ImGuiCol_Text, ui_color(theme::warm));
  ImGui::TextWrapped("%s", report.message.c_str());
  ImGui::PopStyleColor();
}

}  // namespace souple::viewer
