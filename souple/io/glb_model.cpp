#include "souple/io/glb_model.h"

#include "souple/error.h"
#include "souple/files/endian.h"
#include "souple/version.h"

#include <algorithm>
#include <limits>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace souple {

using Json = nlohmann::ordered_json;

namespace {

constexpr int array_buffer = 34962, element_array_buffer = 34963;  // OpenGL's names of bufferView.target
constexpr int unsigned_int = 5125, float_number = 5126;            // of accessor.componentType

Json bounds(const std::vector<float>& numbers) {
  Json array = Json::array();
  for (const float number : numbers) array.push_back(static_cast<double>(number));  // exact: checkers compare
  return array;
}

Json color_factor(const std::array<float, 4>& color) {
  Json array = Json::array();
  // Six digits are enough for a color, and shorter than those of a float.
  for (const float channel : color) array.push_back(std::stod(fmt::format("{:.6g}", channel)));
  return array;
}

/// Length of a chunk of this content: a multiple of 4.
std::uint64_t padded(std::uint64_t size) {
  return (size + 3) / 4 * 4;
}

}  // namespace

/// The JSON of a model.
class GlbJson {
 public:
  explicit GlbJson(const GlbModel& model) : model_(model) {}

  Json make() const {
    Json root;
    root["asset"] = {{"version", "2.0"}, {"generator", std::string("Souple ") + version}};
    root["scene"] = 0;
    Json scene{{"name", model_.name}};
    if (!model_.nodes.empty()) scene["nodes"] = Json::array();
    for (std::size_t i = 0; i < model_.nodes.size(); ++i) scene["nodes"].push_back(i);
    if (!model_.extras.empty()) scene["extras"] = Json::parse(model_.extras);
    root["scenes"] = Json::array({scene});
    for (const GlbModel::Node& node : model_.nodes)
      root["nodes"].push_back({{"name", model_.meshes[node.mesh].name}, {"mesh", node.mesh}});
    for (const GlbModel::Mesh& mesh : model_.meshes) root["meshes"].push_back(json_of(mesh));
    for (const GlbModel::Material& material : model_.materials)
      root["materials"].push_back(json_of(material));
    add_accessors(root);
    add_animation(root);
    return root;
  }

 private:
  static Json json_of(const GlbModel::Material& material) {
    Json json{{"name", material.name},
              {"pbrMetallicRoughness",
               {{"baseColorFactor", color_factor(material.color)},
                {"metallicFactor", 0},
                {"roughnessFactor", std::stod(fmt::format("{:.6g}", material.roughness))}}}};
    if (material.color[3] < 1) json["alphaMode"] = "BLEND";
    if (material.double_sided) json["doubleSided"] = true;
    return json;
  }

  static Json json_of(const GlbModel::Primitive& primitive) {
    Json json{{"mode", static_cast<int>(primitive.mode)}};
    for (const auto& [semantic, accessor] : primitive.attributes) json["attributes"][semantic] = accessor;
    if (primitive.indices) json["indices"] = *primitive.indices;
    if (primitive.material) json["material"] = *primitive.material;
    for (const GlbModel::Target& target : primitive.targets) {
      Json attributes{{"POSITION", target.positions}};
      if (target.normals) attributes["NORMAL"] = *target.normals;
      json["targets"].push_back(std::move(attributes));
    }
    return json;
  }

  static Json json_of(const GlbModel::Mesh& mesh) {
    Json json{{"name", mesh.name}};
    for (const GlbModel::Primitive& primitive : mesh.primitives)
      json["primitives"].push_back(json_of(primitive));
    if (mesh.target_names.empty()) return json;
    json["weights"] = std::vector<int>(mesh.target_names.size(), 0);
    json["extras"]["targetNames"] = mesh.target_names;
    return json;
  }

  void add_accessors(Json& root) const {
    Json views = Json::array();
    for (const GlbModel::Accessor& accessor : model_.accessors_) {
      Json json;
      if (accessor.offset) {
        json["bufferView"] = views.size();
        Json view{{"buffer", 0}, {"byteOffset", *accessor.offset}, {"byteLength", accessor.length}};
        if (accessor.kind == GlbModel::Kind::vertices) view["target"] = array_buffer;
        if (accessor.kind == GlbModel::Kind::indices) view["target"] = element_array_buffer;
        views.push_back(std::move(view));
      }
      json["componentType"] = accessor.is_float ? float_number : unsigned_int;
      json["count"] = accessor.count;
      json["type"] = accessor.type;
      if (!accessor.lo.empty()) json["min"] = bounds(accessor.lo), json["max"] = bounds(accessor.hi);
      root["accessors"].push_back(std::move(json));
    }
    if (views.empty()) return;
    root["bufferViews"] = std::move(views);
    root["buffers"] = Json::array({{{"byteLength", model_.data_.size()}}});
  }

  void add_animation(Json& root) const {
    Json channels = Json::array(), samplers = Json::array();
    for (std::size_t i = 0; i < model_.nodes.size(); ++i) {
      const GlbModel::Node& node = model_.nodes[i];
      if (!node.times || !node.weights) continue;
      channels.push_back({{"sampler", samplers.size()}, {"target", {{"node", i}, {"path", "weights"}}}});
      samplers.push_back({{"input", *node.times}, {"output", *node.weights}, {"interpolation", "LINEAR"}});
    }
    if (channels.empty()) return;
    root["animations"] =
        Json::array({{{"name", model_.name}, {"channels", channels}, {"samplers", samplers}}});
  }

  const GlbModel& model_;
};

GlbModel::Index GlbModel::add(Accessor accessor, std::span<const float> numbers) {
  accessor.offset = data_.size();
  accessor.length = 4 * numbers.size();
  for (const float number : numbers) append_binary<ByteOrder::little>(data_, number);
  accessors_.push_back(std::move(accessor));
  return static_cast<Index>(accessors_.size() - 1);
}

GlbModel::Index GlbModel::add_vectors(std::span<const Vec3f> values) {
  Accessor accessor{.type = "VEC3", .count = values.size()};
  std::vector<float> numbers;
  numbers.reserve(3 * values.size());
  Vec3f lo = values.empty() ? Vec3f{} : values[0], hi = lo;
  for (const Vec3f& x : values) {
    for (const float number : {x.x, x.y, x.z}) numbers.push_back(number);
    lo = {std::min(lo.x, x.x), std::min(lo.y, x.y), std::min(lo.z, x.z)};
    hi = {std::max(hi.x, x.x), std::max(hi.y, x.y), std::max(hi.z, x.z)};
  }
  accessor.lo = {lo.x, lo.y, lo.z};
  accessor.hi = {hi.x, hi.y, hi.z};
  return add(std::move(accessor), numbers);
}

GlbModel::Index GlbModel::add_uvs(std::span<const std::array<float, 2>> values) {
  std::vector<float> numbers;
  numbers.reserve(2 * values.size());
  for (const auto& [u, v] : values) numbers.push_back(u), numbers.push_back(v);
  return add({.type = "VEC2", .count = values.size()}, numbers);
}

GlbModel::Index GlbModel::add_scalars(std::span<const float> values) {
  return add({.count = values.size()}, values);
}

GlbModel::Index GlbModel::add_times(std::span<const float> values) {
  const auto [lo, hi] = std::minmax_element(values.begin(), values.end());
  return add({.count = values.size(), .kind = Kind::other, .lo = {*lo}, .hi = {*hi}}, values);
}

GlbModel::Index GlbModel::add_weights(std::span<const float> values) {
  return add({.count = values.size(), .kind = Kind::other}, values);
}

GlbModel::Index GlbModel::add_indices(std::span<const Triangle> triangles) {
  Accessor accessor{
      .is_float = false, .count = 3 * triangles.size(), .offset = data_.size(), .kind = Kind::indices};
  accessor.length = 4 * accessor.count;
  for (const Triangle& t : triangles)
    for (const std::uint32_t vertex : t) append_binary<ByteOrder::little>(data_, vertex);
  accessors_.push_back(std::move(accessor));
  return static_cast<Index>(accessors_.size() - 1);
}

GlbModel::Index GlbModel::add_zeros(std::size_t count) {
  accessors_.push_back({.type = "VEC3", .count = count, .lo = {0, 0, 0}, .hi = {0, 0, 0}});
  return static_cast<Index>(accessors_.size() - 1);
}

std::string GlbModel::bytes() const {
  std::string json;
  try {
    json = GlbJson(*this).make().dump();
  } catch (const nlohmann::json::exception&) {
    throw Error(name +
                ": the name of an object or of the folder is not UTF-8, which glTF requires; rename it");
  }
  json.resize(padded(json.size()), ' ');
  const std::uint64_t data_size = padded(data_.size());
  const std::uint64_t size = 12 + 8 + json.size() + (data_.empty() ? 0 : 8 + data_size);
  if (size > std::numeric_limits<std::uint32_t>::max())
    throw Error(fmt::format(
        "{}: would be {} bytes as a .glb, which holds at most 4 GiB; write a file per frame", name, size));
  std::string out = "glTF";
  out.reserve(size);
  append_binary<ByteOrder::little>(out, std::uint32_t{2});  // version
  append_binary<ByteOrder::little>(out, static_cast<std::uint32_t>(size));
  append_binary<ByteOrder::little>(out, static_cast<std::uint32_t>(json.size()));
  out += "JSON" + json;
  if (data_.empty()) return out;
  append_binary<ByteOrder::little>(out, static_cast<std::uint32_t>(data_size));
  out.append("BIN\0", 4);
  out += data_;
  out.resize(size, '\0');
  return out;
}

}  // namespace souple
