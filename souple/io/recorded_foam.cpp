#include "souple/io/recorded_foam.h"

#include "souple/mesh_files/mesh_write.h"
#include "souple/world/world.h"

#include <algorithm>

namespace souple {

bool foams(const World& world) {
  const std::vector<ObjectId> objects = world.objects();
  return !world.foam().positions.empty() || std::any_of(objects.begin(), objects.end(), [&](ObjectId object) {
    return world.kind(object) == ObjectKind::fluid && world.fluid_material(object).foam > 0;
  });
}

RecordedFoam::RecordedFoam(const RecordingPlan& plan, std::string file_name, std::uint64_t before,
                           std::uint64_t kept)
    : file_name_(std::move(file_name)),
      first_(kept > 0 ? 1 : before + 1),
      writer_(
          plan.folder, file_name_, "ply",
          [this](std::span<const Vec3f> positions, std::span<const Vec3f> velocities) {
            return ply_bytes(positions, velocities, kinds_);
          },
          kept) {
  if (kept == 0) writer_.skip_to(first_);
}

void RecordedFoam::append(const World& world) {
  const FoamView foam = world.foam();
  kinds_.clear();
  for (const FoamKind kind : foam.kinds) kinds_.push_back(static_cast<std::uint8_t>(kind));
  writer_.append(foam.positions, foam.velocities);
}

void RecordedFoam::drop_after(std::uint64_t frames) {
  writer_.drop_after(std::max(frames, first_ - 1));
}

ManifestObject RecordedFoam::manifest() const {
  ManifestObject object;
  object.name = object.kind = foam_kind_name;
  object.files.push_back({"ply", frame_file_name(file_name_, first_, "ply"), writer_.frames() + 1 - first_});
  return object;
}

}  // namespace souple
