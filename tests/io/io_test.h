#pragma once

#include "souple/math/vec3.h"
#include "tests/expect_error.h"
#include "tests/folder_test.h"

#include <csignal>
#include <cstdint>
#include <string>
#include <sys/resource.h>
#include <vector>

#include <gtest/gtest.h>

namespace souple::test {

/// During its lifetime no file may grow beyond `bytes`: a test's closest equivalent of a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(std::uint64_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};

/// Positions that differ for each point and frame.
inline std::vector<Vec3f> frame_of(std::size_t points, int frame) {
  std::vector<Vec3f> positions(points);
  for (std::size_t i = 0; i < points; ++i)
    positions[i] = {0.1f * static_cast<float>(i) + static_cast<float>(frame), -static_cast<float>(i),
                    1.0f / static_cast<float>(frame + 3)};
  return positions;
}

}  // namespace souple::test
