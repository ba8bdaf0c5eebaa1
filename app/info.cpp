#include "app/commands.h"
#include "app/exit_codes.h"
#include "app/find_scene.h"
#include "app/vdb.h"
#include "souple/mesh_files/mesh_file.h"
#include "souple/scene/scene.h"
#include "souple/simd/instruction_set.h"
#include "souple/threads/threads.h"
#include "souple/version.h"
#include "souple/world/memory.h"
#include "souple/world/world.h"

#include <cstdio>

namespace souple::app {

namespace {

const char* compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#elif defined(__GNUC__)
  return "g++ " __VERSION__;
#else
  return "unknown";
#endif
}

void print_folders() {
  std::printf("folders of scenes:\n");
  for (const std::filesystem::path& folder : scene_folders()) {
    std::error_code error;
    const bool exists = std::filesystem::is_directory(folder, error);
    std::printf("  %s%s\n", folder.string().c_str(), exists ? "" : " (missing)");
  }
}

}  // namespace

int info(InfoPart part) {
  if (part == InfoPart::schema) {
    std::fputs(scene_schema().c_str(), stdout);
    return success;
  }
  if (part == InfoPart::scene_format) {
    std::fputs(scene_manual().c_str(), stdout);
    return success;
  }
  const std::string instructions(simd_name());  // may throw: before any output
  const int threads = thread_count(0);
  std::printf("souple %s\n", version);
  std::printf("compiler: %s, %s\n", compiler(), SOUPLE_BUILD_TYPE);
  std::printf("instruction set: %s\n", instructions.c_str());
  std::printf("threads: %d; oneTBB: %s\n", threads, has_tbb() ? "yes" : "no (not built in)");
  std::printf("mesh files: OBJ, PLY, STL, Gmsh, TetGen, VTK\n");
  std::printf("other mesh files, through assimp: %s\n",
              mesh_import_has_assimp() ? "yes" : "no (not built in)");
  std::printf("caches: PC2, MDD, OBJ, PLY\n");
  std::printf("volumes of surfaces, through OpenVDB: %s\n", has_vdb() ? "yes" : "no (not built in)");
  std::fputs(picture_support().c_str(), stdout);
  std::printf("viewer: %s\n", has_viewer() ? "yes" : "no (not built in)");
  print_folders();
  return success;
}

namespace {

void print_memory(const std::string& name, std::size_t bytes, std::size_t particles) {
  std::printf("%-40s %12zu %8.1f\n", name.c_str(), bytes,
              particles > 0 ? static_cast<double>(bytes) / static_cast<double>(particles) : 0.0);
}

}  // namespace

int memory(const std::string& scene, const std::vector<std::string>& settings) {
  const SceneDescription description = load_scene(find_scene(scene), settings);
  World world = build_world(description);
  world.step(1 / description.frame_rate);
  for (const ObjectId object : world.objects()) world.positions(object);  // as a run does when it records
  const MemoryReport report = world.memory();
  std::printf("%zu particles\n%-40s %12s %8s\n", report.particles, "", "bytes", "each");
  for (const auto& [title, parts] :
       {std::pair("simulation", &report.simulation), {"objects", &report.objects}}) {
    for (const MemoryReport::Part& part : *parts)
      print_memory("  " + part.name, part.bytes, report.particles);
    print_memory(title, MemoryReport::total(*parts), report.particles);
  }
  print_memory("total", MemoryReport::total(report.simulation) + MemoryReport::total(report.objects),
               report.particles);
  return success;
}

}  // namespace souple::app
