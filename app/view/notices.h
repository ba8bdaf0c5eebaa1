#pragma once

#include <string>
#include <vector>

namespace souple::viewer {

/// What is said on screen for a while, and to the terminal for good.
class Notices {
 public:
  /// Good news, such as where a picture was written: also to standard output.
  void say(const std::string& text);
  /// What went wrong: also to standard error. Stays longer.
  void complain(const std::string& text);
  void pass(double seconds);  ///< real time has passed
  /// Upwards from the lower left corner of the part of the window that shows the scene: legends stand above.
  void draw(float x, float bottom, float width);

  /// What stands there now, the newest last.
  std::vector<std::string> texts() const;

 private:
  struct Notice {
    std::string text;
    bool bad = false;
    double left = 0;  ///< s
  };
  void add(const std::string& text, bool bad);
  std::vector<Notice> notices_;
};

}  // namespace souple::viewer
