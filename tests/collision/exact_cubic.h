#pragma once

#include <cstddef>
#include <gmpxx.h>
#include <vector>

// Polynomials with rational coefficients, where nothing rounds: a double is a rational number. Roots are
// counted by Sturm's theorem.

namespace souple::test {

using Rational = mpq_class;

/// Coefficients in ascending order; the last is not zero, none for the zero polynomial.
struct Polynomial : std::vector<Rational> {
  using std::vector<Rational>::vector;
};

inline Polynomial trimmed(Polynomial a) {
  while (!a.empty() && a.back() == 0) a.pop_back();
  return a;
}

inline Polynomial operator+(const Polynomial& a, const Polynomial& b) {
  Polynomial sum = a.size() < b.size() ? b : a;
  const Polynomial& shorter = a.size() < b.size() ? a : b;
  for (std::size_t i = 0; i < shorter.size(); ++i) sum[i] += shorter[i];
  return trimmed(sum);
}

inline Polynomial operator*(const Polynomial& a, const Polynomial& b) {
  if (a.empty() || b.empty()) return {};
  Polynomial product(a.size() + b.size() - 1);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) product[i + j] += a[i] * b[j];
  return trimmed(product);
}

inline Polynomial operator-(const Polynomial& a, const Polynomial& b) {
  return a + b * Polynomial{-1};
}

inline Rational value_at(const Polynomial& a, const Rational& t) {
  Rational value = 0;
  for (std::size_t i = a.size(); i-- > 0;) value = value * t + a[i];
  return value;
}

inline Polynomial derivative(const Polynomial& a) {
  Polynomial d;
  for (std::size_t i = 1; i < a.size(); ++i) d.push_back(a[i] * static_cast<unsigned long>(i));
  return d;
}

struct Division {
  Polynomial quotient, remainder;
};

inline Division divide(Polynomial a, const Polynomial& b) {
  Polynomial quotient;
  while (a.size() >= b.size()) {
    const std::size_t shift = a.size() - b.size();
    Polynomial term(shift + 1);
    term[shift] = a.back() / b.back();
    quotient = quotient + term;
    a = a - term * b;
  }
  return {quotient, a};
}

/// A polynomial with the same roots, each of them simple.
inline Polynomial square_free(const Polynomial& a) {
  Polynomial g = a, h = derivative(a);
  while (!h.empty()) {
    Polynomial r = divide(g, h).remainder;
    g = h;
    h = r;
  }
  return divide(a, g).quotient;
}

/// Counts the distinct roots of a polynomial that is not zero.
class RootCounter {
 public:
  explicit RootCounter(const Polynomial& a) {
    chain_ = {square_free(a)};
    Polynomial next = derivative(chain_[0]);
    while (!next.empty()) {
      chain_.push_back(next);
      next = divide(chain_[chain_.size() - 2], next).remainder * Polynomial{-1};
    }
  }

  /// Number of distinct roots in [lo, hi].
  int count(const Rational& lo, const Rational& hi) const {
    return changes(lo) - changes(hi) + (value_at(chain_[0], lo) == 0 ? 1 : 0);
  }

  struct Root {
    Rational lo, hi;
  };

  /// An interval for each root of [lo, hi], no wider than `width`, ascending. If a bisection point is a root,
  /// lo = hi.
  std::vector<Root> isolate(const Rational& lo, const Rational& hi, const Rational& width) const {
    std::vector<Root> roots;
    isolate(lo, hi, width, roots);
    return roots;
  }

 private:
  int changes(const Rational& t) const {
    int changes = 0, last = 0;
    for (const Polynomial& p : chain_) {
      const int sign = sgn(value_at(p, t));
      if (sign == 0) continue;
      if (last * sign < 0) ++changes;
      last = sign;
    }
    return changes;
  }

  // Roots at the two ends are handled here: bisection by signs needs an open interval.
  void isolate(const Rational& lo, const Rational& hi, const Rational& width,
               std::vector<Root>& roots) const {
    if (value_at(chain_[0], lo) == 0) roots.push_back({lo, lo});
    inner(lo, hi, width, roots);
    if (lo < hi && value_at(chain_[0], hi) == 0) roots.push_back({hi, hi});
  }
  void inner(Rational lo, Rational hi, const Rational& width, std::vector<Root>& roots) const {
    const int inside = changes(lo) - changes(hi) - (lo < hi && value_at(chain_[0], hi) == 0 ? 1 : 0);
    if (inside == 0) return;
    if (inside == 1) {
      bisect(lo, hi, width, roots);
      return;
    }
    const Rational middle = (lo + hi) / 2;
    inner(lo, middle, width, roots);
    if (value_at(chain_[0], middle) == 0) roots.push_back({middle, middle});
    inner(middle, hi, width, roots);
  }
  // For a single simple root: the sign changes there. An end that is a root was handled before.
  void bisect(Rational lo, Rational hi, const Rational& width, std::vector<Root>& roots) const {
    const Polynomial& p = chain_[0];
    int low = sgn(value_at(p, lo));
    if (low == 0) low = sgn(value_at(derivative(p), lo));  // the sign just after lo
    while (hi - lo > width) {
      const Rational middle = (lo + hi) / 2;
      const int sign = sgn(value_at(p, middle));
      if (sign == 0) lo = hi = middle;
      (sign == low ? lo : hi) = middle;
    }
    roots.push_back({lo, hi});
  }

  std::vector<Polynomial> chain_;
};

}  // namespace souple::test
