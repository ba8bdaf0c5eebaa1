#include "souple/io/point_cache_checks.h"

#include "souple/error.h"

namespace souple::point_cache {

namespace {

std::string to_text(const Extent& extent) {
  return std::to_string(extent.frames) + " frames of " + std::to_string(extent.points) + " points";
}

}  // namespace

std::uint64_t check_points(const std::string& name, std::uint64_t points) {
  if (points < 1 || points > largest_count)
    throw Error(name + ": a point cache holds 1 to " + std::to_string(largest_count) + " points, not " +
                std::to_string(points));
  return points;
}

void check_header(const std::string& name, const Extent& header) {
  if (header.points < 1 || header.points > largest_count || header.frames > largest_count)
    throw Error(name + ": its header says " + to_text(header) + "; expected 1 to " +
                std::to_string(largest_count) + " points and at most as many frames; it is damaged");
}

void check_size(const std::string& name, const Extent& header, std::uint64_t data) {
  const std::uint64_t frame_size = 12 * header.points;
  if (data % frame_size != 0 || data / frame_size != header.frames)
    throw Error(name + ": its header says " + to_text(header) + ", which does not fit the " +
                std::to_string(data) + " bytes that follow; it is cut short or damaged");
}

void check_resume(const std::string& name, const Extent& held, std::uint64_t points,
                  std::uint64_t keep_frames) {
  if (held.points != points)
    throw Error(name + ": holds " + std::to_string(held.points) + " points, the object has " +
                std::to_string(points) + "; resume with the scene that wrote it");
  if (held.frames < keep_frames)
    throw Error(name + ": holds " + std::to_string(held.frames) + " frames, the checkpoint needs " +
                std::to_string(keep_frames) + "; start the run anew");
}

void check_append(const std::string& name, const Extent& held, bool open, std::uint64_t given) {
  if (!open) throw Error(name + ": is finished, no frame can be added");
  if (given != held.points)
    throw Error(name + ": a frame has " + std::to_string(given) + " points, the file " +
                std::to_string(held.points) +
                "; write an object whose topology changes as a sequence (obj or ply)");
  if (held.frames >= largest_count)
    throw Error(name + ": holds " + std::to_string(held.frames) + " frames, the format's limit");
}

void check_read(const std::string& name, const Extent& held, std::uint64_t frame, std::uint64_t given) {
  if (frame >= held.frames || given != held.points)
    throw Error(name + ": frame " + std::to_string(frame) + " was asked for as " + std::to_string(given) +
                " points; it holds " + to_text(held));
}

}  // namespace souple::point_cache
