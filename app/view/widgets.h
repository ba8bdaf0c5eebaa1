#pragma once

#include <string>
#include <string_view>
#include <vector>

// Rows of the panels: a name on the left, a control on the right. Every control's id is unique in the panel,
// so no row depends on the ones around it.

namespace souple::viewer {

/// What a slider spans.
struct SliderRange {
  float lo = 0, hi = 1;
  bool logarithmic = false;  ///< then lo > 0; a value of 0 stands at the left end
};

/// A heading that folds; returns whether it is open.
bool section(const char* name, bool open = true);
/// Starts a row; the control that follows fills the rest of the line.
void row(const char* name, const char* hint = nullptr);

/// "3.2e+04 N/m"
std::string with_unit(double value, const char* unit);

// Each returns whether the value was changed. Ctrl + click on a slider types a number.
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
