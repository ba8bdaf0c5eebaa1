#include "souple/io/point_cache_checks.h"

#include "souple/error.h"

#include <fmt/core.h>

namespace souple::point_cache {

namespace {

std::string to_text(const Extent& extent) {
  return fmt::format("{} frames of {} points", extent.frames, extent.points);
}

}  // namespace

std::uint64_t check_points(const std::string& name, std::uint64_t points) {
  if (points < 1 || points > largest_count)
    throw Error(fmt::format("{}: a point cache holds 1 to {} points, not {}", name, largest_count, points));
  return points;
}

void check_header(const std::string& name, const Extent& header) {
  if (header.points < 1 || header.points > largest_count || header.frames > largest_count)
    throw Error(fmt::format(
        "{}: its header says {}; expected 1 to {} points and at most as many frames; it is damaged", name,
        to_text(header), largest_count));
}

void check_size(const std::string& name, const Extent& header, std::uint64_t data) {
  const std::uint64_t frame_size = 12 * header.points;
  if (data % frame_size != 0 || data / frame_size != header.frames)
    throw Error(fmt::format(
        "{}: its header says {}, which does not fit the {} bytes that follow; it is cut short or damaged",
        name, to_text(header), data));
}

void check_resume(const std::string& name, const Extent& held, std::uint64_t points,
                  std::uint64_t keep_frames) {
  if (held.points != points)
    throw Error(fmt::format("{}: holds {} points, the object has {}; resume with the scene that wrote it",
                            name, held.points, points));
  if (held.frames < keep_frames)
    throw Error(fmt::format("{}: holds {} frames, the checkpoint needs {}; start the run again", name,
                            held.frames, keep_frames));
}

void check_append(const std::string& name, const Extent& held, bool open, std::uint64_t given) {
  if (!open) throw Error(name + ": is finished, no frame can be added");
  if (given != held.points)
    throw Error(
        fmt::format("{}: a frame has {} points, the file {}; write an object whose topology changes as a "
                    "sequence (obj or ply)",
                    name, given, held.points));
  if (held.frames >= largest_count)
    throw Error(fmt::format("{}: holds {} frames, the format's limit", name, held.frames));
}

void check_read(const std::string& name, const Extent& held, std::uint64_t frame, std::uint64_t given) {
  if (frame >= held.frames || given != held.points)
    throw Error(fmt::format("{}: frame {} was asked for as {} points; it holds {}", name, frame, given,
                            to_text(held)));
}

}  // namespace souple::point_cache
