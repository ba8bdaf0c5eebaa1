#include "souple/fluid/foam.h"

#include "souple/math/elementary.h"
#include "souple/state/bytes.h"

#include <algorithm>
#include <cmath>

namespace souple {

namespace {

/// Hash of a counter: the finalizer of SplitMix64 (Steele, Lea and Flood 2014).
std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

class RandomSequence {
 public:
  explicit RandomSequence(std::uint64_t key) : key_(mix(key)) {}
  /// In [0, 1).
  float next() { return static_cast<float>(mix(key_ + 0x9e3779b97f4a7c15u * ++count_) >> 40) * 0x1p-24f; }

 private:
  std::uint64_t key_, count_ = 0;
};

/// Radial speed of a new particle per meter of distance from the axis of its cylinder [1/s].
constexpr float spread = 10;

float ramp(float value, const FoamRange& range) {
  const float part = (value - range.low) / (range.high - range.low);
  return min(max(part, 0.0f), 1.0f);
}

/// Two unit vectors that form an orthonormal basis with the unit vector n (Duff et al. 2017).
struct TangentBasis {
  Vec3f a, b;
  explicit TangentBasis(const Vec3f& n) {
    const float sign = n.z < 0 ? -1.0f : 1.0f, s = -1 / (sign + n.z), t = n.x * n.y * s;
    a = {1 + sign * n.x * n.x * s, sign * t, -sign * n.x};
    b = {t, sign + n.y * n.y * s, -n.y};
  }
};

}  // namespace

void FoamState::resize(std::size_t count) {
  position.resize(count), velocity.resize(count), life.resize(count), age.resize(count), kind.resize(count);
}

void FoamState::reserve(std::size_t count) {
  position.reserve(count), velocity.reserve(count), life.reserve(count), age.reserve(count);
  kind.reserve(count);
}

void Foam::reserve(std::size_t count) {
  state_.reserve(count);
  start_.reserve(count);
}

void Foam::add(const Vec3f& x, const Vec3f& v, float life) {
  state_.position.push_back(x);
  state_.velocity.push_back(v);
  state_.life.push_back(life);
  state_.age.push_back(0);
  state_.kind.push_back(FoamKind::spray);
}

void Foam::shift(const Vec3f& by) {
  for (Vec3f& x : state_.position) x += by;
}

std::size_t Foam::bytes() const {
  return bytes_of(state_.position, state_.velocity, state_.life, state_.age, state_.kind, start_, normals_,
                  made_, share_, spawners_) +
         order_.bytes();
}

void Foam::find_cells(const FluidView& fluid, Threads& threads) {
  cell_size_ = fluid.smoothing.support();
  order_.build(fluid.x.first(fluid.size()), cell_size_, threads);
}

// The kernel-weighted mean velocity of the fluid, and the number of fluid particles within two spacings.
Foam::Neighborhood Foam::neighborhood(const FluidView& fluid, const Vec3f& at) const {
  std::int32_t cell[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double where =
        (static_cast<double>(at[axis]) - order_.corner(axis)) / static_cast<double>(cell_size_);
    if (!(std::abs(where) < 1e9)) return {};
    cell[axis] = static_cast<std::int32_t>(std::floor(where));
  }
  const auto rows = order_.rows();
  const auto cells = order_.cells();
  const float inverse_h = 1 / cell_size_, counted = 2 * fluid.smoothing.spacing();
  Neighborhood result;
  float weights = 0;
  const float *x = order_.component(0), *y = order_.component(1), *z = order_.component(2);
  const auto add = [&](std::uint32_t k) {
    const float dx = x[k] - at.x, dy = y[k] - at.y, dz = z[k] - at.z;
    const float r2 = dx * dx + dy * dy + dz * dz;
    if (!(r2 < cell_size_ * cell_size_)) return;
    const float q = std::sqrt(r2) * inverse_h;
    const float weight = (1 - q) * (1 - q);
    result.velocity += fluid.v[order_.order()[k]].xyz() * weight;
    weights += weight;
    if (r2 < counted * counted) ++result.neighbors;
  };
  for (std::int32_t layer = cell[2] - 1; layer <= cell[2] + 1; ++layer) {
    const auto before = [&](const CellOrder::Row& row, std::int32_t y0) {
      return row.z != layer ? row.z < layer : row.y < y0;
    };
    for (auto row = std::lower_bound(rows.begin(), rows.end() - 1, cell[1] - 1, before);
         row != rows.end() - 1 && row->z == layer && row->y <= cell[1] + 1; ++row) {
      const CellOrder::Cell *const first = cells.data() + row->begin, *const last =
                                                                          cells.data() + (row + 1)->begin;
      for (auto c = std::lower_bound(first, last, cell[0] - 1,
                                     [](const CellOrder::Cell&one, std::int32_t x0) { return one.x < x0; });
           c != last && c->x <= cell[0] + 1; ++c)
        for (std::uint32_t k = c->begin; k < (c + 1)->begin; ++k) add(k);
    }
  }
  if (weights > 0) result.velocity *= 1 / weights;
  return result;
}

FoamKind Foam::kind_of(const Neighborhood& neighborhood, const FoamParameters& parameters) {
  if (neighborhood.neighbors < parameters.spray_neighbors) return FoamKind::spray;
  return neighborhood.neighbors > parameters.bubble_neighbors ? FoamKind::bubble : FoamKind::foam;
}

void Foam::move(const FoamStep& step, const FoamParameters& parameters, Threads& threads) {
  // dv/dt = -buoyancy g + drag (v_fluid - v)
  const Vec3f rise = step.gravity * (-parameters.buoyancy / parameters.drag);
  const float dt = step.dt, kept = static_cast<float>(elementary::exp(double{-parameters.drag * dt}));
  FoamState& s = state_;
  start_.assign(s.position.begin(), s.position.end());
  for_each_index(size(), threads, [&](std::size_t k) {
    const Neighborhood here = neighborhood(step.fluid, s.position[k]);
    Vec3f& v = s.velocity[k];
    const Vec3f before = v;
    s.kind[k] = kind_of(here, parameters);
    if (s.kind[k] == FoamKind::spray) {
      v += step.gravity * dt;
    } else if (s.kind[k] == FoamKind::bubble) {
      const Vec3f end = here.velocity + rise;
      v = end + (v - end) * kept;
    } else {
      v = here.velocity;
      s.life[k] -= dt;
    }
    s.position[k] += (s.kind[k] == FoamKind::spray ? (before + v) * 0.5f : v) * dt;
    s.age[k] += dt;
    if (s.age[k] > parameters.longest_life || !is_finite(s.position[k])) s.life[k] = 0;
  });
}

void Foam::dissolve() {
  FoamState& s = state_;
  std::size_t kept = 0;
  for (std::size_t k = 0; k < size(); ++k) {
    if (!(s.life[k] > 0)) continue;
    s.position[kept] = s.position[k], s.velocity[kept] = s.velocity[k], s.life[kept] = s.life[k];
    s.age[kept] = s.age[k], s.kind[kept] = s.kind[k];
    ++kept;
  }
  report_.dissolved = size() - kept;
  s.resize(kept);
}

// Outward unit normals of surface particles. h |V sum grad W| is about 1 in the top layer of a pool and 0 in the second
// layer. Where particles are disordered it is about 0.3.
void Foam::find_normals(const FoamStep& step, Threads& threads) {
  const FluidView& fluid = step.fluid;
  const Smoothing& smoothing = fluid.smoothing;
  normals_.resize(fluid.size());
  fluid.for_lists(threads, [&](std::uint32_t k, std::span<const std::uint32_t> list) {
    Vec3f n =
        kernels_->sums(fluid.x.data(), fluid.x[k], list.data(), list.size(), smoothing.factors()).gradient *
        smoothing.volume();
    // Half of a wall's slope: the full slope includes the motion of the mirrored fluid.
    if (!step.wall_slopes.empty()) n += step.wall_slopes[k] * 0.5f;
    n *= -smoothing.support();
    const float size = length(n);
    normals_[k] = size > 0.75f ? n * (1 / size) : Vec3f{};
  });
}

// Sum of 1 - n_i . n_j over surface particles behind the surface at i.
float Foam::bend(const FluidView& fluid, std::uint32_t i, std::span<const std::uint32_t> list) const {
  const Vec3f n = normals_[i];
  const float inverse_h = 1 / fluid.smoothing.support();
  float sum = 0;
  for (const std::uint32_t entry : list) {
    const std::uint32_t j = entry / 4;
    if (j == fluid.size()) continue;
    const Vec3f x = fluid.x[i].xyz() - fluid.x[j].xyz(), m = normals_[j];
    if (dot(x, n) > 0 && dot(m, m) > 0) sum += (1 - dot(n, m)) * max(1 - length(x) * inverse_h, 0.0f);
  }
  return sum;
}

Foam::Potential Foam::potential(const FoamStep& step, std::uint32_t i, std::span<const std::uint32_t> list,
                                const FoamParameters& parameters) const {
  const FluidView& fluid = step.fluid;
  const float part = step.share.empty() ? 1 : step.share[i];
  const Vec3f v = fluid.v[i].xyz();
  const float energy = ramp(0.5f * dot(v, v), parameters.energy);
  if (!(energy * part > 0)) return {0, 0};
  const float closing_speed = velocity_->closing_speed(fluid.x.data(), fluid.v.data(), fluid.x[i], fluid.v[i],
                                                       list.data(), list.size(), fluid.smoothing.factors());
  const Vec3f n = normals_[i];
  const float bent = dot(v, n) > 0.6f * length(v) ? bend(fluid, i, list) : 0;
  const float rate = energy * (parameters.trapped_air_rate * ramp(closing_speed, parameters.trapped_air) +
                               parameters.wave_crest_rate * ramp(bent, parameters.wave_crest));
  return {part * rate * step.dt, rate / (parameters.trapped_air_rate + parameters.wave_crest_rate)};
}

void Foam::make(const FoamStep& step, const FoamParameters& parameters, Threads& threads) {
  const std::size_t n = step.fluid.size();
  made_.resize(n);
  share_.resize(n);
  const auto key_of = [&](std::size_t k) { return mix(mix(step.seed) + step.particle[k]); };
  step.fluid.for_lists(threads, [&](std::uint32_t k, std::span<const std::uint32_t> list) {
    const Potential here = potential(step, k, list, parameters);
    const float whole = std::floor(here.made);
    made_[k] = whole + (RandomSequence(key_of(k)).next() < here.made - whole ? 1.0f : 0.0f);
    share_[k] = here.share;
  });
  spawners_.clear();
  spawners_.reserve(n);
  std::uint64_t total = 0;
  for (std::uint32_t k = 0; k < n; ++k) {
    if (!(made_[k] > 0)) continue;
    spawners_.push_back({k, total, share_[k]});
    total += static_cast<std::uint64_t>(made_[k]);
  }
  const std::uint64_t capacity =
      std::min<std::uint64_t>(total, parameters.max_particles - std::min(parameters.max_particles, size()));
  report_.made = static_cast<std::size_t>(capacity);
  report_.thinned = static_cast<std::size_t>(total - capacity);
  // New particle k stays if k capacity / total reaches a new integer: thins evenly over all spawners.
  const auto kept_before = [&](std::uint64_t k) { return total > 0 ? k * capacity / total : 0; };
  start_.clear();
  for (const Spawner& spawner : spawners_) {
    const std::uint64_t end = spawner.first + static_cast<std::uint64_t>(made_[spawner.index]);
    begin(step, spawner, static_cast<std::uint32_t>(kept_before(end) - kept_before(spawner.first)),
          key_of(spawner.index) + 1, parameters);
  }
}

void Foam::begin(const FoamStep& step, const Spawner& spawner, std::uint32_t count, std::uint64_t key,
                 const FoamParameters& parameters) {
  const Vec3f x = step.fluid.x[spawner.index].xyz(), v = step.fluid.v[spawner.index].xyz();
  const TangentBasis basis(normalized(v));
  const float radius = 0.5f * step.fluid.smoothing.spacing();
  RandomSequence random(key);
  for (std::uint32_t k = 0; k < count; ++k) {
    float a = 0, b = 0;
    do {
      a = 2 * random.next() - 1, b = 2 * random.next() - 1;
    } while (a * a + b * b > 1);
    const Vec3f off = (basis.a * a + basis.b * b) * radius;
    start_.push_back(x);
    add(x + off - v * (step.dt * random.next()), v + off * spread,
        parameters.life.low + (parameters.life.high - parameters.life.low) * spawner.share);
  }
}

void Foam::find_kinds(const FluidView& fluid, const FoamParameters& parameters, std::size_t first,
                      Threads& threads) {
  for_each_index(size() - first, threads, [&](std::size_t k) {
    state_.kind[first + k] = kind_of(neighborhood(fluid, state_.position[first + k]), parameters);
  });
}

Foam::Report Foam::count() const {
  Report report = report_;
  for (const FoamKind kind : state_.kind) {
    report.spray += kind == FoamKind::spray ? 1 : 0;
    report.foam += kind == FoamKind::foam ? 1 : 0;
    report.bubbles += kind == FoamKind::bubble ? 1 : 0;
  }
  return report;
}

}  // namespace souple
