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
  OutputLock result;
  if (result.lock(folder, O_RDONLY | O_DIRECTORY, folder)) return result;
  const fs::path file = folder / ".souple.lock";
  if (result.lock(file, O_CREAT | O_RDWR | O_NOFOLLOW, folder)) result.lock_file_ = file;
  return result;
}

OutputLock OutputLock::of_file(const fs::path& file) {
  OutputLock result;
  const fs::path beside = file.parent_path() / ("." + file.filename().string() + ".lock");
  if (result.lock(beside, O_CREAT | O_RDWR | O_NOFOLLOW, file)) result.lock_file_ = beside;
  return result;
}

bool OutputLock::lock(const fs::path& path, int flags, const fs::path& output) {
  for (;;) {
    const int descriptor = open(path.c_str(), flags | O_CLOEXEC, 0666);
    if (descriptor < 0) return false;
    if (flock(descriptor, LOCK_EX | LOCK_NB) != 0) {
      const int error = errno;
      close(descriptor);
      if (error != EWOULDBLOCK) return false;
      throw Error(output.string() +
                  ": another souple is writing there; wait until it ends, or choose another output");
    }
    if (is_at(path, descriptor)) {
      descriptor_ = descriptor;
      return true;
    }
    close(descriptor);
  }
}

OutputLock::OutputLock(OutputLock&& other) noexcept
    : lock_file_(std::move(other.lock_file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

OutputLock::~OutputLock() {
  if (descriptor_ < 0) return;
  if (!lock_file_.empty()) unlink(lock_file_.c_str());
  close(descriptor_);
}

}  // namespace souple
