#include "souple/files/file.h"

#include "souple/error.h"
#include "souple/files/write_error.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <fmt/core.h>

#if defined(_WIN32)
#include <io.h>
#else
#include <fcntl.h>
#include <unistd.h>
#endif

namespace souple {

namespace {

int seek_to(std::FILE* file, std::uint64_t offset, int origin) {
#if defined(_WIN32)
  return _fseeki64(file, static_cast<long long>(offset), origin);
#else
  return fseeko(file, static_cast<off_t>(offset), origin);
#endif
}

std::int64_t position_of(std::FILE* file) {
#if defined(_WIN32)
  return _ftelli64(file);
#else
  return static_cast<std::int64_t>(ftello(file));
#endif
}

int wait_for_disk(std::FILE* file) {
#if defined(_WIN32)
  return _commit(_fileno(file));
#else
  return fsync(fileno(file));
#endif
}

/// Returns 0, or the error of a disk without space.
int allocate(std::FILE* file, std::uint64_t size) {
#if defined(_WIN32) || defined(__APPLE__)
  static_cast<void>(file), static_cast<void>(size);
  return 0;
#else
  int error = EINTR;
  while (error == EINTR) error = posix_fallocate(fileno(file), 0, static_cast<off_t>(size));
  return error == ENOSPC || error == EDQUOT || error == EFBIG ? error : 0;
#endif
}

/// Writes to no link: somebody else may have left one under this name, to a file that matters.
std::FILE* open_file(const std::filesystem::path& path, File::Mode mode) {
#if defined(_WIN32)
  const char* text = mode == File::Mode::read ? "rb" : (mode == File::Mode::create ? "w+b" : "r+b");
  return std::fopen(path.string().c_str(), text);
#else
  if (mode == File::Mode::read) return std::fopen(path.c_str(), "rb");
  const bool create = mode == File::Mode::create;
  if (create) unlink(path.c_str());
  const int descriptor =
      open(path.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC | (create ? O_CREAT | O_EXCL : 0), 0666);
  if (descriptor < 0) return nullptr;
  std::FILE* const file = fdopen(descriptor, "r+b");
  if (file == nullptr) close(descriptor);
  return file;
#endif
}

/// Rejects folders and pipes, which can be opened but then return garbage or block.
void require_plain_file(const std::filesystem::path& path, File::Mode mode) {
  std::error_code ignored;
  const auto status = mode == File::Mode::create ? std::filesystem::symlink_status(path, ignored)
                                                 : std::filesystem::status(path, ignored);
  if (!std::filesystem::exists(status) || std::filesystem::is_regular_file(status)) return;
  if (mode == File::Mode::create && std::filesystem::is_symlink(status)) return;
  const std::string what = path.string() + ": is not a file; give the path of a file";
  if (mode == File::Mode::create) throw WriteError(what);
  throw Error(what);
}

}  // namespace

File::File(std::filesystem::path path, Mode mode) : path_(std::move(path)), mode_(mode) {
  require_plain_file(path_, mode);
  file_.reset(open_file(path_, mode));
  if (file_) return;
  const int reason = errno;
  const auto folder = path_.parent_path();
  std::error_code ignored;
  if (mode == Mode::create && !folder.empty() && !std::filesystem::is_directory(folder, ignored))
    throw WriteError(path_.string() + ": cannot be written: there is no folder " + folder.string() +
                     "; create it first");
  errno = reason;
  fail(mode == Mode::create ? "cannot be written" : "cannot be opened");
}

void File::fail(const char* what) const {
  const std::string text = path_.string() + ": " + what + ": " + std::generic_category().message(errno);
  if (mode_ == Mode::read) throw Error(text);
  throw WriteError(text);
}

std::FILE* File::seek(std::uint64_t offset) {
  if (!file_) throw Error(path_.string() + ": is closed already");
  if (seek_to(file_.get(), offset, SEEK_SET) != 0) fail("cannot be positioned");
  return file_.get();
}

std::uint64_t File::size() {
  std::FILE* file = seek(0);
  if (seek_to(file, 0, SEEK_END) != 0) fail("cannot be positioned");
  const std::int64_t end = position_of(file);
  if (end < 0) fail("cannot be positioned");
  return static_cast<std::uint64_t>(end);
}

void File::read(std::uint64_t offset, std::span<std::byte> bytes) {
  if (bytes.empty()) return;
  std::FILE* file = seek(offset);
  if (std::fread(bytes.data(), 1, bytes.size(), file) == bytes.size()) return;
  if (std::ferror(file)) fail("cannot be read");
  throw Error(fmt::format("{}: ends before byte {}", path_.string(), offset + bytes.size()));
}

void File::write(std::uint64_t offset, std::span<const std::byte> bytes) {
  if (bytes.empty()) return;
  std::FILE* file = seek(offset);
  if (std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size()) fail("cannot be written");
}

void File::reserve(std::uint64_t size) {
  flush();
  const int error = file_ ? allocate(file_.get(), size) : 0;
  errno = error;
  if (error != 0) fail("cannot be written");
}

void File::truncate(std::uint64_t size) {
  flush();
  std::error_code error;
  std::filesystem::resize_file(path_, size, error);
  if (error) throw WriteError(path_.string() + ": cannot be cut: " + error.message());
}

void File::flush() {
  if (file_ && std::fflush(file_.get()) != 0) fail("cannot be written");
}

void File::sync() {
  flush();
  if (file_ && wait_for_disk(file_.get()) != 0) fail("cannot be written");
}

void File::close() {
  if (file_ && std::fclose(file_.release()) != 0) fail("cannot be written");
}

ByteSource::ByteSource(const std::filesystem::path& path)
    : name_(path.string()), file_(std::make_unique<File>(path, File::Mode::read)), size_(file_->size()) {}

ByteSource::ByteSource(std::string bytes, std::string name)
    : name_(std::move(name)), memory_(std::move(bytes)), size_(memory_.size()) {}

void ByteSource::read(std::uint64_t offset, std::span<std::byte> bytes) {
  if (offset > size_ || bytes.size() > size_ - offset)
    throw Error(fmt::format("{}: ends at byte {}, more was expected", name_, size_));
  if (bytes.empty()) return;
  if (file_)
    file_->read(offset, bytes);
  else
    std::memcpy(bytes.data(), memory_.data() + offset, bytes.size());
}

std::string read_whole_file(const std::filesystem::path& path) {
  ByteSource source(path);
  std::string bytes(static_cast<std::size_t>(source.size()), '\0');
  source.read(0, std::as_writable_bytes(std::span(bytes)));
  return bytes;
}

std::string lower_extension(const std::filesystem::path& file) {
  return lower_case(file.extension().string());
}

void create_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  // A loop of symbolic links or a name that is too long is an error here, not only a missing folder.
  std::error_code ignored;
  const auto status = std::filesystem::status(folder, ignored);
  if (std::filesystem::is_directory(status)) return;
  const std::string what = folder.string() + ": cannot be an output folder: ";
  if (std::filesystem::exists(status)) throw Error(what + "there is a file of that name; choose another");
  if (error == std::errc::not_a_directory)
    throw Error(what + "a folder of its path is a file; choose another");
  throw WriteError(what + error.message() + "; choose another");
}

}  // namespace souple
