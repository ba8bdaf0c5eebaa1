#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace souple::app {

/// A part as a percentage with two digits: "0.35 %", "9.8 %", "120 %".
inline std::string percent(double part) {
  const double p = 100 * part;
  if (p > 0 && p < 0.01) return "less than 0.01 %";
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), p < 10 ? "%.2g %%" : "%.0f %%", p);
  return text.data();
}

}  // namespace souple::app
