#pragma once

#include <string>
#include <string_view>
#include <vector>

// Rows of the panels: a name on the left, a control on the right. Every control's id is unique in the panel,
// so a row does not depend on its neighbors.

namespace souple::viewer {

/// Range of a slider.
struct SliderRange {
  float lo = 0, hi = 1;
  bool logarithmic = false;  ///< requires lo > 0; a value of 0 appears at the left end
};

/// A collapsible heading; returns whether it is open.
bool section(const char* name, bool open = true);
/// Starts a row; the following control fills the rest of the line.
void row(const char* name, const char* hint = nullptr);

/// "3.2e+04 N/m"
std::string with_unit(double value, const char* unit);

// Each returns whether the value changed. Ctrl + click on a slider opens a field to type the number.
bool slider_row(const char* name, const std::string& id, float& value, const SliderRange& range,
                const char* unit, const char* hint = nullptr);
bool count_row(const char* name, const std::string& id, int& value, int lo, int hi,
               const char* hint = nullptr);
bool vector_row(const char* name, const std::string& id, float (&value)[3], float speed, const char* unit);
bool choice_row(const char* name, const std::string& id, int& value, const std::vector<const char*>& choices,
                const char* hint = nullptr);
bool check_row(const char* name, const std::string& id, bool& value);

void value_row(const char* name, const std::string& value);

}  // namespace souple::viewer
