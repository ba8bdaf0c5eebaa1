#include "souple/mesh_files/reader/folder_files.h"

#include <algorithm>
#include <fcntl.h>
#include <string>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include <assimp/DefaultIOStream.h>
#include <assimp/IOSystem.hpp>

namespace souple::mesh_detail {

namespace fs = std::filesystem;

namespace {

class OpenFile : public Assimp::DefaultIOStream {
 public:
  OpenFile(std::FILE* file, const std::string& name) : DefaultIOStream(file, name) {}
};

/// The file, or nullptr unless it is a regular one. Never waits, as for a pipe without a writer.
std::FILE* open_regular(const fs::path& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return nullptr;
  struct stat status {};
  if (fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode)) {
    if (std::FILE* const file = fdopen(descriptor, "rb")) return file;
  }
  close(descriptor);
  return nullptr;
}

bool is_below(const fs::path& path, const fs::path& folder) {
  return std::mismatch(folder.begin(), folder.end(), path.begin(), path.end()).first == folder.end();
}

class FolderFiles : public Assimp::IOSystem {
 public:
  explicit FolderFiles(const fs::path& mesh)
      : mesh_(mesh), folder_(fs::canonical(fs::absolute(mesh).parent_path())) {}

  bool Exists(const char* name) const override {
    std::error_code error;
    const fs::path path = allowed(name);
    return !path.empty() && fs::is_regular_file(path, error);
  }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    const fs::path path = allowed(name);
    const bool reads = mode != nullptr && mode[0] == 'r' && std::string(mode).find('+') == std::string::npos;
    std::FILE* const file = path.empty() || !reads ? nullptr : open_regular(path);
    return file == nullptr ? nullptr : new OpenFile(file, path.string());
  }
  void Close(Assimp::IOStream* file) override { delete file; }
  char getOsSeparator() const override { return '/'; }
  bool CreateDirectory(const std::string&) override { return false; }
  bool ChangeDirectory(const std::string&) override { return false; }
  bool DeleteFile(const std::string&) override { return false; }

 private:
  /// The file's real path; empty if it may not be opened.
  fs::path allowed(const char* name) const {
    std::error_code error;
    const fs::path named(name);
    // Importers name files relative to the mesh's folder, or with its path before them.
    for (const fs::path& candidate : {fs::absolute(named), folder_ / named}) {
      fs::path real = fs::canonical(candidate, error);
      if (!error && (named == mesh_ || is_below(real, folder_))) return real;
    }
    return {};
  }

  fs::path mesh_, folder_;
};

}  // namespace

Assimp::IOSystem* files_of_folder(const fs::path& mesh) {
  return new FolderFiles(mesh);
}

}  // namespace souple::mesh_detail
