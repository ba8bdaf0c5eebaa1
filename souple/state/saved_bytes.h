#pragma once

#include "souple/error.h"
#include "souple/math/quaternion.h"
#include "souple/math/vec4.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

// Plain values as bytes, for snapshots.

namespace souple {

/// Appends values to bytes. Only values without padding: the bytes of padding are arbitrary.
class SavedBytesWriter {
 public:
  explicit SavedBytesWriter(std::vector<std::byte>& out) : out_(out) {}

  template <class T>
  void put(const T& value) {
    put_all(std::span<const T>(&value, 1));
  }
  template <class T>
  void put_all(std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto bytes = std::as_bytes(values);
    out_.insert(out_.end(), bytes.begin(), bytes.end());
  }
  /// Appends the tag and the number of bytes that `write` appends, then these.
  template <class Function>
  void section(std::uint64_t tag, const Function& write) {
    put(tag);
    const std::size_t at = out_.size();
    put(std::uint64_t{0});
    write();
    const std::uint64_t size = out_.size() - at - sizeof(std::uint64_t);
    std::memcpy(&out_[at], &size, sizeof size);
  }

 private:
  std::vector<std::byte>& out_;
};

/// Reads what a SavedBytesWriter wrote, without trust in the bytes. Where they are too few, or not what was asked for,
/// its functions throw Error with the name of the section.
class SavedBytes {
 public:
  SavedBytes(std::span<const std::byte> bytes, std::string_view name) : bytes_(bytes), name_(name) {}

  template <class T>
  void get(T& value) {
    get_all(std::span<T>(&value, 1));
  }
  /// Any other byte than 0 and 1 would be undefined behavior.
  void get(bool& value) {
    std::uint8_t byte = 0;
    get(byte);
    require(byte <= 1);
    value = byte == 1;
  }
  template <class T>
  void get_all(std::span<T> values) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_same_v<T, bool>);
    require(values.size_bytes() <= bytes_.size());
    if (!values.empty()) std::memcpy(values.data(), bytes_.data(), values.size_bytes());
    bytes_ = bytes_.subspan(values.size_bytes());
  }
  /// So many values. A number that comes from the bytes themselves allocates no more than there are bytes.
  template <class T>
  std::vector<T> get_list(std::uint64_t count) {
    require(count <= bytes_.size() / sizeof(T));
    std::vector<T> values(static_cast<std::size_t>(count));
    get_all(std::span(values));
    return values;
  }
  /// The next section, which must have this tag.
  SavedBytes section(std::uint64_t tag, std::string_view name) {
    std::uint64_t found = 0, size = 0;
    get(found), get(size);
    if (found != tag || size > bytes_.size()) SavedBytes({}, name).refuse();
    const SavedBytes result(bytes_.first(static_cast<std::size_t>(size)), name);
    bytes_ = bytes_.subspan(static_cast<std::size_t>(size));
    return result;
  }
  std::size_t size() const { return bytes_.size(); }
  void require_end() const { require(bytes_.empty()); }
  void require(bool valid) const {
    if (!valid) refuse();
  }
  [[noreturn]] void refuse() const {
    throw Error("restore: the snapshot is damaged: its " + std::string(name_) +
                " are not those of such a world");
  }

 private:
  std::span<const std::byte> bytes_;
  std::string_view name_;
};

/// The tag of a section: eight letters.
constexpr std::uint64_t section_tag(const char (&letters)[9]) {
  std::uint64_t tag = 0;
  for (int k = 7; k >= 0; --k)
    tag = tag << 8 | static_cast<std::uint64_t>(static_cast<unsigned char>(letters[k]));
  return tag;
}

// Whether all numbers of a record are finite.
inline bool all_finite(double x) {
  return std::isfinite(x);
}
template <class T>
requires std::is_enum_v<T>
bool all_finite(T) {
  return true;
}
inline bool all_finite(const Quatd& q) {
  return std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z) && std::isfinite(q.w);
}
/// Whether the length is 1, but for rounding.
inline bool is_rotation(const Quatd& q) {
  return all_finite(q) && std::abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1) < 1e-3;
}
template <class T>
bool all_finite(const Vec3<T>& x) {
  return is_finite(x);
}
inline bool all_finite(const Vec4f& x) {
  return is_finite(x.xyz()) && std::isfinite(x.w);
}
template <class T, std::size_t n>
bool all_finite(const std::array<T, n>& values) {
  for (const T& value : values)
    if (!all_finite(value)) return false;
  return true;
}
template <class T>
bool all_finite(const std::vector<T>& values) {
  for (const T& value : values)
    if (!all_finite(value)) return false;
  return true;
}

}  // namespace souple
