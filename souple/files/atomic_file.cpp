#include "souple/files/atomic_file.h"

#include "souple/files/write_error.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace souple {

std::filesystem::path part_path(const std::filesystem::path& path) {
  std::filesystem::path part = path;
  part += ".part";
  return part;
}

void rename_file(const std::filesystem::path& from, const std::filesystem::path& to) {
  std::error_code error;
  std::filesystem::rename(from, to, error);
  if (error)
    throw WriteError(from.string() + ": cannot be renamed to " + to.string() + ": " + error.message());
}

AtomicFile::AtomicFile(std::filesystem::path path)
    : path_(std::move(path)), file_(part_path(path_), File::Mode::create) {}

AtomicFile::~AtomicFile() {
  if (committed_) return;
  file_.abandon();
  std::error_code ignored;
  std::filesystem::remove(file_.path(), ignored);
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  file_.write(written_, bytes);
  written_ += bytes.size();
}

void AtomicFile::write(std::string_view bytes) {
  write(std::as_bytes(std::span(bytes.data(), bytes.size())));
}

void AtomicFile::reserve(std::uint64_t size) {
  file_.reserve(size);
  reserved_ = std::max(reserved_, size);
}

void AtomicFile::commit(Sync sync) {
  if (reserved_ > written_) file_.truncate(written_);
  if (sync == Sync::yes) file_.sync();
  file_.close();
  rename_file(file_.path(), path_);
  committed_ = true;
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes, Sync sync) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit(sync);
}

}  // namespace souple
