#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace souple {

/// An open binary file. Failures throw Error with the path and the system's reason (disk full, permission,
/// missing folder), and WriteError (write_error.h) unless the file is only read. The destructor closes the file.
class File {
 public:
  enum class Mode {
    read,    ///< must exist
    create,  ///< replaces a file or link of this name; readable too
    update,  ///< must exist, and be no link; read and written in place
  };

  File(std::filesystem::path path, Mode mode);

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size();
  /// Fills `bytes` from `offset` on; throws Error if the file is too short.
  void read(std::uint64_t offset, std::span<std::byte> bytes);
  void write(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Allocates the disk space of the first `size` bytes and extends a shorter file to them: writing them does not
  /// fail on a full disk. Throws Error if there is no space; where the file system cannot reserve, does nothing.
  void reserve(std::uint64_t size);
  /// Truncates the file to `size` bytes.
  void truncate(std::uint64_t size);
  /// Passes buffered data to the system: other processes see it, and a killed process does not lose it.
  void flush();
  /// Flushes and waits for the disk: a power failure does not lose the data.
  void sync();
  /// Closes the file and throws on failure; the destructor ignores failures.
  void close();
  /// Closes the file without regard to its content.
  void abandon() { file_.reset(); }

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  [[noreturn]] void fail(const char* what) const;
  std::FILE* seek(std::uint64_t offset);

  std::filesystem::path path_;
  Mode mode_;
  std::unique_ptr<std::FILE, Closer> file_;
};

/// Random access to bytes: of a file, or of memory (for fuzzing).
class ByteSource {
 public:
  explicit ByteSource(const std::filesystem::path& path);
  ByteSource(std::string bytes, std::string name);

  /// The name in error messages.
  const std::string& name() const { return name_; }
  std::uint64_t size() const { return size_; }
  /// Fills `bytes`; throws Error beyond the end.
  void read(std::uint64_t offset, std::span<std::byte> bytes);

 private:
  std::string name_;
  std::string memory_;
  std::unique_ptr<File> file_;
  std::uint64_t size_;
};

/// Reads a whole file. Throws Error.
std::string read_whole_file(const std::filesystem::path& path);

/// `text` in lower case (ASCII only, independent of the locale).
inline std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

/// ".json" of "A.JSON".
std::string lower_extension(const std::filesystem::path& file);

/// Creates an output folder and its parents. Throws WriteError on failure, and Error if it or a parent is a file.
void create_folder(const std::filesystem::path& folder);

}  // namespace souple
