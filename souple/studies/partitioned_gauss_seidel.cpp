#include "souple/studies/partitioned_gauss_seidel.h"

#include "souple/assert.h"
#include "souple/studies/partition.h"

#include <fmt/core.h>

namespace souple {
namespace {

constexpr std::size_t copy_grain = 4096;  // particles

}  // namespace

/// A constraint set with split particles, as a projector on particles without phantoms. Two additional
/// colors, before and after those of the set, join the phantoms with their particles. So a loop over the
/// colors of a set, forward or backward, need not know about phantoms.
class PartitionedGaussSeidel::Split final : public Projector {
 public:
  Split(Projector& set, std::span<const std::uint32_t> phantom_of, std::uint32_t first_phantom,
        ParticlesAndPhantoms& all)
      : set_(set), all_(all) {
    for (std::uint32_t j = 0; j < phantom_of.size(); ++j) {
      if (particles_.empty() || particles_.back().particle != phantom_of[j])
        particles_.push_back({{}, phantom_of[j], first_phantom + j, first_phantom + j, 0});
      ++particles_.back().end;
    }
  }

  std::string_view kind() const override { return set_.kind(); }
  std::size_t size() const override { return set_.size(); }
  void prepare(std::size_t) override {}
  int color_count() const override { return set_.color_count() + 2; }
  std::size_t color_size(int color) const override {
    return joins(color) ? particles_.size() : set_.color_size(color - 1);
  }
  Facets facets() override { return set_.facets(); }
  using Projector::project;
  void project(int color, std::size_t begin, std::size_t end, const ParticleView&,
               const Substep& substep) override {
    if (!joins(color)) return set_.project(color - 1, begin, end, all_.view, substep);
    for (std::size_t i = begin; i < end; ++i) join(particles_[i]);
  }
  Residual residual(const ParticleView& particles, Threads*) const override {
    return set_.residual(particles);
  }
  void erase_particles(std::uint32_t, std::uint32_t) override {}

 private:
  struct SplitParticle {
    Vec3f joined;  // common position after the last join
    std::uint32_t particle = 0, begin = 0, end = 0;
    std::uint32_t substep = 0;  // substep of `joined`
  };

  bool joins(int color) const { return color == 0 || color == set_.color_count() + 1; }

  // Moves the particle by the displacement of its phantoms' center of mass, then the phantoms to the particle. Another
  // set may have moved the particle alone.
  void join(SplitParticle& split) const {
    SOUPLE_ASSERT(split.end - split.begin >= 2, "a split particle has at least two phantoms");
    const std::span<Vec4f> moving = all_.view.moving;
    Vec4f& particle = moving[split.particle];
    if (split.substep == all_.substep) {
      Vec3f sum{};
      for (std::uint32_t j = split.begin; j < split.end; ++j) sum += moving[j].xyz() - split.joined;
      particle.set_xyz(particle.xyz() + sum / static_cast<float>(split.end - split.begin));
    } else {
      refresh(split);
    }
    split.joined = particle.xyz();
    for (std::uint32_t j = split.begin; j < split.end; ++j) moving[j].set_xyz(split.joined);
  }

  // Once per substep: copies the particle to its phantoms, except for the mass.
  void refresh(SplitParticle& split) const {
    Vec4f position = all_.position[split.particle];
    position.w *= static_cast<float>(split.end - split.begin);
    for (std::uint32_t j = split.begin; j < split.end; ++j) {
      all_.position[j] = position;
      all_.start[j] = all_.start[split.particle];
    }
    split.substep = all_.substep;
  }

  Projector& set_;
  ParticlesAndPhantoms& all_;
  std::vector<SplitParticle> particles_;
};

PartitionedGaussSeidel::PartitionedGaussSeidel(const SolverSettings& settings)
    : colors_(settings.colors), gauss_seidel_(settings) {}

PartitionedGaussSeidel::~PartitionedGaussSeidel() = default;

void PartitionedGaussSeidel::prepare(std::span<Projector* const> projectors, const ParticleView& particles) {
  particle_count_ = particles.position.size();
  split_.clear();
  projectors_.clear();
  std::size_t count = particle_count_;
  for (Projector* projector : projectors) {
    const auto first = static_cast<std::uint32_t>(count);
    const std::vector<std::uint32_t> phantom_of = split(*projector, colors_, first);
    count += phantom_of.size();
    if (!phantom_of.empty()) {
      split_.push_back(std::make_unique<Split>(*projector, phantom_of, first, all_));
      projector = split_.back().get();
    }
    projectors_.push_back(projector);
  }
  if (count == particle_count_) count = 0;  // no particle is split, so none is copied
  for (std::vector<Vec4f>* array : {&all_.position, &all_.moving, &all_.start}) array->resize(count);
  gauss_seidel_.prepare(projectors_, particles);
}

void PartitionedGaussSeidel::copy_in(const ParticleView& particles, Threads& threads) {
  threads.each(particle_count_, copy_grain, [&](std::size_t i) {
    all_.position[i] = particles.position[i];
    all_.moving[i] = particles.moving[i];
    all_.start[i] = particles.start[i];
  });
  all_.view = {all_.position, all_.moving, all_.start};
  ++all_.substep;
}

void PartitionedGaussSeidel::solve(std::span<Projector* const>, const ParticleView& particles,
                                   const Substep& substep, Threads& threads) {
  if (split_.empty()) return gauss_seidel_.solve(projectors_, particles, substep, threads);
  copy_in(particles, threads);
  const ParticleView& all = all_.view;
  const ParticleView real{all.position.first(particle_count_), all.moving.first(particle_count_),
                          all.start.first(particle_count_)};
  gauss_seidel_.solve(projectors_, real, substep, threads);
  threads.each(particle_count_, copy_grain, [&](std::size_t i) { particles.moving[i] = real.moving[i]; });
}

std::string PartitionedGaussSeidel::diagnostic() const {
  const std::size_t count = split_.empty() ? 0 : all_.position.size() - particle_count_;
  return fmt::format("{} phantoms reduce the constraints to {} colors", count, colors_);
}

}  // namespace souple
