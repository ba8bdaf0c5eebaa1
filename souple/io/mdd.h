#pragma once

#include "souple/files/file.h"
#include "souple/math/vec3.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

/// MDD (LightWave's Motion Designer): the positions of a fixed number of points, frame after frame, as
/// Blender and Houdini read them. Big endian: int32 frames, int32 points, a float time [s] for each frame,
/// then x, y, z as floats for each point of each frame. Blender refuses a file of no frames.
namespace souple {

/// Writes a .mdd that grows as NAME.part. The table of times precedes the frames, so space for
/// `planned_frames` is reserved. A run of exactly that length is finished by a rename, another length by one
/// copy that closes the gap. A NAME.part of a killed program is not a .mdd yet: `resume` continues it, and
/// `finish` then makes it one.
class MddWriter {
 public:
  /// `points` >= 1; `planned_frames` may be 0 (unknown) and may be exceeded.
  MddWriter(std::filesystem::path path, std::uint64_t points, std::uint64_t planned_frames);

  /// Continues a file; see Pc2Writer::resume.
  static MddWriter resume(const std::filesystem::path& path, std::uint64_t points, std::uint64_t keep_frames,
                          std::uint64_t planned_frames);

  /// Appends a frame at `time` [s].
  void append(double time, std::span<const Vec3f> positions);
  /// Renames NAME.part to NAME and ends appending. Without this call the destructor leaves NAME.part.
  void finish();
  /// Removes NAME.part.
  void discard();

  std::uint64_t points() const { return points_; }
  std::uint64_t frames() const { return times_.size(); }

 private:
  MddWriter(std::filesystem::path path, File file, std::uint64_t points, std::uint64_t capacity,
            std::vector<float> times);
  std::uint64_t frame_offset(std::uint64_t frame) const;
  void change_capacity(std::uint64_t capacity);
  void shrink_capacity();

  std::uint64_t points_;
  std::filesystem::path path_;
  File file_;
  std::uint64_t capacity_;  ///< frames that fit into the table of times
  std::vector<float> times_;
  bool open_ = true;
  std::string buffer_;
};

/// Reads a .mdd, frame by frame in any order. All numbers of the header are checked against the file's size.
class MddReader {
 public:
  explicit MddReader(ByteSource source);
  explicit MddReader(const std::filesystem::path& path) : MddReader(ByteSource(path)) {}
  /// Reads the complete frames of a file that still grows, or whose program was killed.
  static MddReader of_part(ByteSource source);

  std::uint64_t points() const { return points_; }
  std::uint64_t frames() const { return times_.size(); }
  /// Per frame: the time stored in the file [s].
  const std::vector<float>& times() const { return times_; }
  /// `positions` has points() entries.
  void read(std::uint64_t frame, std::span<Vec3f> positions);

 private:
  MddReader(ByteSource source, bool is_part);

  ByteSource source_;
  std::uint64_t points_ = 0;
  std::uint64_t first_frame_ = 0;  ///< byte offset of the first frame
  std::vector<float> times_;
  std::string buffer_;
};

}  // namespace souple
