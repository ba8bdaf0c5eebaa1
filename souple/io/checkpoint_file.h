#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// Checkpoints: the data with which a stopped run resumes.
namespace souple {

/// A cache file and the number of its frames that belong to the run.
struct CheckpointCache {
  std::string path;  ///< relative to the output folder
  std::uint64_t frames = 0;
  bool operator==(const CheckpointCache&) const = default;
};

struct Checkpoint {
  std::string version;  ///< version of the library that wrote the checkpoint: "0.1.0", at most 15 characters
  std::uint64_t frame = 0;  ///< frames simulated
  std::string scene;        ///< JSON text of the simulated scene
  std::vector<CheckpointCache> caches;
  std::vector<std::byte> state;  ///< state of the world; opaque here
  bool operator==(const Checkpoint&) const = default;
};

/// The bytes of a checkpoint file. A header of 64 bytes, whose layout never changes, has the magic number, the format
/// and the version that wrote it. It also has the size and checksum of the rest, and its own checksum. Then follows the
/// rest. Little endian, FNV-1a 64.
std::string checkpoint_bytes(const Checkpoint& checkpoint);

/// Reads and validates a checkpoint. Throws Error if the bytes are not a checkpoint, or are truncated or damaged. Also
/// throws if a version newer than `this_version` wrote them ("was written by Souple 0.2.0, this is 0.1.0").
Checkpoint parse_checkpoint(std::string_view bytes, const std::string& name, const std::string& this_version);

/// Writes the file completely or not at all, and waits for the disk.
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);
Checkpoint read_checkpoint(const std::filesystem::path& path, const std::string& this_version);

}  // namespace souple
