#include "souple/host/session/contents.h"
#include "souple/host/session/impl.h"

#include <sstream>
#include <utility>

// Time of the session: host frames, steps, resets.

namespace souple::host {

void Session::Impl::report(std::string message) {
  constexpr std::size_t most = 100;
  const std::lock_guard<std::mutex> lock(mutex);
  messages.push_back(std::move(message));
  if (messages.size() > most) messages.pop_front();
}

void Session::Impl::report_lines(const std::string& lines) {
  std::istringstream rest(lines);
  for (std::string line; std::getline(rest, line);) report(line);
}

void Session::Impl::take_statistics() {
  Statistics now = statistics_of(contents->world(), steps);
  const std::lock_guard<std::mutex> lock(mutex);
  statistics = std::move(now);
}

void Session::Impl::begin_again() {
  hand.reset();
  plane.reset();
  steps = 0;
  flags_before = 0;
  step_requested = false;
  take_statistics();
}

bool Session::Impl::step(double dt) {
  contents->begin_step(dt);
  const StepReport& report = contents->world().step(dt);
  const bool made = report.ok();  // otherwise the world is unchanged
  contents->end_step(made);
  if (made) ++steps;
  playing = playing && made;
  if (!made || (report.flags & ~flags_before) != 0) report_lines(report.message);
  flags_before = report.flags;
  take_statistics();
  return made;
}

Tick Session::advance(double host_time, double frame_dt) {
  Impl& s = *impl_;
  try {
    for (std::string& failure : s.actions.apply(*this)) s.report(std::move(failure));
    const Tick tick = s.clock.frame(host_time, frame_dt);
    if (tick == Tick::reset) {
      reset();
      return tick;
    }
    const bool asked = std::exchange(s.step_requested, false);
    if (!asked && !(tick == Tick::step && s.playing)) return Tick::nothing;
    if (asked) s.playing = false;
    return s.step(s.clock.dt()) ? Tick::step : Tick::nothing;
  } catch (const std::exception& error) {
    s.playing = false;
    s.report(error.what());
    return Tick::nothing;
  }
}

void Session::set_playing(bool playing) {
  impl_->playing = playing;
}
bool Session::playing() const {
  return impl_->playing;
}
void Session::request_step() {
  impl_->step_requested = true;
}

void Session::reset() {
  Impl& s = *impl_;
  const std::uint64_t version_now = version();
  s.contents->rebuild();
  s.version_before = version_now + 1;
  s.begin_again();
}

void Session::start_at(double host_time) {
  impl_->clock.start_at(host_time);
}
double Session::time() const {
  return impl_->contents->world().time();
}
std::uint64_t Session::steps() const {
  return impl_->steps;
}
std::uint64_t Session::version() const {
  return impl_->version_before + impl_->contents->world().version();
}
std::uint64_t Session::hash() const {
  return impl_->contents->world().hash();
}

}  // namespace souple::host
