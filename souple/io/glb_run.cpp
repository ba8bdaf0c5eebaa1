#include "souple/io/glb_run.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/core.h>

namespace souple {

namespace {

using Index = GlbModel::Index;

/// Adds objects to a model; remembers its materials.
class ObjectWriter {
 public:
  explicit ObjectWriter(GlbModel& model) : model_(model) {}

  /// `velocities`: the file holds one frame.
  void add(const ExportObject& object, const SplitMesh& split, bool velocities) {
    const std::vector<Vec3f> positions = split.spread(object.positions);
    Attributes attributes{{"POSITION", model_.add_vectors(positions)}};
    if (object.shape == ExportShape::surface)
      add_surface(object, split, attributes);
    else if (object.look.radius > 0)
      attributes.emplace_back("_RADIUS",
                              model_.add_scalars(std::vector<float>(positions.size(), object.look.radius)));
    if (!object.foam_kinds.empty())
      attributes.emplace_back("_FOAM_KIND", model_.add_scalars(std::vector<float>(object.foam_kinds.begin(),
                                                                                  object.foam_kinds.end())));
    if (velocities && !object.velocities.empty())
      attributes.emplace_back("_VELOCITY", model_.add_vectors(split.spread(object.velocities)));
    model_.meshes.push_back({object.name, primitives(object, split, attributes), {}});
    model_.nodes.push_back({static_cast<Index>(model_.meshes.size() - 1), {}, {}});
  }

 private:
  using Attributes = std::vector<std::pair<std::string, Index>>;

  void add_surface(const ExportObject& object, const SplitMesh& split, Attributes& attributes) {
    if (object.smooth) attributes.emplace_back("NORMAL", model_.add_vectors(split.spread(object.normals)));
    if (!split.uvs.empty()) {
      std::vector<std::array<float, 2>> uvs = split.uvs;
      for (auto& uv : uvs) uv[1] = 1 - uv[1];  // glTF measures v from the top
      attributes.emplace_back("TEXCOORD_0", model_.add_uvs(uvs));
    }
    if (!object.mesh->colors.empty())
      attributes.emplace_back("COLOR_0", model_.add_vectors(split.spread(object.mesh->colors)));
    if (split.copies.empty()) return;
    std::vector<float> sources;
    for (std::size_t i = 0; i < split.size(); ++i) sources.push_back(static_cast<float>(split.source(i)));
    attributes.emplace_back("_SOUPLE_VERTEX", model_.add_scalars(sources));
  }

  std::vector<GlbModel::Primitive> primitives(const ExportObject& object, const SplitMesh& split,
                                              const Attributes& attributes) {
    if (object.shape != ExportShape::surface) {
      const bool line = object.shape == ExportShape::line && object.positions.size() > 1;
      const auto mode = line ? GlbModel::Mode::line_strip : GlbModel::Mode::points;
      return {{mode, attributes, {}, material_of(object, object.name, object.look), {}}};
    }
    std::vector<GlbModel::Primitive> result;
    for (const SplitMesh::Part& part : split.parts) {
      const bool named = part.material != FaceAppearance::no_material;
      const std::string& name = named ? object.mesh->appearance.materials[part.material] : object.name;
      result.push_back({GlbModel::Mode::triangles,
                        attributes,
                        model_.add_indices(part.triangles),
                        material_of(object, name, named ? object.material_looks[part.material] : object.look),
                        {}});
    }
    return result;
  }

  Index material_of(const ExportObject& object, const std::string& name, const ExportLook& look) {
    const Vec3f& c = look.color;
    const std::array<float, 4> color{c.x, c.y, c.z, look.opacity};
    const bool two_sided = object.kind == "cloth";
    const auto [known, is_new] = materials_.try_emplace({name, color, look.roughness, two_sided},
                                                        static_cast<Index>(model_.materials.size()));
    if (is_new) model_.materials.push_back({name, color, look.roughness, two_sided});
    return known->second;
  }

  GlbModel& model_;
  std::map<std::tuple<std::string, std::array<float, 4>, float, bool>, Index> materials_;
};

SplitMesh split_of(const ExportObject& object) {
  if (object.shape == ExportShape::surface) return split_mesh(*object.mesh);
  SplitMesh whole;
  whole.source_vertices = object.positions.size();
  return whole;
}

std::vector<Vec3f> differences(std::span<const Vec3f> to, std::span<const Vec3f> from) {
  std::vector<Vec3f> result;
  result.reserve(to.size());
  for (std::size_t i = 0; i < to.size(); ++i) result.push_back(to[i] - from[i]);
  return result;
}

}  // namespace

std::string glb_frame(const std::string& run, std::uint64_t frame, double time,
                      std::span<const ExportObject> objects) {
  GlbModel model;
  model.name = run;
  model.extras = fmt::format(R"({{"frame":{},"time":{}}})", frame, time);
  ObjectWriter writer(model);
  for (const ExportObject& object : objects)
    if (!object.positions.empty()) writer.add(object, split_of(object), true);
  return model.bytes();
}

GlbClip::GlbClip(const std::string& run) {
  model_.name = run;
}

void GlbClip::begin(std::span<const ExportObject> objects) {
  ObjectWriter writer(model_);
  for (const ExportObject& object : objects) {
    tracks_.emplace_back();
    if (object.positions.empty()) continue;
    Track& track = tracks_.back().emplace();
    track.split = split_of(object);
    track.smooth = object.shape == ExportShape::surface && object.smooth;
    track.positions.assign(object.positions.begin(), object.positions.end());
    if (track.smooth) track.normals.assign(object.normals.begin(), object.normals.end());
    writer.add(object, track.split, false);
  }
}

void GlbClip::add(double seconds, std::span<const ExportObject> objects) {
  times_.push_back(static_cast<float>(seconds));
  if (times_.size() == 1) return begin(objects);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (!tracks_[i]) continue;
    Track& track = *tracks_[i];
    track.targets.emplace_back();
    if (std::equal(track.positions.begin(), track.positions.end(), objects[i].positions.begin())) continue;
    GlbModel::Target& target = track.targets.back().emplace();
    target.positions =
        model_.add_vectors(track.split.spread(differences(objects[i].positions, track.positions)));
    if (track.smooth)
      target.normals = model_.add_vectors(track.split.spread(differences(objects[i].normals, track.normals)));
  }
}

void GlbClip::end_track(Track& track, std::size_t node) {
  GlbModel::Mesh& mesh = model_.meshes[model_.nodes[node].mesh];
  std::optional<GlbModel::Target> rest;
  std::vector<GlbModel::Target> targets;
  for (std::optional<GlbModel::Target>& target : track.targets) {
    if (!target && !rest) {
      rest.emplace().positions = model_.add_zeros(track.split.size());
      if (track.smooth) rest->normals = rest->positions;
    }
    targets.push_back(target ? *target : *rest);
    mesh.target_names.push_back(fmt::format("frame {}", targets.size() + 1));
  }
  for (GlbModel::Primitive& primitive : mesh.primitives) primitive.targets = targets;
}

std::string GlbClip::bytes() && {
  std::optional<Index> times, weights;
  const std::size_t frames = times_.size();
  std::size_t node = 0;
  for (std::optional<Track>& track : tracks_) {
    if (!track) continue;
    const std::size_t here = node++;
    const auto moves = [](const auto& target) { return target.has_value(); };
    if (std::none_of(track->targets.begin(), track->targets.end(), moves)) continue;
    if (!times) {
      times = model_.add_times(times_);
      std::vector<float> keys(frames * (frames - 1), 0);
      for (std::size_t frame = 1; frame < frames; ++frame) keys[frame * (frames - 1) + frame - 1] = 1;
      weights = model_.add_weights(keys);
    }
    end_track(*track, here);
    model_.nodes[here].times = times;
    model_.nodes[here].weights = weights;
  }
  return model_.bytes();
}

std::uint64_t glb_clip_size(std::uint64_t frames, std::span<const ExportObject> objects) {
  constexpr std::uint64_t vector = 12, json = 700;  // bytes of a vector; of a target's text
  std::uint64_t size = 4 * frames * frames;
  for (const ExportObject& object : objects) {
    const bool smooth = object.shape == ExportShape::surface && object.smooth;
    const std::uint64_t vertices = split_of(object).size();
    size += frames * (vertices * vector * (smooth ? 2 : 1) + json);
    if (object.shape == ExportShape::surface) size += 12 * object.mesh->triangles.size();
  }
  return size;
}

}  // namespace souple
