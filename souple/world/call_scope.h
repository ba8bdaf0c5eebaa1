#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>

namespace souple {

/// Which functions of the user a function of World may be called from; the table in world.h has them all.
enum class From : std::uint8_t {
  nowhere,  ///< only while the world calls no function of the user
  stages,   ///< also from callbacks before and after a stage
};

/// State of a world's calls: refuses a call from a function that the world is calling where it would do harm.
struct Calls {
  enum class Doing : std::uint8_t {
    nothing,   ///< waits for a call
    callback,  ///< a step runs callbacks before or after a stage
    computing  ///< anything else; user functions that are called meanwhile may only read
  };
  Doing doing = Doing::nothing;
  bool in_step = false;                  ///< or in a measurement of parts of one
  bool broken = false;                   ///< an exception left a step or an edit half done; see recover.h
  std::atomic<bool> nested_step{false};  ///< a function that the step called has called step
  std::atomic<int> queries{0};           ///< running; these call motions of colliders

  bool threads_are_busy() const { return in_step && doing == Doing::computing; }
};

/// Throws Error, in the name of the function `what`, if a function that must not call it is running.
void require_callable(const Calls& calls, std::string_view what, From from);

/// Throws Error if something is being computed that the const function `what` reads.
void require_readable(const Calls& calls, std::string_view what);

/// Throws Error if an exception left the world half done.
void require_whole(const Calls& calls, std::string_view what);

/// A call that changes the world, or that calls functions of the user: those may only read meanwhile.
class CallScope {
 public:
  CallScope(Calls& calls, std::string_view what, From from = From::nowhere)
      : CallScope(calls, (require_callable(calls, what, from), require_whole(calls, what),
                          Calls::Doing::computing)) {}
  CallScope(Calls& calls, Calls::Doing doing) : calls_(calls), before_(calls.doing) { calls.doing = doing; }
  ~CallScope() { calls_.doing = before_; }
  CallScope(const CallScope&) = delete;
  CallScope& operator=(const CallScope&) = delete;

 private:
  Calls& calls_;
  Calls::Doing before_;
};

/// A step, or a measurement of parts of one.
class StepScope {
 public:
  explicit StepScope(Calls& calls) : calls_(calls), computing_(calls, Calls::Doing::computing) {
    calls.in_step = true;
  }
  ~StepScope() { calls_.in_step = false; }
  StepScope(const StepScope&) = delete;
  StepScope& operator=(const StepScope&) = delete;

 private:
  Calls& calls_;
  CallScope computing_;
};

/// A const call that calls motions of colliders. Other threads may query at the same time. Throws Error if one of these
/// motions queries in turn, which would never end.
class QueryScope {
 public:
  QueryScope(Calls& calls, std::string_view what);
  ~QueryScope();
  QueryScope(const QueryScope&) = delete;
  QueryScope& operator=(const QueryScope&) = delete;

 private:
  Calls& calls_;
  const QueryScope* outer_;  ///< on this thread
};

}  // namespace souple
