#include "souple/host/grab.h"

#include "souple/geometry/measures.h"
#include "souple/objects/kind_traits.h"
#include "souple/solver/projector.h"
#include "souple/world/world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <fmt/core.h>

namespace souple {

/// State shared by a Grab and its projector; either may be destroyed first.
struct GrabState {
  World* world = nullptr;
  ProjectorId id{};
  ObjectId object{};
  bool in_world = false;    ///< the projector exists
  bool holds = false;       ///< the projector has particles to move
  Vec3d target{};           ///< target of the particles' mean [m]
  Vec3d mean{};             ///< mean of the particles after the last substep [m]
  Vec3d offset{};           ///< from the mean to the picked point [m]
  double max_force = 0;     ///< N
  double stiffness = 0;     ///< N/m
  double damping_time = 0;  ///< s
};

namespace {

constexpr double g = 9.81;       // m/s^2, independent of the scene's gravity
constexpr double strength = 20;  // max_force, in weights of the object
constexpr double stretch = 0.2;  // elongation of the spring at max_force [m]: 5 Hz
// Additional strains up to which the grab acts with full force, and from which on it does not act. With these
// limits no shipped cloth stretched by more than 21 % under violent mouse motions. Without them, 20 weights
// at one grab stretched some cloths to three times their length.
constexpr double thin_slack = 0.03, thin_limit = 0.1, soft_slack = 0.1, soft_limit = 0.4;
constexpr double neighborhood = 0.04;  // radius of the grab, in diagonals of the object

/// The object around the grab: vertices as blends of particles, and edges with their rest lengths.
struct Patch {
  struct Edge {
    std::uint32_t a = 0, b = 0;  // indices in `blends`
    double rest = 0;             // m
  };
  std::vector<std::vector<Carrier>> blends;
  std::vector<Edge> edges;
  double slack = 0;  // strain up to which the grab acts with full force
  double limit = 0;  // strain from which on the grab does not act
};

/// A damped spring on the weighted mean x = sum b_i x_i of some particles, by the formulas of projection.h:
///   C = x - t  [m, a vector],   grad_i C = b_i,
///   dlambda = (-C - alpha~ lambda - gamma (x - x_start)) / ((1 + gamma) sum_i w_i b_i^2 + alpha~)
/// The target t is kept within F alpha of x, and |lambda| within F h^2. Neither spring nor damper thus
/// exceeds the force F, and the speed toward a distant target is limited by the damper. F is max_force,
/// reduced where the object around the grab is stretched, so that the grab yields before the cloth does.
/// Critically damped for the object's mass. Independent of the mode.
class GrabProjector final : public Projector {
 public:
  GrabProjector(std::shared_ptr<GrabState> state, std::vector<Carrier> hand, Patch patch)
      : state_(std::move(state)), hand_(std::move(hand)), patch_(std::move(patch)) {
    state_->in_world = state_->holds = true;
  }
  ~GrabProjector() override { state_->in_world = state_->holds = false; }
  GrabProjector(const GrabProjector&) = delete;
  GrabProjector& operator=(const GrabProjector&) = delete;

  std::string_view kind() const override { return "grab"; }
  std::size_t size() const override { return state_->holds ? 1 : 0; }
  void prepare(std::size_t) override {}
  int color_count() const override { return static_cast<int>(size()); }
  void begin_substep(const ParticleView& particles, const Substep& substep) override;
  std::size_t color_size(int) const override { return 1; }
  void project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
               const Substep& substep) override;
  Residual residual(const ParticleView&, Threads*) const override {
    return {};
  }  // the spring's elongation is no error
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  void erase_particles(std::uint32_t begin, std::uint32_t end) override;

 private:
  double strain(const ParticleView& particles);

  std::shared_ptr<GrabState> state_;
  std::vector<Carrier> hand_;
  Patch patch_;
  std::vector<Vec3d> vertices_;  // scratch: positions of the patch
  double force_ = 0;             // F [N]
  Vec3d target_{}, lambda_{};
};

Vec3d shortened(const Vec3d& v, double longest) {
  const double l = length(v);
  return l > longest ? v * (longest / l) : v;
}

Vec3d blend(const ParticleView& particles, const std::vector<Carrier>& carriers) {
  Vec3d sum;
  for (const Carrier& c : carriers) sum += particles.exact_position(c.particle) * c.weight;
  return sum;
}

/// The largest extension of the patch's edges.
double largest_strain(const Patch& patch, const std::vector<Vec3d>& x) {
  double largest = 0;
  for (const Patch::Edge& edge : patch.edges)
    largest = std::max(largest, length(x[edge.a] - x[edge.b]) / edge.rest - 1);
  return largest;
}

double GrabProjector::strain(const ParticleView& particles) {
  vertices_.resize(patch_.blends.size());
  for (std::size_t v = 0; v < vertices_.size(); ++v) vertices_[v] = blend(particles, patch_.blends[v]);
  return largest_strain(patch_, vertices_);
}

void GrabProjector::begin_substep(const ParticleView& particles, const Substep&) {
  lambda_ = {};
  if (!state_->holds) return;
  const double spare = (patch_.limit - strain(particles)) / (patch_.limit - patch_.slack);
  force_ = state_->max_force * std::clamp(spare, 0.0, 1.0);
  const Vec3d x = blend(particles, hand_);
  target_ = x + shortened(state_->target - x, force_ / state_->stiffness);
}

void GrabProjector::project(int, std::size_t, std::size_t, const ParticleView& particles,
                            const Substep& substep) {
  const double h2 = static_cast<double>(substep.h) * static_cast<double>(substep.h);
  const double alpha = 1 / (state_->stiffness * h2);
  const double gamma = state_->damping_time / static_cast<double>(substep.h);
  double W = 0;
  Vec3d moved;
  for (const Carrier& c : hand_) {
    W += static_cast<double>(particles.inverse_mass(c.particle)) * c.weight * c.weight;
    moved += Vec3d(particles.moved(c.particle)) * c.weight;
  }
  const Vec3d C = blend(particles, hand_) - target_;
  const Vec3d wanted = lambda_ - (C + lambda_ * alpha + moved * gamma) / ((1 + gamma) * W + alpha);
  const Vec3d dlambda = shortened(wanted, force_ * h2) - lambda_;
  lambda_ += dlambda;
  for (const Carrier& c : hand_)
    particles.correct(c.particle,
                      Vec3f(dlambda * (static_cast<double>(particles.inverse_mass(c.particle)) * c.weight)));
  state_->mean = blend(particles, hand_);
}

void GrabProjector::visit(const ParticleView& particles, const ConstraintVisitor& visitor) const {
  if (!state_->holds) return;
  std::vector<std::uint32_t> indices;
  for (const Carrier& c : hand_) indices.push_back(c.particle);
  visitor({indices, 0, 0, static_cast<float>(length(blend(particles, hand_) - state_->target))});
}

/// Returns false if a particle was erased: the whole object was removed then.
bool renumber(std::vector<Carrier>& carriers, std::uint32_t begin, std::uint32_t end) {
  for (Carrier& c : carriers) {
    if (c.particle >= begin && c.particle < end) return false;
    if (c.particle >= end) c.particle -= end - begin;
  }
  return true;
}

void GrabProjector::erase_particles(std::uint32_t begin, std::uint32_t end) {
  state_->holds = state_->holds && renumber(hand_, begin, end);
  for (std::vector<Carrier>& blend : patch_.blends)
    state_->holds = state_->holds && renumber(blend, begin, end);
}

struct Neighbor {
  std::uint32_t vertex;
  double distance;  // from the picked vertex, in radii of the grab
};

constexpr double patch_size = 2;  // in radii of the grab

/// The grab's radius: at least up to the neighbors of the picked vertex, for coarse meshes.
double reach_of(double size, double longest_edge) {
  return std::max(neighborhood * size, 1.5 * longest_edge);
}

std::vector<Neighbor> around_on_mesh(const TriangleMesh& mesh, std::uint32_t vertex) {
  const std::vector<Vec3d>& rest = mesh.positions;
  double longest = 0;
  for (const Triangle& t : mesh.triangles)
    if (std::find(t.begin(), t.end(), vertex) != t.end())
      for (const std::uint32_t v : t) longest = std::max(longest, length(rest[v] - rest[vertex]));
  const double reach = reach_of(bounding_box(rest).diagonal(), longest);
  std::vector<Neighbor> result;
  for (std::uint32_t v = 0; v < rest.size(); ++v) {
    const double distance = v == vertex ? 0 : length(rest[v] - rest[vertex]) / reach;
    if (distance < patch_size) result.push_back({v, distance});
  }
  return result;
}

/// Distances along the current rope; the rope keeps its length.
std::vector<Neighbor> around_on_rope(std::span<const Vec3f> x, std::uint32_t vertex) {
  std::vector<double> along{0};
  double longest = 0;
  for (std::size_t v = 1; v < x.size(); ++v) {
    const double edge = length(Vec3d(x[v]) - Vec3d(x[v - 1]));
    along.push_back(along.back() + edge);
    longest = std::max(longest, edge);
  }
  const double reach = reach_of(along.back(), longest);
  std::vector<Neighbor> result;
  for (std::uint32_t v = 0; v < x.size(); ++v) {
    const double distance = v == vertex ? 0 : std::fabs(along[v] - along[vertex]) / reach;
    if (distance < patch_size) result.push_back({v, distance});
  }
  return result;
}

std::vector<Neighbor> neighbors_of(const World& world, ObjectId object, std::uint32_t vertex) {
  const ObjectShape shape = traits_of(world.kind(object)).shape;
  if (shape == ObjectShape::balls) return {{vertex, 0}};
  if (shape == ObjectShape::line) return around_on_rope(world.positions(object), vertex);
  return around_on_mesh(world.mesh(object), vertex);
}

bool is_pinned(const Carrier& carrier) {
  return carrier.inverse_mass == 0;
}

/// The grabbed particles, with weights that decrease with distance from the vertex and sum to 1.
std::vector<Carrier> hand_of(const World& world, ObjectId object, const std::vector<Neighbor>& neighbors) {
  std::map<std::uint32_t, Carrier> hand;  // by particle: several vertices may share a particle
  double sum = 0;
  for (const Neighbor& n : neighbors) {
    if (n.distance >= 1) continue;
    const double fall_off = (1 - n.distance * n.distance) * (1 - n.distance * n.distance);
    for (Carrier c : world.carriers(object, n.vertex)) {
      if (is_pinned(c)) continue;
      const double weight = c.weight * fall_off;
      c.weight = 0;
      hand.try_emplace(c.particle, c).first->second.weight += weight;
      sum += weight;
    }
  }
  std::vector<Carrier> result;
  for (auto& [particle, carrier] : hand) {
    carrier.weight /= sum;
    result.push_back(carrier);
  }
  return result;
}

Patch patch_of(const World& world, ObjectId object, const std::vector<Neighbor>& neighbors) {
  Patch patch;
  std::vector<Vec3d> now;
  constexpr auto outside = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> local(world.positions(object).size(),
                                   outside);  // per vertex: index in the patch
  for (const Neighbor& n : neighbors) {
    local[n.vertex] = static_cast<std::uint32_t>(patch.blends.size());
    patch.blends.push_back(world.carriers(object, n.vertex));
    now.emplace_back();
    for (const Carrier& c : patch.blends.back()) now.back() += c.position * c.weight;
  }
  const std::vector<Vec3d>& rest = world.mesh(object).positions;
  for (const Triangle& t : world.triangles(object))
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = t[k], b = t[(k + 1) % 3];
      if (local[a] == outside || local[b] == outside) continue;
      const double edge = length(rest[a] - rest[b]);
      if (edge > 0) patch.edges.push_back({local[a], local[b], edge});
    }
  const ObjectShape shape = traits_of(world.kind(object)).shape;
  if (shape == ObjectShape::line)
    for (std::uint32_t v = 0; v + 1 < now.size(); ++v)
      if (!(now[v + 1] == now[v])) patch.edges.push_back({v, v + 1, length(now[v + 1] - now[v])});
  const bool thin = shape != ObjectShape::solid;
  const double already = largest_strain(patch, now);
  patch.slack = already + (thin ? thin_slack : soft_slack);
  patch.limit = already + (thin ? thin_limit : soft_limit);
  return patch;
}

/// Mass that the grab moves. [kg]
double mass_of(const World& world, ObjectId object, const std::vector<Carrier>& hand) {
  if (traits_of(world.kind(object)).shape == ObjectShape::balls)
    return 1 / static_cast<double>(hand.front().inverse_mass);
  return world.total_mass(object);
}

void require_finite(const Vec3f& point, const char* what) {
  if (!is_finite(point)) throw Error(std::string(what) + ": the point is not finite");
}

void require_usable(const GrabOptions& options) {
  if (!(options.max_force >= 0) || !std::isfinite(options.max_force) || !(options.stiffness >= 0) ||
      !std::isfinite(options.stiffness))
    throw Error(fmt::format("grab: max_force is {} N and stiffness {} N/m, expected finite numbers >= 0",
                            options.max_force, options.stiffness));
}

}  // namespace

Grab::Grab(World& world, const ObjectId& object, std::uint32_t vertex, const Vec3f& point,
           const GrabOptions& options)
    : state_(std::make_shared<GrabState>()) {
  require_finite(point, "grab");
  require_usable(options);
  GrabState& state = *state_;
  state.world = &world, state.object = object;
  state.target = state.mean = Vec3d(point);
  const std::vector<Carrier> own = world.carriers(object, vertex);
  if (std::all_of(own.begin(), own.end(), is_pinned)) return;
  const std::vector<Neighbor> neighbors = neighbors_of(world, object, vertex);
  std::vector<Carrier> hand = hand_of(world, object, neighbors);
  const double mass = mass_of(world, object, hand);
  state.max_force = options.max_force > 0 ? static_cast<double>(options.max_force) : strength * mass * g;
  state.stiffness =
      options.stiffness > 0 ? static_cast<double>(options.stiffness) : state.max_force / stretch;
  state.damping_time = 2 * std::sqrt(mass / state.stiffness);
  state.mean = {};
  for (const Carrier& c : hand) state.mean += c.position * c.weight;
  state.offset = Vec3d(point) - state.mean;
  state.target = state.mean;
  state.id = world.add_projector(
      std::make_unique<GrabProjector>(state_, std::move(hand), patch_of(world, object, neighbors)));
}

Grab::~Grab() {
  release();
}

Grab::Grab(Grab&&) noexcept = default;

Grab& Grab::operator=(Grab&& other) noexcept {
  if (this == &other) return *this;
  release();
  state_ = std::move(other.state_);
  return *this;
}

void Grab::move_to(const Vec3f& point) {
  require_finite(point, "grab");
  state_->target = Vec3d(point) - state_->offset;
}

void Grab::release() noexcept {
  if (!state_ || !state_->in_world) return;
  state_->holds = false;
  try {
    state_->world->remove(state_->id);
  } catch (...) {
    // During a step, after one that threw, or without memory: the projector stays in the world, inactive.
  }
}

bool Grab::holds() const {
  return state_ && state_->in_world && state_->holds && state_->world->contains(state_->object);
}

Vec3f Grab::target() const {
  return Vec3f(state_->target + state_->offset);
}

Vec3f Grab::point() const {
  return Vec3f(state_->mean + state_->offset);
}

float Grab::max_force() const {
  return static_cast<float>(state_->max_force);
}

}  // namespace souple
