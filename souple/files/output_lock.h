#pragma once

#include <filesystem>

namespace souple {

/// Ensures that one program at a time writes to an output, and one part of it. It holds an advisory lock (flock): on a
/// folder itself, or on the file `.NAME.lock` beside a file. Some network file systems lock only files: there it is
/// `.souple.lock` in the folder. The system releases the lock when the process ends, however it ends; a file that is left
/// over is harmless. Where nothing can be locked there is no lock, and no error.
class OutputLock {
 public:
  /// Creates a missing folder. Throws Error if another process holds the lock.
  static OutputLock of_folder(const std::filesystem::path& folder);
  /// No lock while the file's folder is missing.
  static OutputLock of_file(const std::filesystem::path& file);

  OutputLock(OutputLock&& other) noexcept;
  OutputLock& operator=(OutputLock&&) = delete;
  OutputLock(const OutputLock&) = delete;
  OutputLock& operator=(const OutputLock&) = delete;
  /// Removes the file and releases the lock.
  ~OutputLock();

 private:
  OutputLock() = default;
  /// Whether the path is locked now. Throws Error if it is locked already; false: it cannot be.
  bool lock(const std::filesystem::path& path, int flags, const std::filesystem::path& output);

  std::filesystem::path lock_file_;  ///< to be removed; empty: the folder is locked
  int descriptor_ = -1;
};

}  // namespace souple
