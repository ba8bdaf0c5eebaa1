#pragma once

#include <Core/Containers/AlignedStdVector.hpp>
#include <Core/Types.hpp>
#include <cstddef>

namespace Ra {
namespace Core {

template <typename V>
class VectorArray : public AlignedStdVector<V> {
  using Base = AlignedStdVector<V>;

 public:
  using Base::Base;

  std::size_t getSize() const { return this->size(); }
  std::size_t getBufferSize() const { return this->size() * sizeof(V); }
  const void* dataPtr() const { return this->data(); }

  // Columns are the elements; only of vectors of fixed size, and of arrays that are not empty.
  template <typename W = V>
  auto getMap() {
    using Matrix = Eigen::Matrix<typename W::Scalar, W::RowsAtCompileTime, Eigen::Dynamic>;
    return Eigen::Map<Matrix>(this->data()->data(), W::RowsAtCompileTime, columns());
  }
  template <typename W = V>
  auto getMap() const {
    using Matrix = Eigen::Matrix<typename W::Scalar, W::RowsAtCompileTime, Eigen::Dynamic>;
    return Eigen::Map<const Matrix>(this->data()->data(), W::RowsAtCompileTime, columns());
  }

 private:
  Eigen::Index columns() const { return static_cast<Eigen::Index>(this->size()); }
};

using Vector1Array = VectorArray<Scalar>;
using Vector2Array = VectorArray<Vector2>;
using Vector3Array = VectorArray<Vector3>;
using Vector4Array = VectorArray<Vector4>;
using Vector2uArray = VectorArray<Vector2ui>;
using Vector3uArray = VectorArray<Vector3ui>;
using Vector4uArray = VectorArray<Vector4ui>;
using VectorNuArray = VectorArray<VectorNui>;

}  // namespace Core
}  // namespace Ra
