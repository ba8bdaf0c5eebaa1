#include "app/view/past.h"

#include <utility>
#include <variant>

namespace souple::viewer {

namespace {

std::size_t bytes_of_points(const std::vector<Vec3d>& points) {
  return points.size() * sizeof(Vec3d);
}
template <class Other>
std::size_t bytes_of_points(const Other&) {
  return 0;
}

struct PointBytes {
  std::size_t operator()(const RopeDescription& rope) const { return bytes_of_points(rope.points); }
  std::size_t operator()(const GrainsDescription& grains) const { return of_choice(grains.centers); }
  std::size_t operator()(const FluidDescription& fluid) const { return of_choice(fluid.filling); }
  template <class Other>
  std::size_t operator()(const Other&) const {
    return 0;
  }
  template <class Choice>
  static std::size_t of_choice(const Choice& choice) {
    return std::visit([](const auto& one) { return bytes_of_points(one); }, choice);
  }
};

}  // namespace

std::size_t bytes_of(const Setup& setup) {
  std::size_t bytes = sizeof(Setup);
  for (const AnyObjectDescription& object : setup.scene.objects)
    bytes += sizeof(object) + std::visit(PointBytes{}, object);
  return bytes;
}

void Past::add(PastState state) {
  bytes_ += state.bytes;
  states_.push_back(std::move(state));
  while (bytes_ > max_bytes_ && states_.size() > 1) {
    bytes_ -= states_.front().bytes;
    states_.pop_front();
  }
  shown_ = states_.size() - 1;
  steps_ = 0;
}

void Past::move_on() {
  if (!shown_) return;
  while (states_.size() > *shown_ + 1) {
    bytes_ -= states_.back().bytes;
    states_.pop_back();
  }
  shown_.reset();
  steps_ = 0;
}

void Past::clear() {
  states_.clear();
  bytes_ = steps_ = 0;
  shown_.reset();
}

}  // namespace souple::viewer
