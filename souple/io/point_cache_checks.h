#pragma once

#include <cstdint>
#include <limits>
#include <string>

/// Checks shared by PC2 and MDD, which store frames of a fixed number of points with int32 counts. Each check
/// throws Error; `name` is the file's name.
namespace souple::point_cache {

inline constexpr std::uint64_t largest_count = std::numeric_limits<std::int32_t>::max();

/// Actual or declared content of a file.
struct Extent {
  std::uint64_t points;
  std::uint64_t frames;
};

/// Returns `points`; throws unless it is from 1 to largest_count.
std::uint64_t check_points(const std::string& name, std::uint64_t points);
/// The numbers of the header are possible.
void check_header(const std::string& name, const Extent& header);
/// The header's frames have exactly `data` bytes.
void check_size(const std::string& name, const Extent& header, std::uint64_t data);
/// A file with the content `held` can continue with `points` after `keep_frames`.
void check_resume(const std::string& name, const Extent& held, std::uint64_t points,
                  std::uint64_t keep_frames);
/// A frame of `given` points can be appended to the content `held`.
void check_append(const std::string& name, const Extent& held, bool open, std::uint64_t given);
/// Frame `frame` can be read into `given` points.
void check_read(const std::string& name, const Extent& held, std::uint64_t frame, std::uint64_t given);

}  // namespace souple::point_cache
