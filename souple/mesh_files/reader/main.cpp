// souple-mesh-reader FILE                                              a mesh
// souple-mesh-reader FILE --animation NAME OBJECT FRAMES_PER_SECOND    an animation; NAME and OBJECT may be empty
//
// Reads a file with assimp and writes what it holds to the standard output, for the library, which checks it.
// A program of its own, so that what a file does to assimp does not happen to the library's process.

#include "souple/error.h"
#include "souple/mesh_files/assimp_formats.h"
#include "souple/mesh_files/mesh_message.h"
#include "souple/mesh_files/number_text.h"
#include "souple/mesh_files/reader/assimp_animation.h"
#include "souple/mesh_files/reader/assimp_scene.h"

#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <sys/resource.h>
#include <system_error>
#include <vector>

#include <fmt/core.h>

#ifdef SOUPLE_SANITIZED
// assimp 5.2 leaks the shapes of an FBX.
extern "C" const char*
__lsan_default_suppressions();  // NOLINT(bugprone-reserved-identifier): the sanitizer's name
extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:libassimp";
}
#endif

namespace {

using souple::mesh_detail::message_of_animation;
using souple::mesh_detail::message_of_failure;
using souple::mesh_detail::message_of_mesh;
using souple::mesh_detail::parse_unsigned_real;
using souple::mesh_detail::read_assimp_animation;
using souple::mesh_detail::read_assimp_scene;
using souple::mesh_detail::reader_memory;
using souple::mesh_detail::reader_seconds;

/// A lower limit of the caller stays.
template <class Resource>
void limit(Resource resource, std::uint64_t soft, std::uint64_t hard) {
  const rlimit limits{rlim_t(soft), rlim_t(hard)};
  setrlimit(resource, &limits);
}

void limit_resources(const std::filesystem::path& mesh, bool animation) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(mesh, error);
  const std::uint64_t seconds = reader_seconds(error ? 0 : size, animation);
  limit(RLIMIT_CPU, seconds, seconds + 1);
  limit(RLIMIT_CORE, 0, 0);
  limit(RLIMIT_FSIZE, 0, 0);  // of files; the answer goes to a pipe
#ifndef SOUPLE_SANITIZED      // shadow memory of sanitizers reserves terabytes of addresses
  limit(RLIMIT_AS, reader_memory, reader_memory);
#endif
}

std::string read(const std::vector<std::string>& arguments) {
  const std::string& mesh = arguments.front();
  if (arguments.size() == 1) return message_of_mesh(read_assimp_scene(mesh));
  double rate = 0;
  if (!parse_unsigned_real(arguments[4], rate) || !(rate > 0))
    throw souple::Error(mesh + ": the frame rate of an animation must be a number > 0");
  return message_of_animation(read_assimp_animation(mesh, {arguments[2], arguments[3], rate}));
}

std::string answer(const std::vector<std::string>& arguments) {
  const std::string& mesh = arguments.front();
  try {
    return read(arguments);
  } catch (const std::bad_alloc&) {
    return message_of_failure(fmt::format("{}: needs more than {} GiB of memory to be read with assimp", mesh,
                                          reader_memory >> 30));
  } catch (const std::exception& error) {
    return message_of_failure(error.what());
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool animation = arguments.size() == 5 && arguments[1] == "--animation";
  if (arguments.size() != 1 && !animation) {
    std::fputs(
        "usage: souple-mesh-reader FILE [--animation NAME OBJECT FRAMES_PER_SECOND]; Souple runs it for "
        "files that assimp reads\n",
        stderr);
    return 2;
  }
  limit_resources(arguments.front(), animation);
  const std::string bytes = answer(arguments);
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), stdout) == bytes.size();
  return written && std::fflush(stdout) == 0 ? 0 : 1;
}
