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

/// A scene that is shown in a window.
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

/// The first frame and paused ones make no steps, the buttons exactly theirs, a reset leads back to the
/// start.
void check_buttons(Show& show, Checks& checks);
/// A picture changes from frame to frame, and not while paused.
void check_pictures(Show& show, Checks& checks);
/// After `frames` frames from the start all is, bit for bit, where a run without Radium is.
void check_against_pure_run(Show& show, Checks& checks);
/// What Radium's picking names at known pixels is the vertex that lies there, and a grab takes hold of it.
void check_picking(Show& show, Checks& checks);

}  // namespace souple::radium
