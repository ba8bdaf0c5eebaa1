#include "souple/host/material_tunables.h"

namespace souple::host {

namespace {

template <class M>
struct Collected {
  std::vector<Tunable<M>>& list;

  template <auto member>
  void operator()(Field<member>, const char* name, const FieldRange&, const char*,
                  const Slider& slider) const {
    if constexpr (std::is_same_v<decltype(member), float M::*>)
      if (slider.label != nullptr)
        list.push_back({slider.label,
                        name,
                        slider.unit,
                        member,
                        {slider.least, slider.most, slider.logarithmic},
                        slider.use});
  }
  template <auto member, class E>
  void operator()(Field<member>, const char*, FieldWords<E>, const char*) const {}
};

/// The fields that have a slider.
template <class M>
const std::vector<Tunable<M>>& collected() {
  static const std::vector<Tunable<M>> all = [] {
    std::vector<Tunable<M>> list;
    visit_fields<M>(Collected<M>{list});
    return list;
  }();
  return all;
}

}  // namespace

const std::vector<Tunable<ClothMaterial>>& tunables(const ClothMaterial&) {
  return collected<ClothMaterial>();
}
const std::vector<Tunable<SoftBodyMaterial>>& tunables(const SoftBodyMaterial&) {
  return collected<SoftBodyMaterial>();
}
const std::vector<Tunable<RopeMaterial>>& tunables(const RopeMaterial&) {
  return collected<RopeMaterial>();
}
const std::vector<Tunable<GrainsMaterial>>& tunables(const GrainsMaterial&) {
  return collected<GrainsMaterial>();
}
const std::vector<Tunable<ObstacleMaterial>>& tunables(const ObstacleMaterial&) {
  return collected<ObstacleMaterial>();
}
const std::vector<Tunable<FluidMaterial>>& tunables(const FluidMaterial&) {
  return collected<FluidMaterial>();
}
const std::vector<Tunable<RigidBodyMaterial>>& tunables(const RigidBodyMaterial&) {
  return collected<RigidBodyMaterial>();
}

bool uses_membrane(const ClothMaterial& material) {
  return material.stretch == StretchModel::membrane;
}

}  // namespace souple::host
