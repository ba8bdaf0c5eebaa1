#pragma once

// Internal state of a World, for the files of this folder. Users include world.h. Its parts are declared here: a file
// includes the header of each part that it uses.

#include "souple/objects/handles.h"
#include "souple/objects/objects_view.h"
#include "souple/solver/projector.h"
#include "souple/stages/settings.h"
#include "souple/state/particles.h"
#include "souple/state/warnings.h"
#include "souple/world/report.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace souple {

struct Caches;
struct Callbacks;
struct Calls;
struct ColliderRecord;
struct ConstraintGroups;
struct ConstraintSets;
struct ContactState;
struct DrainRecord;
struct EmitterRecord;
class Fluids;
class JobSystem;
struct Object;
struct QueryView;
class RigidStage;
struct Registry;
class Solver;
struct StageView;
struct StepScratch;
class Ties;
struct UserConstraint;
class World;

/// Changes since the last step, which the next step takes into account.
struct Changes {
  bool constraints = true;  ///< constraints of objects: merge them
  bool objects = true;      ///< objects were added or removed
  bool groups = true;       ///< shape matching or enclosed volumes
  bool radii = true;        ///< contact radii
  bool tables = true;       ///< input of the contacts: rebuild the tables
  bool counts = false;      ///< the particle count of a fluid differs from the contacts' count
  bool solver = true;       ///< projectors were added or removed, or settings changed: prepare the solver
  bool masses = true;       ///< particles were pinned or freed, or masses changed: prepare the solver

  void all() { constraints = objects = tables = true; }
};

/// Emitters and drains of fluids.
struct FlowRecords {
  std::vector<EmitterRecord> emitters;
  std::vector<DrainRecord> drains;
  bool settles = false;  ///< fluid begins too near a solid: the next step that is done moves it away first
};

/// Constraints of all objects and of the user.
struct WorldConstraints {
  // The constraints of all objects, see build.h.
  std::unique_ptr<ConstraintSets> of_elements;
  std::unique_ptr<ConstraintGroups> of_groups;
  std::vector<Projector*> object_projectors;  ///< those that are not empty, in order of solution
  std::vector<UserConstraint> users;
  std::unique_ptr<Ties> ties;        ///< after those of the user
  std::vector<Projector*> order;     ///< all projectors in order of solution, contacts last; see prepare.h
  std::size_t without_contacts = 0;  ///< so many of them come before the contacts

  /// Those of `order` that are no contacts.
  std::span<Projector* const> lasting() const { return std::span(order).first(without_contacts); }
};

struct CurrentSolver {
  std::unique_ptr<Solver> solver;
  SolverSettings settings;  ///< those that `solver` was made with
};

/// Particles before the step.
struct LastValid {
  std::vector<Vec4f> position, offset, velocity, spin;
};

/// The step that runs now.
struct CurrentStep {
  bool running = false;                         ///< its stages, from the first to the last
  bool last_substep = false;                    ///< of the step
  bool settles = false;                         ///< its next substep moves fluid away from solids first
  bool saved = false;                           ///< LastValid holds the particles before this step
  double start = 0, length = 1;                 ///< s
  std::uint64_t version_after = 0;              ///< `version` when the last valid step ended; 0: none
  std::optional<std::size_t> first_non_finite;  ///< the lowest particle with a non-finite value
  LastValid last_valid;
};

struct WorldState {
  WorldState();
  ~WorldState();

  Settings settings;
  double time = 0;
  std::uint64_t steps = 0;
  std::uint64_t version = 1;  ///< increases whenever positions may have changed

  Particles particles;
  std::vector<std::uint32_t> object_of;          ///< per particle: index into objects
  std::vector<std::unique_ptr<Object>> objects;  ///< ascending by id; addresses are stable
  std::vector<ColliderRecord> colliders;         ///< ascending by id
  std::unique_ptr<Registry> registry;
  FlowRecords flow;

  WorldConstraints constraints;
  CurrentSolver solving;
  std::unique_ptr<Threads> threads;  ///< null: create before the next step
  JobSystem* jobs = nullptr;         ///< the host's, in place of our threads
  std::unique_ptr<ContactState> contact;
  std::unique_ptr<Fluids> fluids;
  std::unique_ptr<RigidStage> rigid;
  std::unique_ptr<StepScratch> scratch;
  Changes dirty;
  std::unique_ptr<Callbacks> callbacks;
  StepReport report;
  Warnings warnings{report.flags, report.message};
  CurrentStep current;
  std::unique_ptr<Calls> calls;
  std::unique_ptr<Caches> caches;

  /// Null if the handle is stale.
  Object* find_object(ObjectId id) const;
  /// Throws if the handle is stale.
  Object& object(ObjectId id);
  const Object& object(ObjectId id) const;
  ColliderRecord& collider(ColliderId id);
  ParticleView view();
  /// For stages of lower floors.
  ObjectsView objects_view() { return {particles, objects, object_of}; }
  StageView stage_view();
  /// For queries.
  QueryView query_view() const;

  /// Sets the position of a particle; its offset keeps the part beyond float precision.
  void set_position(std::size_t i, const Vec3d& x);
  /// Sets a position without continuous motion, which may create intersections: requests a check.
  void teleport_particle(std::size_t i, const Vec3d& x);

  /// `wanted` if it is free, else throws; empty: the first free name of `base`, base2, base3, ...
  std::string unique_name(const std::string& wanted, std::string_view base) const;

  ProjectorId add_user_constraint(UserConstraint user_constraint, std::unique_ptr<Projector> projector);
};

}  // namespace souple
