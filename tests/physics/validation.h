#pragma once

#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Output of the analytic cases. script/validation collects the lines and the curves and makes
// docs/validation.md of them. A case is a short sentence, the same for all its quantities and its plot.

namespace souple {

namespace detail {

inline void print_validation(const std::string& name, const std::string& quantity, double measured,
                             const std::string& expected, const std::string& bound) {
  std::printf("VALIDATION|%s|%s|%.6g|%s|%s\n", name.c_str(), quantity.c_str(), measured, expected.c_str(),
              bound.c_str());
  std::fflush(stdout);
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", measured);
  ::testing::Test::RecordProperty(quantity, text);
}

inline std::string number(double value, const char* format = "%.6g") {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace detail

/// Expects |measured - expected| <= bound and prints a line
/// `VALIDATION|case|quantity|measured|expected|bound`. The quantity states its unit: "period at 5 degrees
/// [s]".
inline void validate(const std::string& name, const std::string& quantity, double measured, double expected,
                     double bound) {
  detail::print_validation(name, quantity, measured, detail::number(expected),
                           "+- " + detail::number(bound, "%.3g"));
  EXPECT_NEAR(measured, expected, bound) << name << ": " << quantity;
}

/// Expects |measured - expected| <= a fraction of |expected|: 0.02 is two percent.
inline void validate_relative(const std::string& name, const std::string& quantity, double measured,
                              double expected, double fraction) {
  detail::print_validation(name, quantity, measured, detail::number(expected),
                           "+- " + detail::number(100 * fraction, "%.3g") + " %");
  EXPECT_NEAR(measured, expected, fraction * std::fabs(expected)) << name << ": " << quantity;
}

/// Expects measured <= bound; NaN fails.
inline void validate_below(const std::string& name, const std::string& quantity, double measured,
                           double bound) {
  detail::print_validation(name, quantity, measured, "", "<= " + detail::number(bound, "%.3g"));
  EXPECT_LE(measured, bound) << name << ": " << quantity;
}

/// Prints a measured value without a bound.
inline void state(const std::string& name, const std::string& quantity, double measured) {
  detail::print_validation(name, quantity, measured, "", "stated");
  EXPECT_TRUE(std::isfinite(measured)) << name << ": " << quantity;
}

/// The curves of one case's plot. If the environment variable SOUPLE_VALIDATION_DIR names a folder, they are appended
/// to a CSV file there. The file is named after the case, so that several tests can share a plot. It has three comment
/// lines (case, labels of the axes; "(log)" in a label makes the axis logarithmic), then `series,x,y`. A series whose
/// name begins with "theory" is drawn as a broad gray line, with "bound" dashed, with "experiment" as dots. Others are
/// thin lines with hollow points. If every series has a single point, they are bars.
class Curves {
 public:
  Curves(const std::string& name, const std::string& x_label, const std::string& y_label) {
    const char* folder = std::getenv("SOUPLE_VALIDATION_DIR");
    if (folder == nullptr || *folder == '\0') return;
    std::string file;
    for (const char c : name)
      file += std::isalnum(static_cast<unsigned char>(c)) != 0 ? static_cast<char>(std::tolower(c)) : '_';
    file_.reset(std::fopen((std::string(folder) + "/" + file + ".csv").c_str(), "a"));
    EXPECT_TRUE(file_ != nullptr) << "cannot write to " << folder;
    if (file_)
      std::fprintf(file_.get(), "# case %s\n# x %s\n# y %s\n", name.c_str(), x_label.c_str(),
                   y_label.c_str());
  }

  void add(const std::string& series, double x, double y) {
    if (file_) std::fprintf(file_.get(), "%s,%.9g,%.9g\n", series.c_str(), x, y);
  }
  void add(const std::string& series, const std::vector<double>& x, const std::vector<double>& y) {
    for (std::size_t i = 0; i < x.size() && i < y.size(); ++i) add(series, x[i], y[i]);
  }
  /// Ends the line of a series; its next point starts another line under the same name.
  void lift(const std::string& series) { add(series, std::nan(""), std::nan("")); }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

}  // namespace souple
