#pragma once

#include "souple/files/file.h"

#include <filesystem>
#include <span>
#include <string_view>

namespace souple {

/// NAME.part: the name of a file while it is written.
std::filesystem::path part_path(const std::filesystem::path& path);

/// Renames a file and replaces an existing one atomically. Throws WriteError.
void rename_file(const std::filesystem::path& from, const std::filesystem::path& to);

/// Whether to wait for the disk, so that a power failure loses nothing; this costs milliseconds.
enum class Sync { no, yes };

/// A file that appears completely or not at all. It is written as NAME.part; commit() renames it. The
/// destructor removes an uncommitted NAME.part, for example after an exception. An older file of the final
/// name remains until commit().
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::span<const std::byte> bytes);
  void write(std::string_view bytes);
  /// Reserves disk space for `size` bytes in all (File::reserve): writing no more than these does not fail on a full
  /// disk, nor does commit().
  void reserve(std::uint64_t size);
  void commit(Sync sync = Sync::no);

 private:
  std::filesystem::path path_;
  File file_;
  std::uint64_t written_ = 0, reserved_ = 0;
  bool committed_ = false;
};

/// Writes an AtomicFile in one call.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes, Sync sync = Sync::no);

}  // namespace souple
