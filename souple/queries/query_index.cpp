#include "souple/queries/query_index.h"

#include "souple/contacts/contact_material.h"
#include "souple/objects/kind_functions.h"
#include "souple/objects/object.h"
#include "souple/queries/caches.h"
#include "souple/queries/mirror.h"
#include "souple/queries/query_view.h"

#include <algorithm>

namespace souple {
namespace {

double ball_radius(const Object& object) {
  return static_cast<double>(particle_radius(object.material));
}

Bounds box_around(std::span<const Vec3f> points) {
  Bounds box{points[0], points[0]};
  for (const Vec3f& x : points) box = united(box, {x, x});
  return box;
}

}  // namespace

void QueryIndex::refresh(const QueryView& view) {
  if (version_.load(std::memory_order_acquire) == view.version) return;
  const std::lock_guard<std::mutex> lock(view.caches.lock);
  if (version_.load(std::memory_order_relaxed) == view.version) return;
  find_boxes(view);
  version_.store(view.version, std::memory_order_release);
}

void QueryIndex::find_boxes(const QueryView& view) {
  entries_.resize(std::min(entries_.size(), view.objects.size()));
  while (entries_.size() < view.objects.size()) entries_.push_back(std::make_unique<Entry>());
  filled_.clear();
  largest_radius_ = 0;
  for (std::uint32_t a = 0; a < view.objects.size(); ++a) {
    const Object& object = *view.objects[a];
    Entry& entry = *entries_[a];
    entry.object = &object;
    entry.x = mirrored_positions(view, object, view.caches.mirrors[object.id.value]);
    entry.triangles = object.mesh.triangles;
    entry.radius = entry.triangles.empty() ? ball_radius(object) : 0;
    if (entry.x.empty()) continue;
    entry.box = box_around(entry.x);
    largest_radius_ = std::max(largest_radius_, entry.radius);
    filled_.push_back(a);
  }
  objects_.update(filled_.size(), [&](std::uint32_t k) { return entries_[filled_[k]]->box; });
}

const BoxTree& QueryIndex::tree(const QueryView& view, const Entry& entry) const {
  if (entry.version.load(std::memory_order_acquire) == view.version) return entry.tree;
  const std::lock_guard<std::mutex> lock(view.caches.lock);
  if (entry.version.load(std::memory_order_relaxed) == view.version) return entry.tree;
  const std::span<const Vec3f> x = entry.x;
  if (entry.triangles.empty()) {
    entry.tree.update(x.size(), [&](std::uint32_t v) { return Bounds{x[v], x[v]}; });
  } else {
    entry.tree.update(entry.triangles.size(), [&](std::uint32_t t) {
      const auto& [a, b, c] = entry.triangles[t];
      return united(united({x[a], x[a]}, {x[b], x[b]}), {x[c], x[c]});
    });
  }
  entry.version.store(view.version, std::memory_order_release);
  return entry.tree;
}

std::size_t QueryIndex::bytes() const {
  std::size_t sum = objects_.bytes() + filled_.capacity() * sizeof(std::uint32_t);
  for (const auto& entry : entries_) sum += sizeof(Entry) + entry->tree.bytes();
  return sum;
}

}  // namespace souple
