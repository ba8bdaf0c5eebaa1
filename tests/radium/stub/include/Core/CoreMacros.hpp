#pragma once

#include <iostream>
#include <sstream>

using uchar = unsigned char;
using ushort = unsigned short;
using uint = unsigned int;
using ulong = unsigned long;
using Scalar = float;

constexpr Scalar operator""_ra(long double value) {
  return static_cast<Scalar>(value);
}
constexpr Scalar operator""_ra(unsigned long long value) {
  return static_cast<Scalar>(value);
}

#define CORE_UNUSED(X) static_cast<void>(X)
// A Release build of Radium checks neither.
#define CORE_ASSERT(CONDITION, TEXT) static_cast<void>(0)
#define CORE_WARN_IF(CONDITION, TEXT) static_cast<void>(0)
