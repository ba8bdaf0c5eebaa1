#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <new>
#include <string>
#include <string_view>
#include <vector>

namespace souple {

/// Warnings of a step. `advice` names the setting that helps.
enum class Flag : std::uint32_t {
  /// A position or velocity became NaN or infinite; the last valid state was restored.
  non_finite = 1u << 0,
  /// An edge or a membrane is stretched by more than 10 %. Not converged: raise substeps, a higher
  /// stiffness changes little. Converged: raise the stiffness, or lower the load. Unless the stretch
  /// is intended. Tets are left out: soft bodies are meant to deform.
  large_strain = 1u << 1,
  /// A contact is deeper than the largest thickness after the step: raise substeps or the thickness.
  deep_contact = 1u << 2,
  /// A user's callback threw; its effect was left out.
  callback_failed = 1u << 3,
  /// Edges pass through triangles, and the step resolves them gradually: start without intersections.
  intersecting = 1u << 4,
  /// A fluid is too deep or too fast for its spacing and the substep: raise substeps.
  coarse_substeps = 1u << 5,
  /// The deformation of an object needs forces far larger than those that it carries (ObjectReport):
  /// raise substeps, or use the solver `automatic`. The message names the object.
  not_converged = 1u << 6,
  /// Something moves so far in a substep that contacts cannot follow it, or is driven into something that cannot give
  /// way. Its motion was shortened, so it loses speed; what is driven lags behind. Lower the speed, or raise substeps. The
  /// message names the object and its speed.
  shortened_motion = 1u << 7,
  /// A particle is farther than 1e9 m from the origin, along an axis. Floats are 64 m apart there, and contacts may be
  /// missed. Check speeds, forces and `drag`, or give it a floor. The message names the object, the vertex and its speed.
  out_of_range = 1u << 8,
  /// A looped motion has restarted at another pose. The obstacle, collider or body was not there in between, so contacts
  /// did not see it move. Let the last keyframe equal the first. The message names it.
  jumped = 1u << 9
};
/// One line: meaning of the flag and the setting that helps.
std::string_view advice(Flag flag);

enum class LogLevel { info, warning, error };

/// Warnings of a step, for its report and for the log of the user.
class Warnings {
 public:
  /// Sets bits of `flags` and appends lines to `message`: those of the step's report, which must live as long.
  Warnings(std::uint32_t& flags, std::string& message) : flags_(flags), message_(message) {}
  void set_log(std::function<void(LogLevel, std::string_view)> log) { log_ = std::move(log); }
  /// Call before each step, whose report is empty.
  void begin_step();
  /// Sets a flag of the report and appends a line to its message. The log has it if neither the last step nor this one
  /// had it before, but for its numbers.
  void warn(Flag flag, std::string_view words);
  /// As `warn`, without a flag: why a step did nothing. The log has it as an error.
  void refuse(std::string_view words);
  /// Logs notes about an object, such as repairs of its mesh.
  void log_info(const std::string& name, const std::vector<std::string>& sentences);
  /// At the end of a step: sets Flag::callback_failed if the log function has thrown since the last one. Its exception
  /// goes no further.
  void report_log_failure();
  /// Runs code that may throw, such as users' callbacks; an exception sets Flag::callback_failed. Only out of memory
  /// passes.
  template <class Function>
  void guarded(std::string_view what, const Function& f) {
    try {
      f();
    } catch (const std::bad_alloc&) {
      throw;  // not the callback's fault: the step cannot go on
    } catch (const std::exception& error) {
      warn(Flag::callback_failed, std::string(what) + " threw: " + error.what());
    } catch (...) {
      warn(Flag::callback_failed, std::string(what) + " threw an exception that is not a std::exception");
    }
  }

 private:
  void log(LogLevel level, std::string_view words);
  void report(std::uint32_t flags, std::string_view words);
  void tell(std::uint32_t flags, LogLevel level, std::string_view words);

  std::uint32_t& flags_;
  std::string& message_;
  std::function<void(LogLevel, std::string_view)> log_;
  std::string log_failure_;                // the first since the last step
  std::vector<std::string> before_, now_;  // warnings of the last and of this step, without their numbers
};

}  // namespace souple
