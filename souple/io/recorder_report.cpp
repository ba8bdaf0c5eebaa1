#include "souple/io/recorder_report.h"

#include "souple/solver/solver_names.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace souple {

namespace {

/// The shortest text that reads back to the same number.
template <class T>
std::string number(T value) {
  return std::isfinite(value) ? fmt::format("{}", value) : "null";
}

std::string vector(const Vec3f& v) {
  return "[" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + "]";
}

constexpr std::pair<const char*, Integrator> integrator_names[] = {
    {"semi_implicit", Integrator::semi_implicit},
    {"explicit_euler", Integrator::explicit_euler},
    {"implicit_euler", Integrator::implicit_euler}};

constexpr std::pair<Flag, const char*> flag_names[] = {
    {Flag::non_finite, "non_finite"},       {Flag::large_strain, "large_strain"},
    {Flag::deep_contact, "deep_contact"},   {Flag::callback_failed, "callback_failed"},
    {Flag::intersecting, "tangled"},        {Flag::coarse_substeps, "coarse_substeps"},
    {Flag::not_converged, "not_converged"}, {Flag::shortened_motion, "shortened_motion"},
    {Flag::out_of_range, "out_of_range"},   {Flag::jumped, "jumped"}};

/// Several projectors may be of one kind: largest of the largest, mean over all constraints.
std::vector<KindReport> by_kind(const std::vector<KindReport>& reports) {
  std::vector<KindReport> kinds;
  for (const KindReport& report : reports) {
    const auto same =
        std::find_if(kinds.begin(), kinds.end(), [&](const auto& k) { return k.kind == report.kind; });
    if (same == kinds.end()) {
      kinds.push_back(report);
      continue;
    }
    const double a = static_cast<double>(same->count), b = static_cast<double>(report.count);
    if (a + b > 0) same->mean = (a * same->mean + b * report.mean) / (a + b);
    same->count += report.count;
    same->largest = std::max(same->largest, report.largest);
  }
  return kinds;
}

}  // namespace

std::string settings_text(const Settings& s) {
  std::string text = fmt::format(R"({{"substeps": {}, "iterations": {}, "mode": "{}", )", s.substeps,
                                 s.iterations, name_in(mode_names, s.mode));
  text += fmt::format(R"("integrator": "{}", "gravity": {}, )", name_in(integrator_names, s.integrator),
                      vector(s.gravity));
  text += fmt::format(R"("wind": {{"velocity": {}, "gust": {}, "gust_period": {}, "air_density": {}}}, )",
                      vector(s.wind.velocity), number(s.wind.gust), number(s.wind.gust_period),
                      number(s.wind.air_density));
  text += fmt::format(R"("drag": {}, "seed": {}}})", number(s.drag), s.seed);
  return text;
}

FrameReport frame_report(std::uint64_t frame, double time, const StepReport& report) {
  FrameReport kept;
  kept.frame = frame;
  kept.time = time;
  if (report.outcome == StepOutcome::refused) kept.flags.emplace_back("refused");
  if (report.step == 0) return kept;
  kept.values = {{"particles", static_cast<double>(report.particles)},
                 {"constraints", static_cast<double>(report.constraints)},
                 {"contacts", static_cast<double>(report.contacts)},
                 {"deepest_contact", report.deepest_contact},
                 {"largest_strain", report.largest_strain}};
  if (report.fluid.particles > 0) {
    const FluidReport& fluid = report.fluid;
    kept.values.emplace_back("fluid.particles", static_cast<double>(fluid.particles));
    kept.values.emplace_back("fluid.emitted", static_cast<double>(fluid.emitted));
    kept.values.emplace_back("fluid.drained", static_cast<double>(fluid.drained));
    kept.values.emplace_back("fluid.mean_density_error", fluid.mean_density_error);
    kept.values.emplace_back("fluid.largest_density_error", fluid.largest_density_error);
    kept.values.emplace_back("fluid.largest_pressure", fluid.largest_pressure);
    kept.values.emplace_back("fluid.fastest", fluid.fastest);
    kept.values.emplace_back("fluid.largest_step", fluid.largest_step);
    kept.values.emplace_back("fluid.iterations", fluid.iterations);
    kept.values.emplace_back("fluid.coarse_iterations", fluid.coarse_iterations);
    kept.values.emplace_back("fluid.viscosity_iterations", fluid.viscosity_iterations);
    kept.values.emplace_back("fluid.spray", static_cast<double>(fluid.spray));
    kept.values.emplace_back("fluid.foam", static_cast<double>(fluid.foam));
    kept.values.emplace_back("fluid.bubbles", static_cast<double>(fluid.bubbles));
  }
  for (const KindReport& kind : by_kind(report.kinds)) {
    kept.values.emplace_back("residual." + std::string(kind.kind), kind.largest);
    kept.values.emplace_back("mean_residual." + std::string(kind.kind), kind.mean);
  }
  for (const ObjectReport& object : report.objects) {
    kept.values.emplace_back("unbalanced." + object.name, object.unbalanced);
    kept.values.emplace_back("stretch." + object.name, object.stretch);
  }
  for (const auto& [flag, name] : flag_names) {
    if (report.has(flag)) kept.flags.emplace_back(name);
  }
  for (std::size_t stage = 0; stage < stage_count; ++stage)
    kept.milliseconds.emplace_back(stage_name(static_cast<Stage>(stage)), report.milliseconds[stage]);
  return kept;
}

}  // namespace souple
