#pragma once

#include "souple/files/file.h"
#include "souple/math/vec3.h"

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>

/// Point Cache 2: the positions of a fixed number of points, frame after frame, as 3ds Max and Blender read
/// them. Little endian. The header is char[12] "POINTCACHE2\0", int32 version 1, int32 points, float start frame, float
/// sample rate (frames per sample), int32 samples. Then follow x, y, z as floats for each point of each sample. (John
/// Burnett, PointCache2 for 3ds Max, README.) Blender refuses a file of no samples.
namespace souple {

/// Writes a .pc2 that grows as NAME.part. Each frame updates the header, so that the .part of a killed
/// program is complete up to its last frame, and `resume` continues it.
class Pc2Writer {
 public:
  struct Options {
    float start_frame = 0;  ///< frame number of the first sample
    float sample_rate = 1;  ///< frames from one sample to the next
  };

  /// `points` >= 1. Creates NAME.part; replaces an existing one.
  Pc2Writer(std::filesystem::path path, std::uint64_t points, const Options& options);
  Pc2Writer(std::filesystem::path path, std::uint64_t points)
      : Pc2Writer(std::move(path), points, Options()) {}

  /// Continues NAME.part, or else the finished NAME, after its first `keep_frames`; later frames are removed.
  /// Throws Error if there are fewer frames or another number of points. The resulting bytes equal those of
  /// an uninterrupted run.
  static Pc2Writer resume(const std::filesystem::path& path, std::uint64_t points, std::uint64_t keep_frames);

  /// Appends a frame; throws Error if the number of positions differs from the file's.
  void append(std::span<const Vec3f> positions);
  /// Renames NAME.part to NAME and ends appending. Without this call the destructor leaves NAME.part.
  void finish();
  /// Removes NAME.part.
  void discard();

  std::uint64_t points() const { return points_; }
  std::uint64_t frames() const { return frames_; }

 private:
  Pc2Writer(std::filesystem::path path, File file, std::uint64_t points, std::uint64_t frames);
  void write_frame_count();

  std::uint64_t points_;
  std::filesystem::path path_;
  File file_;
  std::uint64_t frames_ = 0;
  bool open_ = true;
  std::string buffer_;
};

/// Reads a .pc2, frame by frame in any order. All numbers of the header are checked against the file's size.
class Pc2Reader {
 public:
  explicit Pc2Reader(ByteSource source);
  explicit Pc2Reader(const std::filesystem::path& path) : Pc2Reader(ByteSource(path)) {}
  /// Reads the complete frames of a file that still grows, or whose program was killed.
  static Pc2Reader of_part(ByteSource source);

  std::uint64_t points() const { return points_; }
  std::uint64_t frames() const { return frames_; }
  float start_frame() const { return start_frame_; }
  float sample_rate() const { return sample_rate_; }
  /// Frame 0 is the first of the file. `positions` has points() entries.
  void read(std::uint64_t frame, std::span<Vec3f> positions);

 private:
  Pc2Reader(ByteSource source, bool is_part);

  ByteSource source_;
  std::uint64_t points_ = 0;
  std::uint64_t frames_ = 0;
  float start_frame_ = 0;
  float sample_rate_ = 1;
  std::string buffer_;
};

}  // namespace souple
