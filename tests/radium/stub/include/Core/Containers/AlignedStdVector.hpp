#pragma once

#include <Core/RaCore.hpp>
#include <vector>

#include <Eigen/Core>

namespace Ra {
namespace Core {

template <typename T>
using AlignedStdVector = std::vector<T, Eigen::aligned_allocator<T>>;

}  // namespace Core
}  // namespace Ra
