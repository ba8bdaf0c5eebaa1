#pragma once

#include "souple/files/endian.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace souple::mesh_detail {

static_assert(sizeof(float) == 4 && sizeof(double) == 8);

/// Types of numbers in files; those before float32 are integers.
enum class NumberType { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

constexpr bool is_integer(NumberType type) {
  return type < NumberType::float32;
}
constexpr std::size_t size_of(NumberType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

/// Reads consecutive numbers from bytes in memory.
class ByteScanner {
 public:
  /// `first`: offset of `bytes` in the file, for error messages.
  ByteScanner(std::string_view bytes, const std::string& name, bool big_endian, std::size_t first = 0)
      : bytes_(bytes), name_(name), big_endian_(big_endian), first_(first) {}

  std::size_t remaining() const { return bytes_.size() - at_; }

  /// Throws Error at the end of the file; `what` names the number in the message.
  template <class T>
  T read(const char* what) {
    require(sizeof(T), what);
    const auto* bytes = reinterpret_cast<const std::byte*>(bytes_.data() + at_);
    at_ += sizeof(T);
    return big_endian_ ? load<ByteOrder::big, T>(bytes) : load<ByteOrder::little, T>(bytes);
  }
  /// A number of an integer type; beyond 2^63 it wraps around.
  std::int64_t integer(NumberType type, const char* what);
  float real32(const char* what);   ///< a finite float within largest_coordinate
  double real64(const char* what);  ///< a finite double within largest_coordinate

  void skip(std::size_t bytes, const char* what) {
    require(bytes, what);
    at_ += bytes;
  }

  /// Throws Error unless the rest of the file can hold `count` items of at least `bytes_each` bytes.
  void require_room(std::uint64_t count, std::size_t bytes_each, const char* what) const;

  /// Throws Error "NAME: byte N: found FOUND, expected EXPECTED"; N is the end of the last number.
  [[noreturn]] void fail(std::string_view found, std::string_view expected) const;

 private:
  void require(std::size_t bytes, const char* what) const {
    if (bytes > remaining()) fail_end(what);
  }
  void require_coordinate(double value, const char* what) const;
  [[noreturn]] void fail_end(const char* what) const;

  std::string_view bytes_;
  std::string name_;
  bool big_endian_;
  std::size_t first_;
  std::size_t at_ = 0;
};

}  // namespace souple::mesh_detail
