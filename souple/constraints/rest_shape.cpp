#include "souple/constraints/rest_shape.h"

#include <cmath>

#include <fmt/core.h>

namespace souple::detail {

void require_valid_rest_shape(double measure, double regular, const char* what) {
  if (measure > 1e-6 * regular) return;
  throw Error(
      fmt::format("{}: the rest shape is {}: its area or volume is below a millionth of that of a regular "
                  "shape of equal size; remove the element or repair the mesh",
                  what, measure < 0 ? "inside out" : "degenerate"));
}

void require_in(double value, double low, double high, const char* what) {
  if (value >= low && value < high) return;
  throw Error(fmt::format("{} is {:g}: expected a number from {:g} to below {:g}", what, value, low, high));
}

void require_positive(double value, const char* what) {
  if (value > 0 && std::isfinite(value)) return;
  throw Error(fmt::format("{} is {:g}: expected a positive number", what, value));
}

}  // namespace souple::detail
