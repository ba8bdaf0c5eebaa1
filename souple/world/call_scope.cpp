#include "souple/world/call_scope.h"

#include "souple/error.h"

#include <string>

namespace souple {
namespace {

thread_local const QueryScope* innermost = nullptr;

}  // namespace

void require_callable(const Calls& calls, std::string_view what, From from) {
  const bool queried = calls.queries.load(std::memory_order_relaxed) > 0;
  if (calls.doing == Calls::Doing::nothing && !queried) return;
  if (calls.doing == Calls::Doing::callback && !queried && from == From::stages) return;
  std::string words(what);
  if (!calls.in_step) {
    words += ": not from a function that the world is calling; call it when that has returned";
  } else if (from == From::nowhere) {
    words += ": not while a step runs; call it between steps";
  } else {
    words +=
        ": not while a step runs, but in a callback before or after a stage; call it there, or between steps";
  }
  throw Error(words);
}

void require_readable(const Calls& calls, std::string_view what) {
  if (calls.doing != Calls::Doing::computing) return;
  throw Error(std::string(what) + (calls.in_step
                                       ? ": not while a step computes it; call it in a callback before or "
                                         "after a stage, or between steps"
                                       : ": not from a function that the world is calling; call it "
                                         "when that has returned"));
}

void require_whole(const Calls& calls, std::string_view what) {
  if (calls.broken)
    throw Error(
        std::string(what) +
        ": an exception, such as out of memory, ended an earlier step or change of this world half way; "
        "restore a snapshot, or build the world again");
}

QueryScope::QueryScope(Calls& calls, std::string_view what) : calls_(calls), outer_(innermost) {
  for (const QueryScope* scope = innermost; scope != nullptr; scope = scope->outer_)
    if (&scope->calls_ == &calls)
      throw Error(std::string(what) +
                  ": called by the motion of a collider that a query asked for its pose; let the motion "
                  "compute its pose without queries");
  innermost = this;
  calls_.queries.fetch_add(1, std::memory_order_relaxed);
}

QueryScope::~QueryScope() {
  calls_.queries.fetch_sub(1, std::memory_order_relaxed);
  innermost = outer_;
}

}  // namespace souple
