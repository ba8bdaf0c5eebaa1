#include "souple/mesh_files/mesh_bytes.h"

#include "souple/error.h"
#include "souple/mesh_files/mesh_text.h"

#include <cmath>

#include <fmt/core.h>

namespace souple::mesh_detail {

std::int64_t ByteScanner::integer(NumberType type, const char* what) {
  switch (type) {
    case NumberType::int8:
      return read<std::int8_t>(what);
    case NumberType::uint8:
      return read<std::uint8_t>(what);
    case NumberType::int16:
      return read<std::int16_t>(what);
    case NumberType::uint16:
      return read<std::uint16_t>(what);
    case NumberType::int32:
      return read<std::int32_t>(what);
    case NumberType::uint32:
      return read<std::uint32_t>(what);
    case NumberType::int64:
      return read<std::int64_t>(what);
    default:
      return static_cast<std::int64_t>(read<std::uint64_t>(what));
  }
}

float ByteScanner::real32(const char* what) {
  const float value = read<float>(what);
  require_coordinate(double(value), what);
  return value;
}

double ByteScanner::real64(const char* what) {
  const double value = read<double>(what);
  require_coordinate(value, what);
  return value;
}

void ByteScanner::require_coordinate(double value, const char* what) const {
  if (!(std::abs(value) <= largest_coordinate)) {
    fail(fmt::format("{:g}", value), fmt::format("a finite number within 1e18 ({})", what));
  }
}

void ByteScanner::require_room(std::uint64_t count, std::size_t bytes_each, const char* what) const {
  const std::uint64_t room = remaining() / bytes_each;
  if (count > room) {
    fail(fmt::format("{} ({})", count, what),
         fmt::format("at most {}, for which the file is long enough; it is cut short or its count is wrong",
                     room));
  }
}

void ByteScanner::fail_end(const char* what) const {
  fail("the end of the file", what);
}

void ByteScanner::fail(std::string_view found, std::string_view expected) const {
  throw Error(fmt::format("{}: byte {}: found {}, expected {}", name_, first_ + at_, found, expected));
}

}  // namespace souple::mesh_detail
