#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

/// One file a frame: NAME_0001.obj, NAME_0002.obj, ... For objects whose topology changes, and for particles.
namespace souple {

/// NAME_0001.EXTENSION; at least four digits. `extension` without its dot.
std::string frame_file_name(const std::string& name, std::uint64_t frame, const std::string& extension);

/// A file of a sequence and the number in its name.
struct SequenceFrame {
  std::uint64_t number;
  std::filesystem::path path;
};

/// The files of the sequence that `any_frame` is one of (same folder, same name but for the digits at its
/// end, same extension), by number. Throws Error when there are none, when the name does not end in a number,
/// or when two files have the same number. A folder stands for the one sequence of .obj files in it, or of
/// .ply or .stl files: throws Error when there is none, or several.
std::vector<SequenceFrame> find_sequence(const std::filesystem::path& any_frame);

/// Writes a sequence; each file appears whole or not at all. What a file holds comes from `bytes`, e.g.
/// obj_text or ply_bytes bound to a mesh.
class SequenceWriter {
 public:
  using Bytes =
      std::function<std::string(std::span<const Vec3f> positions, std::span<const Vec3f> velocities)>;

  /// Frames are numbered from 1; `keep_frames` of an earlier run are kept, and must be there (else Error).
  SequenceWriter(std::filesystem::path folder, std::string name, std::string extension, Bytes bytes,
                 std::uint64_t keep_frames = 0);

  /// Writes the next frame; `velocities` [m/s] may be empty.
  void append(std::span<const Vec3f> positions, std::span<const Vec3f> velocities);
  /// The next frame will be number `frame`: an object that was not there has no files. Files of these numbers
  /// that an earlier run left are removed. A number that is behind us changes nothing.
  void skip_to(std::uint64_t frame);
  /// The next frame follows number `frame`; files up to there stay, whichever there are. Call it first.
  void go_on_after(std::uint64_t frame) { frames_ = frame; }
  /// Removes the frames after number `frame`; the next one follows it.
  void drop_after(std::uint64_t frame);
  /// Removes the frames of an earlier, longer run that would look like ours.
  void finish();

  std::uint64_t frames() const { return frames_; }  ///< the last number given, 0 before the first

 private:
  std::filesystem::path file(std::uint64_t frame) const;

  std::filesystem::path folder_;
  std::string name_;
  std::string extension_;
  Bytes bytes_;
  std::uint64_t frames_;
};

}  // namespace souple
