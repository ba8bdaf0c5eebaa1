#include "souple/host/session/contents.h"
#include "souple/host/session/impl.h"

#include <fmt/format.h>

namespace souple::host {

Statistics statistics_of(const World& world, std::uint64_t steps) {
  const StepReport& report = world.report();
  Statistics s;
  s.steps = steps;
  s.time = world.time();
  s.objects = world.objects().size();
  s.warnings = report.message;
  if (steps == 0) return s;  // this world has no step to report, or only a refusal
  s.milliseconds = report.total_milliseconds();
  for (std::size_t i = 0; i < stage_count; ++i)
    s.stages.push_back({std::string(stage_name(static_cast<Stage>(i))), report.milliseconds[i]});
  s.particles = report.particles;
  s.constraints = report.constraints;
  s.contacts = report.contacts;
  s.asleep = report.asleep;
  s.largest_strain = report.largest_strain;
  s.deepest_contact = report.deepest_contact;
  return s;
}

std::string Statistics::text() const {
  if (steps == 0)
    return fmt::format("{} objects, no step yet{}{}", objects, warnings.empty() ? "" : "\n", warnings);
  std::string lines = fmt::format("step {}, {:.3f} s\n{} objects, {} particles, {} constraints\n", steps,
                                  time, objects, particles, constraints);
  lines += fmt::format("{} contacts, {} objects asleep\n", contacts, asleep);
  lines += fmt::format("stretched by {:.1f} %, contacts {:.2f} mm deep\n", 100 * largest_strain,
                       1000 * deepest_contact);
  lines += fmt::format("{:.2f} ms a step", milliseconds);
  for (const Stage& stage : stages) lines += fmt::format("\n  {} {:.2f}", stage.name, stage.milliseconds);
  if (!warnings.empty()) lines += "\n" + warnings;
  return lines;
}

}  // namespace souple::host
