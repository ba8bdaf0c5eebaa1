#include "souple/state/warnings.h"

#include <algorithm>

namespace souple {

std::string_view advice(Flag flag) {
  switch (flag) {
    case Flag::non_finite:
      return "a position or velocity is not finite; the last valid state was restored: raise substeps, "
             "lower the stiffness, or check for extreme masses and forces";
    case Flag::large_strain:
      return "an edge or a membrane is stretched by more than 10 %: raise substeps; a higher stiffness helps "
             "only "
             "where the solver reaches that of the material";
    case Flag::deep_contact:
      return "a contact is deeper than the largest thickness after the step: raise substeps or the thickness";
    case Flag::callback_failed:
      return "a callback threw an exception: its effect was left out";
    case Flag::intersecting:
      return "surfaces pass through each other and are being separated as far as they can move: start "
             "without intersections, drive them apart, or disable collision between them";
    case Flag::coarse_substeps:
      return "a fluid moves by more than a third of its spacing in a substep, or its depth and pressure "
             "allow such a motion: raise substeps or the spacing";
    case Flag::not_converged:
      return "the solver has not converged, so the material appears too soft: raise substeps, or use the "
             "solver "
             "automatic";
    case Flag::shortened_motion:
      return "an object moves too far in a substep for its contacts, or is driven into something that cannot "
             "give way, so its motion was shortened: lower its speed, or raise substeps";
    case Flag::out_of_range:
      return "an object is farther than 1e9 m from the origin, where floats are 64 m apart and contacts may "
             "be missed: check its speed and the forces on it, or remove it";
    case Flag::jumped:
      return "a looped motion restarts at another pose, and objects may be inside what jumps there: let the "
             "last keyframe equal the first, or leave `loop` out";
  }
  return "?";
}

void Warnings::begin_step() {
  std::swap(before_, now_);
  now_.clear();
}

void Warnings::report(std::uint32_t flags, std::string_view words) {
  flags_ |= flags;
  if (!message_.empty()) message_ += '\n';
  message_ += words;
}

void Warnings::log(LogLevel level, std::string_view words) {
  if (!log_) return;
  const auto note = [this](std::string_view why) {
    if (log_failure_.empty()) log_failure_ = "the log function threw" + std::string(why);
  };
  try {
    log_(level, words);
  } catch (const std::exception& error) {
    note(std::string(": ") + error.what());
  } catch (...) {
    note(" an exception that is not a std::exception");
  }
}

void Warnings::report_log_failure() {
  if (log_failure_.empty()) return;
  report(static_cast<std::uint32_t>(Flag::callback_failed), log_failure_);
  log_failure_.clear();
}

void Warnings::warn(Flag flag, std::string_view words) {
  tell(static_cast<std::uint32_t>(flag), flag == Flag::non_finite ? LogLevel::error : LogLevel::warning,
       words);
}

void Warnings::refuse(std::string_view words) {
  tell(0, LogLevel::error, words);
}

void Warnings::tell(std::uint32_t flags, LogLevel level, std::string_view words) {
  if (message_.find(words) != std::string::npos) {
    flags_ |= flags;
    return;
  }
  report(flags, words);
  if (!log_) return;
  std::string name(words);  // its numbers differ from step to step
  name.erase(std::remove_if(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; }),
             name.end());
  const auto holds = [&](const std::vector<std::string>& list) {
    return std::find(list.begin(), list.end(), name) != list.end();
  };
  const bool is_new = !holds(before_) && !holds(now_);
  now_.push_back(std::move(name));
  if (is_new) log(level, words);
}

void Warnings::log_info(const std::string& name, const std::vector<std::string>& sentences) {
  if (!log_) return;
  for (const std::string& sentence : sentences) log(LogLevel::info, name + ": " + sentence);
}

}  // namespace souple
