#pragma once

#include <string>

#include <fmt/core.h>

namespace souple::app {

/// A part as a percentage with two digits: "0.35 %", "9.8 %", "120 %".
inline std::string percent(double part) {
  const double p = 100 * part;
  if (p > 0 && p < 0.01) return "less than 0.01 %";
  return p < 10 ? fmt::format("{:.2g} %", p) : fmt::format("{:.0f} %", p);
}

}  // namespace souple::app
