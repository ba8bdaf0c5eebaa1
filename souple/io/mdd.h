#pragma once

#include "souple/io/file.h"
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

/// Writes a .mdd that grows as NAME.part. The table of times stands before the frames, so room for
/// `planned_frames` is reserved; a run of just that length is finished by a rename, any other by one copy
/// that closes the gap. A NAME.part left by a killed program is not a .mdd yet: `resume` takes it up again,
/// and resume followed by finish makes it one.
class MddWriter {
 public:
  /// `points` is at least 1; `planned_frames` may be 0 (not known) and may be exceeded.
  MddWriter(std::filesystem::path path, std::uint64_t points, std::uint64_t planned_frames);

  /// As Pc2Writer::resume.
  static MddWriter resume(const std::filesystem::path& path, std::uint64_t points, std::uint64_t keep_frames,
                          std::uint64_t planned_frames);

  /// Appends a frame at `time` [s].
  void append(double time, std::span<const Vec3f> positions);
  /// Renames NAME.part to NAME; nothing can be appended after. Until then the destructor leaves NAME.part.
  void finish();
  /// Removes NAME.part instead.
  void discard();

  std::uint64_t points() const { return points_; }
  std::uint64_t frames() const { return times_.size(); }

 private:
  MddWriter(std::filesystem::path path, File file, std::uint64_t points, std::uint64_t capacity,
            std::vector<float> times);
  std::uint64_t frame_offset(std::uint64_t frame) const;
  void change_capacity(std::uint64_t capacity);

  std::uint64_t points_;
  std::filesystem::path path_;
  File file_;
  std::uint64_t capacity_;  ///< frames that the table of times has room for
  std::vector<float> times_;
  bool open_ = true;
  std::string buffer_;
};

/// Reads a .mdd, frame by frame in any order. All numbers of the header are checked against the file's size.
class MddReader {
 public:
  explicit MddReader(ByteSource source);
  explicit MddReader(const std::filesystem::path& path) : MddReader(ByteSource(path)) {}
  /// A file that still grows, or did when its program was killed: the frames that are whole.
  static MddReader of_part(ByteSource source);

  std::uint64_t points() const { return points_; }
  std::uint64_t frames() const { return times_.size(); }
  /// Seconds, one for each frame, as the file has them.
  const std::vector<float>& times() const { return times_; }
  /// `positions` has points() entries.
  void read(std::uint64_t frame, std::span<Vec3f> positions);

 private:
  MddReader(ByteSource source, bool is_part);

  ByteSource source_;
  std::uint64_t points_ = 0;
  std::uint64_t first_frame_ = 0;  ///< byte
  std::vector<float> times_;
  std::string buffer_;
};

}  // namespace souple
