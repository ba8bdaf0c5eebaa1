#include "souple/files/output_lock.h"

#include "souple/error.h"

#include <cerrno>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace souple {
namespace {

namespace fs = std::filesystem;

// Whether the path still names the open file: its last owner may have removed it in between.
bool is_at(const fs::path& path, int descriptor) {
  struct stat open_file {
  }, named{};
  return fstat(descriptor, &open_file) == 0 && stat(path.c_str(), &named) == 0 &&
         open_file.st_dev == named.st_dev && open_file.st_ino == named.st_ino;
}

}  // namespace

OutputLock OutputLock::of_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  return {folder, folder / ".souple.lock"};
}

OutputLock OutputLock::of_file(const fs::path& file) {
  return {file, file.parent_path() / ("." + file.filename().string() + ".lock")};
}

OutputLock::OutputLock(const fs::path& output, fs::path lock_file) : lock_file_(std::move(lock_file)) {
  for (;;) {
    const int descriptor = open(lock_file_.c_str(), O_CREAT | O_RDWR | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor < 0) return;
    if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      close(descriptor);
      if (error != EWOULDBLOCK) return;
      throw Error(output.string() +
                  ": another souple is writing there; wait until it ends, or choose another --out");
    }
    if (is_at(lock_file_, descriptor)) {
      descriptor_ = descriptor;
      return;
    }
    close(descriptor);
  }
}

OutputLock::OutputLock(OutputLock&& other) noexcept
    : lock_file_(std::move(other.lock_file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

OutputLock::~OutputLock() {
  if (descriptor_ < 0) return;
  unlink(lock_file_.c_str());
  close(descriptor_);
}

}  // namespace souple
