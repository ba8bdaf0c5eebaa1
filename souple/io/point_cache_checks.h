#pragma once

#include <cstdint>
#include <limits>
#include <string>

/// What PC2 and MDD have in common: a fixed number of points, frame after frame, counted in int32. Each check
/// throws Error; `name` is the file's.
namespace souple::point_cache {

inline constexpr std::uint64_t largest_count = std::numeric_limits<std::int32_t>::max();

/// How much a file holds, or is said to hold.
struct Extent {
  std::uint64_t points;
  std::uint64_t frames;
};

/// Returns `points`, from 1 to largest_count.
std::uint64_t check_points(const std::string& name, std::uint64_t points);
/// What a header says is possible at all.
void check_header(const std::string& name, const Extent& header);
/// `data` bytes of frames are just what the header says.
void check_size(const std::string& name, const Extent& header, std::uint64_t data);
/// A file that holds `held` can go on with `points` after `keep_frames`.
void check_resume(const std::string& name, const Extent& held, std::uint64_t points,
                  std::uint64_t keep_frames);
/// A frame of `given` points can be appended to what is `held`.
void check_append(const std::string& name, const Extent& held, bool open, std::uint64_t given);
/// Frame `frame` can be read into `given` points.
void check_read(const std::string& name, const Extent& held, std::uint64_t frame, std::uint64_t given);

}  // namespace souple::point_cache
