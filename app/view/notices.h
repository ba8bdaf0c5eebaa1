#pragma once

#include <string>
#include <vector>

namespace souple::viewer {

/// Messages that are shown on screen for some seconds and printed to the terminal.
class Notices {
 public:
  /// Information, such as the file of a picture; printed to standard output.
  void info(const std::string& text);
  /// An error; printed to standard error and shown longer.
  void error(const std::string& text);
  void advance(double seconds);  ///< removes messages whose time has passed
  /// Draws upwards from the lower left corner of the part of the window that shows the scene; legends are
  /// above.
  void draw(float x, float bottom, float width);

  /// The messages on screen, newest last.
  std::vector<std::string> texts() const;

 private:
  struct Notice {
    std::string text;
    bool is_error = false;
    double remaining = 0;  ///< s
  };
  void add(const std::string& text, bool is_error);
  std::vector<Notice> notices_;
};

}  // namespace souple::viewer
