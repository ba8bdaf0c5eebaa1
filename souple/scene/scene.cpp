#include "souple/scene/scene.h"

#include "souple/scene/keys.h"
#include "souple/scene/overrides.h"

#include <fstream>

namespace souple {

namespace {

constexpr std::size_t max_file_size = std::size_t(256) << 20;  // bytes

std::string read_text(const std::filesystem::path& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    throw Error(path.string() + ": is a folder; expected a scene file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path.string() + ": cannot be opened; expected a scene file");
  std::string text;
  std::vector<char> piece(std::size_t(1) << 16);
  while (file.read(piece.data(), static_cast<std::streamsize>(piece.size())), file.gcount() > 0) {
    text.append(piece.data(), static_cast<std::size_t>(file.gcount()));
    if (text.size() > max_file_size) throw Error(path.string() + ": is larger than 256 MiB; not a scene");
  }
  if (file.bad()) throw Error(path.string() + ": cannot be read");
  return text;
}

}  // namespace

const ObjectDescription& common(const AnyObjectDescription& object) {
  return std::visit([](const auto& kind) -> const ObjectDescription& { return kind; }, object);
}

ObjectDescription& common(AnyObjectDescription& object) {
  return std::visit([](auto& kind) -> ObjectDescription& { return kind; }, object);
}

ObjectKind kind_of(const AnyObjectDescription& object) {
  return static_cast<ObjectKind>(object.index());
}

namespace {

SceneDescription read_scene(const scene_format::Json& json, const scene_format::Reading& reading) {
  SceneDescription scene;
  scene_format::scene_codec()->read(json, scene_format::JsonPath(reading), scene);
  scene.source = reading.source;
  scene.folder = reading.base;
  return scene;
}

}  // namespace

SceneDescription parse_scene(std::string_view text, const std::filesystem::path& folder,
                             std::string_view source, std::span<const std::string> overrides) {
  scene_format::Json json = scene_format::parse_json(text, source);
  for (const std::string& setting : overrides) scene_format::apply_override(json, setting, source);
  return read_scene(json, {std::string(source), folder});
}

SceneDescription parse_recorded_scene(std::string_view text, std::string_view source) {
  return read_scene(scene_format::parse_json(text, source), {std::string(source), {}, false});
}

SceneDescription load_scene(const std::filesystem::path& file, std::span<const std::string> overrides) {
  return parse_scene(read_text(file), file.parent_path(), file.string(), overrides);
}

std::string to_json(const SceneDescription& scene) {
  return scene_format::dump_json(scene_format::scene_codec()->write(scene));
}

}  // namespace souple
