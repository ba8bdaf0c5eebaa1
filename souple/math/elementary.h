#pragma once

/// Elementary functions of doubles by arithmetic alone. The C library's results differ in the last bit between
/// libraries, versions and WebAssembly; these are equal wherever doubles are those of IEEE 754. All that moves a
/// particle uses them. Results are within 3 units in the last place where nothing else is said.
namespace souple::elementary {

/// Angles in radians. Beyond 2^20 the period is the double nearest to 2 pi. NaN unless x is finite.
double sin(double x);
double cos(double x);
/// In [-pi, pi]; 0 at (0, 0).
double atan2(double y, double x);
/// NaN outside [-1, 1].
double asin(double x);
double acos(double x);

double exp(double x);
/// -infinity at 0, NaN below it.
double log(double x);
/// x^y for x >= 0, NaN below. The relative error is below 4e-16 (1 + |y log(x)|).
double pow(double x, double y);
double cbrt(double x);
/// sqrt(x^2 + y^2), of any size.
double hypot(double x, double y);

}  // namespace souple::elementary
