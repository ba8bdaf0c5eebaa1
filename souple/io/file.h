#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

namespace souple {

/// An open binary file whose failures are Errors that name the path and give the system's reason (disk full,
/// permission, missing folder). Closed on destruction.
class File {
 public:
  enum class Mode {
    read,    ///< must exist
    create,  ///< emptied if it exists; may be read back
    update,  ///< must exist; read and written in place
  };

  File(std::filesystem::path path, Mode mode);

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size();
  /// Fills all of `bytes` from `offset` on; a file that ends before is an Error.
  void read(std::uint64_t offset, std::span<std::byte> bytes);
  void write(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Cuts the file to `size` bytes.
  void truncate(std::uint64_t size);
  /// Hands what is buffered to the system: other processes see it, a killed process does not lose it.
  void flush();
  /// flush, and waits until the disk has it: a power cut does not lose it.
  void sync();
  /// Closes and reports what closing found; the destructor is silent.
  void close();
  /// Closes, whatever becomes of the content.
  void abandon() { file_.reset(); }

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  [[noreturn]] void fail(const char* what) const;
  std::FILE* seek(std::uint64_t offset);

  std::filesystem::path path_;
  std::unique_ptr<std::FILE, Closer> file_;
};

/// Bytes read at random: a file, or memory (what fuzzing feeds the readers).
class ByteSource {
 public:
  explicit ByteSource(const std::filesystem::path& path);
  ByteSource(std::string bytes, std::string name);

  /// What errors call it.
  const std::string& name() const { return name_; }
  std::uint64_t size() const { return size_; }
  /// Fills all of `bytes`; beyond the end is an Error.
  void read(std::uint64_t offset, std::span<std::byte> bytes);

 private:
  std::string name_;
  std::string memory_;
  std::unique_ptr<File> file_;
  std::uint64_t size_;
};

/// The whole of a file. Throws Error.
std::string read_whole_file(const std::filesystem::path& path);

/// Makes an output folder, and those it lies in. Throws Error when it cannot be one.
void create_folder(const std::filesystem::path& folder);

}  // namespace souple
