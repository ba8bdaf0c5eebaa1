#pragma once

#include "souple/contacts/contact_projector.h"
#include "souple/contacts/kernels/vertex_balls.h"
#include "souple/contacts/vertex_ball_pairs.h"

#include <array>
#include <span>
#include <vector>

namespace souple {

/// Self-collision of surfaces by balls at their vertices: SelfCollision::particles. Fast, but without a promise: what
/// slips between balls passes through.
///
///   C = n . (x_i - x_j) - d >= 0
///
/// n is the direction from j to i at the substep's start and does not turn within it: two balls cannot change sides.
/// VertexBallPairs has d. Friction and the slow release of an old overlap are as in SurfaceContacts. There is no
/// restitution: balls keep the velocity with which they separated. With it, heaps of 100 to 150 vertices a side had 10 to 53
/// crossings instead of none.
/// Corrections are equal and opposite: momentum is conserved.
///
/// Pairs are searched once a step, with a margin for each ball's motion relative to the surface's mean. They are
/// searched again within the step when too many balls have left their margins. Each substep, those that will be near
/// become contacts, in the order of the pairs.
///
/// A ball that has a pair moves by at most max_motion of its radius in a substep, relative to the mean motion of its
/// surface. Momentum that this removes is given back to all particles.
class VertexBalls final : public ContactProjector {
 public:
  void build(const ContactGeometry& geometry) override;
  void begin_step(const ContactInput& input, Threads& threads) override;
  void refresh(const ParticleView& particles, const Substep& substep, double time, Threads& threads) override;
  void apply_restitution(const ParticleView&, std::span<Vec4f>, const Substep&, Threads&) override {}
  /// Balls are larger than the thickness: their overlaps are no depths.
  ContactReport report() const override;
  void events(const ParticleView& particles, std::vector<ContactPush>& out) const override;

  std::string_view kind() const override { return "self contact"; }
  std::size_t size() const override { return contacts_.size(); }
  int color_count() const override { return static_cast<int>(color_begin_.size()) - 1; }
  std::size_t color_size(int color) const override {
    const auto c = static_cast<std::size_t>(color);
    return color_begin_[c + 1] - color_begin_[c];
  }
  std::size_t grain() const override { return 512; }
  std::uint32_t particle_of(int color, std::size_t index, const ParticleView& particles) const override;
  using Projector::project;
  void project(int color, std::size_t begin, std::size_t end, const ParticleView& particles,
               const Substep& substep) override;
  void visit(const ParticleView& particles, const ConstraintVisitor& visitor) const override;
  void visit_impulses(const ParticleView& particles, const ImpulseFunction& f) const override;
  std::size_t bytes() const override;
  void clear() override;

 private:
  /// A surface with balls.
  struct Sheet {
    VertexBallPairs pairs;
    std::uint32_t object;
    float release_radius;  // see ContactStep::depenetration_speed [m]
    bool moves = false;    // in this step
    ContactMaterialPair material{};
    double mass = 0;  // of the balls that can move [kg]
    Vec3f shift{}, mean_motion{},
        mean_displacement{};  // of the bound; in the substep; since the last search [m]
    std::size_t left = 0;     // balls that have left their margin
  };
  /// Balls [begin, end) of a sheet, for passes over all balls.
  struct Chunk {
    std::uint32_t sheet;
    std::size_t begin, end;
    Vec3d motion{}, displacement{},
        taken{};           // sums: in a substep; since the last search; momentum that the bound takes
    double mass = 0;       // of the balls that can move [kg]
    std::size_t left = 0;  // balls that have left their margin
  };
  /// Pairs [begin, end) of a color of a sheet. Those that touch in the substep, `found`, become contacts from `contact`
  /// on.
  struct Batch {
    std::uint32_t sheet;
    std::size_t begin, end, slot;
    std::size_t found = 0, contact = 0;
  };
  static constexpr float max_motion = 1;

  void list_chunks();
  template <class Function>
  void for_each_chunk(Threads& threads, const Function& f);
  template <class Value, class Function>
  void add_up(const Value& value, const Function& f);
  void clear_contacts();
  void find_mean_velocity(const ContactInput& input, Threads& threads);
  void search(Threads& threads);
  void search_again(const ParticleView& particles, Threads& threads);
  void list_batches();
  void find_motion(const ParticleView& particles, Threads& threads);
  void bound_motion(const ParticleView& particles, Threads& threads);
  void give_back_momentum(const ParticleView& particles, Threads& threads);
  void find_contacts(const ParticleView& particles, Threads& threads);
  kernels::BallRecords records(const ParticleView& particles) const;
  template <class Function>
  void for_each_sheet_of(std::size_t begin, std::size_t end, std::size_t first_batch,
                         const Function& f) const;

  const kernels::VertexBallKernels* kernels_ = nullptr;
  ContactStep step_;
  float last_h_ = 0;  // [s]
  int substeps_left_ = 0;
  std::vector<Sheet> sheets_;
  std::vector<Chunk> chunks_;
  std::vector<Vec4f>
      place_;  // per particle: at the end of the motion, relative to its sheet's corner; w = inverse mass
  std::vector<std::uint32_t> due_;                            // sheets to search
  std::vector<std::array<std::uint32_t, 2>> blocks_;          // of them: sheet and block
  std::vector<Batch> batches_;                                // by color, then sheet
  std::vector<std::uint32_t> found_;                          // pairs of each batch, from its slot on
  std::vector<std::size_t> color_begin_{0}, color_batch_{0};  // per color: its first contact, its first batch
  ColumnStore<kernels::BallContactColumns> contacts_;
  kernels::BallContactColumns columns_{};  // of contacts_
};

}  // namespace souple
