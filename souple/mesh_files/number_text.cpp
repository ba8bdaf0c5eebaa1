#include "souple/mesh_files/number_text.h"

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <system_error>

#include <fmt/core.h>

namespace souple::mesh_detail {

#ifdef __cpp_lib_to_chars

namespace {

// from_chars reports both 1e-400 and 1e400 as out of range; the first becomes 0 here.
bool is_tiny(std::string_view word) {
  const std::size_t exponent = word.find_first_of("eE");
  if (exponent == std::string_view::npos) return word.substr(0, 1) == "0" || word.substr(0, 1) == ".";
  return word.substr(exponent + 1, 1) == "-";
}

}  // namespace

bool parse_unsigned_real(std::string_view text, double& value) {
  if (text.empty() || text[0] == '-') return false;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (rest != text.data() + text.size()) return false;
  if (error == std::errc::result_out_of_range && is_tiny(text))
    value = 0.0;
  else if (error != std::errc())
    return false;
  return std::isfinite(value);
}

void append_real(std::string& out, float value) {
  char digits[32];
  const auto result = std::to_chars(digits, digits + sizeof digits, value);
  out.append(digits, result.ptr);
}

#else

bool parse_unsigned_real(std::string_view text, double& value) {
  return parse_unsigned_real_portably(text, value);
}
void append_real(std::string& out, float value) {
  append_real_portably(out, value);
}

#endif

// strtod reads as much, but also signs, blanks, hexadecimal digits and names, and the locale's decimal point: WebAssembly's
// C library has only that of C.
bool parse_unsigned_real_portably(std::string_view text, double& value) {
  if (text.empty() || text[0] == '-' || text[0] == '+') return false;
  if (text.find_first_not_of("0123456789.eE+-") != std::string_view::npos) return false;
  const std::string copy(text);
  char* end = nullptr;
  value = std::strtod(copy.c_str(), &end);
  if (end != copy.c_str() + copy.size()) return false;
  return std::isfinite(value);
}

void append_real_portably(std::string& out, float value) {
  constexpr float exact = 16777216;  // from here on the digits of a fixed text are those of the integer
  const std::string shortest = fmt::format("{}", std::abs(value));
  if (!std::isfinite(value)) {
    out += fmt::format("{}", value);
    return;
  }
  // Digits without zeros around them, and the power of ten of the first one.
  std::string digits;
  int power = 0;
  bool point = false;
  std::size_t i = 0;
  for (; i < shortest.size() && shortest[i] != 'e'; ++i) {
    if (shortest[i] == '.') {
      point = true;
    } else if (!digits.empty() || shortest[i] != '0') {
      if (!point && !digits.empty()) ++power;
      digits += shortest[i];
    } else if (point) {
      --power;
    }
  }
  if (i < shortest.size()) power += std::atoi(shortest.c_str() + i + 1);
  if (!digits.empty() && shortest[0] == '0') --power;
  while (digits.size() > 1 && digits.back() == '0') digits.pop_back();
  if (digits.empty()) digits = "0", power = 0;

  std::string scientific = digits.substr(0, 1);
  if (digits.size() > 1) scientific += "." + digits.substr(1);
  scientific += fmt::format("e{}{:02}", power < 0 ? '-' : '+', std::abs(power));
  std::string fixed;
  const auto count = static_cast<int>(digits.size());
  if (std::abs(value) >= exact) {
    fixed = fmt::format("{:.0f}", std::abs(value));
  } else if (power < 0) {
    fixed = "0." + std::string(static_cast<std::size_t>(-power - 1), '0') + digits;
  } else if (power + 1 >= count) {
    fixed = digits + std::string(static_cast<std::size_t>(power + 1 - count), '0');
  } else {
    fixed = digits;
    fixed.insert(static_cast<std::size_t>(power + 1), ".");
  }
  if (std::signbit(value)) out += '-';
  out += fixed.size() <= scientific.size() ? fixed : scientific;
}

}  // namespace souple::mesh_detail
