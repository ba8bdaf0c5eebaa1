#pragma once

#include "souple/math/vec3.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

/// One file per frame: NAME_0001.obj, NAME_0002.obj, ... For objects with changing topology and for
/// particles.
namespace souple {

/// NAME_0001.EXTENSION; at least four digits. `extension` without its dot.
std::string frame_file_name(const std::string& name, std::uint64_t frame, const std::string& extension);

/// A file of a sequence and the number in its name.
struct SequenceFrame {
  std::uint64_t number;
  std::filesystem::path path;
};

/// The files of the sequence that contains `any_frame`, by number: equal folder, extension and name up to the
/// digits at its end. Throws Error if there are none, the name does not end in a number, or two files have
/// one number. For a folder: its only sequence of .obj, .ply or .stl files; throws Error if there is none, or
/// several.
std::vector<SequenceFrame> find_sequence(const std::filesystem::path& any_frame);

/// Removes files of a sequence that SequenceWriter wrote: `count` of them from the file `first` on, with numbers
/// up to `last_number`. Ignores failures, and a name that the writer does not generate.
void remove_sequence(const std::filesystem::path& first, std::uint64_t count, std::uint64_t last_number);

/// Writes a sequence; each file appears completely or not at all. `bytes` computes the content of a file,
/// e.g. obj_text or ply_bytes bound to a mesh.
class SequenceWriter {
 public:
  using Bytes =
      std::function<std::string(std::span<const Vec3f> positions, std::span<const Vec3f> velocities)>;

  /// Frames are numbered from 1; the first `keep_frames`, of an earlier run, are kept. Throws Error if one is
  /// missing.
  SequenceWriter(std::filesystem::path folder, std::string name, std::string extension, Bytes bytes,
                 std::uint64_t keep_frames = 0);

  /// Writes the next frame; `velocities` [m/s] may be empty.
  void append(std::span<const Vec3f> positions, std::span<const Vec3f> velocities);
  /// Sets the number of the next frame to `frame`, for an object that was absent. Removes files of an earlier
  /// run with skipped numbers. A number already passed has no effect.
  void skip_to(std::uint64_t frame);
  /// Sets the number of the next frame to `frame` + 1 and keeps all files up to `frame`. Call it first.
  void go_on_after(std::uint64_t frame) { frames_ = frame; }
  /// Removes the frames after number `frame`; the next one follows it.
  void drop_after(std::uint64_t frame);
  /// Removes later frames of an earlier, longer run.
  void finish();

  std::uint64_t frames() const { return frames_; }  ///< number of the last frame; 0 before the first

 private:
  std::filesystem::path file(std::uint64_t frame) const;

  std::filesystem::path folder_;
  std::string name_;
  std::string extension_;
  Bytes bytes_;
  std::uint64_t frames_;
};

}  // namespace souple
