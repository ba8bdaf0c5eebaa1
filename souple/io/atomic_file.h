#pragma once

#include "souple/io/file.h"

#include <filesystem>
#include <span>
#include <string_view>

namespace souple {

/// NAME.part, the name that a file has while it is being written.
std::filesystem::path part_path(const std::filesystem::path& path);

/// Renames, replacing what has the new name: the one moment at which a file changes. Throws Error.
void rename_file(const std::filesystem::path& from, const std::filesystem::path& to);

/// Waits for the disk, so that a power cut loses nothing; costs milliseconds.
enum class Sync { no, yes };

/// A file that appears whole or not at all: written as NAME.part, renamed by commit(), and removed when it is
/// destroyed before (an exception, say). An older file of the same name stays until then.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void write(std::span<const std::byte> bytes);
  void write(std::string_view bytes);
  void commit(Sync sync = Sync::no);

 private:
  std::filesystem::path path_;
  File file_;
  std::uint64_t written_ = 0;
  bool committed_ = false;
};

/// AtomicFile in one call.
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes, Sync sync = Sync::no);

}  // namespace souple
