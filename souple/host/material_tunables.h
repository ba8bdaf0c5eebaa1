#pragma once

#include "souple/objects/material_fields.h"

#include <vector>

// The numbers of materials that a panel shows, with the ranges of their sliders: one list for Souple's viewer
// and for hosts.

namespace souple::host {

/// Condition under which a tunable has an effect.
using TunableUse = FieldUse;

struct TunableRange {
  float least = 0, most = 1;
  bool logarithmic = false;  ///< true: least > 0, and the left end stands for the value 0 too
};

/// One number of a material. The range holds the useful values, not all permitted ones.
template <class Material>
struct Tunable {
  const char* label;  ///< for the user interface; begins with spaces if it belongs to the preceding tunable
  const char* name;   ///< as in scene files
  const char* unit;   ///< UTF-8; empty: a plain number
  float Material::*field;
  TunableRange range;
  TunableUse use = TunableUse::always;
};

const std::vector<Tunable<ClothMaterial>>& tunables(const ClothMaterial&);
const std::vector<Tunable<SoftBodyMaterial>>& tunables(const SoftBodyMaterial&);
const std::vector<Tunable<RopeMaterial>>& tunables(const RopeMaterial&);
const std::vector<Tunable<GrainsMaterial>>& tunables(const GrainsMaterial&);
const std::vector<Tunable<ObstacleMaterial>>& tunables(const ObstacleMaterial&);
const std::vector<Tunable<FluidMaterial>>& tunables(const FluidMaterial&);
const std::vector<Tunable<RigidBodyMaterial>>& tunables(const RigidBodyMaterial&);

bool uses_membrane(const ClothMaterial& material);
template <class Material>
bool uses_membrane(const Material&) {
  return false;
}

/// Whether the tunable has an effect with this material; `pbd`: in Mode::pbd.
template <class Of, class Material>
bool is_used(const Tunable<Of>& tunable, const Material& material, bool pbd) {
  const Of& plain = material;
  return tunable.use == TunableUse::always || (tunable.use == TunableUse::pbd ? pbd : uses_membrane(plain));
}

}  // namespace souple::host
