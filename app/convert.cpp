#include "app/commands.h"
#include "app/convert_files.h"
#include "app/exit_codes.h"
#include "app/interrupt.h"
#include "app/option_names.h"
#include "app/surface_files.h"
#include "souple/error.h"
#include "souple/files/file.h"
#include "souple/files/output_lock.h"
#include "souple/objects/kind_traits.h"
#include "souple/scene/scene.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <system_error>
#include <variant>
#include <vector>

namespace souple::app {

namespace fs = std::filesystem;

namespace {

float linear_of_srgb(std::uint32_t byte) {
  const float encoded = static_cast<float>(byte & 0xff) / 255;
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

/// The color of an object whose scene names none.
ExportLook default_look(const std::string& kind) {
  ExportLook look;
  if (kind == "fluid") look.color = {0.1f, 0.3f, 0.6f}, look.roughness = 0.1f;
  if (kind == "grains") look.color = {0.6f, 0.45f, 0.25f};
  if (kind == "foam") look.color = {0.9f, 0.9f, 0.9f};
  return look;
}

ExportLook look_of(const std::optional<SceneDescription>& scene, const Playback::Object& object) {
  ExportLook look = default_look(object.kind);
  if (!scene) return look;
  for (const AnyObjectDescription& description : scene->objects) {
    const float radius =
        std::visit([](const auto& kind) { return particle_radius(kind.material); }, description);
    const auto* fluid = std::get_if<FluidDescription>(&description);
    if (object.kind == "foam" && fluid != nullptr) look.radius = radius / 2;
    if (common(description).name != object.name) continue;
    look.radius = radius;
    if (const std::optional<std::uint32_t>& color = common(description).color)
      look.color = {linear_of_srgb(*color >> 16), linear_of_srgb(*color >> 8), linear_of_srgb(*color)};
    const auto* obstacle = std::get_if<ObstacleDescription>(&description);
    if (obstacle != nullptr && obstacle->look == SurfaceLook::glass)
      look.opacity = 0.3f, look.roughness = 0.05f;
  }
  return look;
}

using Converter = std::uint64_t (*)(const ConvertJob&);

/// The formats of --write, each once.
std::vector<Converter> converters_of(const ConvertRequest& request) {
  if (request.formats.empty())
    throw Error("--write is needed: expected glb, usda, or both: --write glb,usda");
  std::vector<Converter> result;
  for (const std::string& format : request.formats) {
    const auto converter =
        value_of<Converter>({{"glb", convert_to_glb}, {"usda", convert_to_usda}}, format, "--write");
    if (std::find(result.begin(), result.end(), converter) == result.end()) result.push_back(converter);
  }
  return result;
}

ConvertLayout layout_of(const std::string& word) {
  return value_of<ConvertLayout>({{"auto", ConvertLayout::automatic},
                                  {"one", ConvertLayout::one_file},
                                  {"frames", ConvertLayout::file_per_frame}},
                                 word, "--layout");
}

void require_run(const fs::path& cache) {
  std::error_code error;
  if (!fs::exists(cache, error))
    throw Error(cache.string() +
                ": there is no such folder; expected the folder of a run, which `souple run` wrote");
  if (fs::is_directory(cache, error) && !fs::exists(cache / "run.json", error))
    throw Error(cache.string() + ": the folder has no run.json; expected the folder of a run");
}

}  // namespace

int convert(const ConvertRequest& request) {
  const std::vector<Converter> converters = converters_of(request);
  const ConvertLayout layout = layout_of(request.layout);
  require_run(request.cache);
  const RunManifest manifest = read_manifest_without_reports(request.cache);
  std::optional<SceneDescription> scene;
  if (!manifest.scene.empty())
    scene = parse_recorded_scene(manifest.scene, request.cache.string() + ": embedded scene");
  ExportFrames frames(request.cache, [&](const Playback::Object& object) { return look_of(scene, object); });
  const fs::path out = request.out.empty() ? folder_beside(request.cache, "_converted") : request.out;
  const bool constant = frames.survey();
  const OutputLock lock = OutputLock::of_folder(out);
  create_folder(out);
  // From here on files are written; an interrupt ends the work with complete files.
  watch_interrupts();
  const std::uint64_t all = frames.playback().frames();
  const ConvertJob job{frames, request.cache, out, run_name(request.cache), layout, constant, request.quiet};
  for (const Converter converter : converters) {
    const std::uint64_t done = converter(job);
    if (done == all) continue;
    std::fprintf(stderr, "souple: interrupted; %s holds %s\n", out.string().c_str(),
                 done == 0 ? "no frame in this format" : "the frames before");
    return interrupted;
  }
  if (!manifest.complete && !request.quiet)
    std::printf("%s: is not finished; its %llu frames so far are converted\n", request.cache.string().c_str(),
                static_cast<unsigned long long>(all));
  return success;
}

}  // namespace souple::app
