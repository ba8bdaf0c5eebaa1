#pragma once

#include <string>
#include <vector>

namespace souple::viewer {

/// Messages that appear on screen for some seconds, and in the terminal.
class Notices {
 public:
  /// Information, such as the path of a written picture; also to standard output.
  void say(const std::string& text);
  /// An error; also to standard error. Stays longer.
  void complain(const std::string& text);
  void pass(double seconds);  ///< adds elapsed real time
  /// Draws upward from the lower left corner of the scene's part of the window; legends are at its top.
  void draw(float x, float bottom, float width);

  /// The visible messages, newest last.
  std::vector<std::string> texts() const;

 private:
  struct Notice {
    std::string text;
    bool bad = false;
    double left = 0;  ///< remaining time [s]
  };
  void add(const std::string& text, bool bad);
  std::vector<Notice> notices_;
};

}  // namespace souple::viewer
