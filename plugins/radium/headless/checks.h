#pragma once

#include "plugins/radium/headless/window.h"

#include <iostream>
#include <string>

namespace souple::radium {

/// Reports for each check whether it passed.
class Checks {
 public:
  template <class Value>
  void equal(const std::string& what, const Value& is, const Value& expected) {
    std::cout << (is == expected ? "OK    " : "WRONG ") << what << ": " << is;
    if (!(is == expected)) std::cout << ", expected " << expected;
    std::cout << std::endl;
    failed_ += is == expected ? 0 : 1;
  }
  void is_true(const std::string& what, bool is) { equal<std::string>(what, is ? "yes" : "no", "yes"); }
  int failed() const { return failed_; }

 private:
  int failed_ = 0;
};

/// A scene in a window.
struct Show {
  Window& window;
  PhysicsSystem& system;
  std::string file;
  int frames = 100;

  void run(int count) {
    for (int i = 0; i < count; ++i) window.run_frame();
  }
  std::uint64_t steps() { return system.session().steps(); }
};

/// The first frame and paused frames make no steps, each button makes exactly its steps, a reset returns to
/// the start.
void check_buttons(Show& show, Checks& checks);
/// Pictures change from frame to frame, but not while paused.
void check_pictures(Show& show, Checks& checks);
/// After `frames` frames from the start, all positions equal those of a run without Radium, bit for bit.
void check_against_pure_run(Show& show, Checks& checks);
/// Radium's picking returns the visible vertices at known pixels, and a grab grabs them.
void check_picking(Show& show, Checks& checks);

}  // namespace souple::radium
