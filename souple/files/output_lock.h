#pragma once

#include <filesystem>

namespace souple {

/// Ensures that one process at a time writes to an output. It holds an advisory lock (flock) on a file: `.souple.lock`
/// in a folder, `.NAME.lock` beside a file. The system releases the lock when the process ends, however it ends; a file
/// that is left over is harmless. Where nothing can be created or locked (a read-only or network file system) there is
/// no lock, and no error.
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
  OutputLock(const std::filesystem::path& output, std::filesystem::path lock_file);

  std::filesystem::path lock_file_;
  int descriptor_ = -1;
};

}  // namespace souple
