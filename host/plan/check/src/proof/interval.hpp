// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cmath>

namespace triskin::check {

/// A closed interval that contains the true value: every operation moves its ends outward by more than the rounding of
/// the operation (2⁻⁵² of the end, twice the error of one rounding to nearest), so that no rounding mode is
/// needed.
struct Interval {
  double low = 0.0, high = 0.0;

  Interval() = default;
  Interval(double exact) : low(exact), high(exact) {}  // NOLINT: numbers are intervals
  Interval(double l, double h) : low(l), high(h) {}

  [[nodiscard]] double magnitude() const { return std::max(std::abs(low), std::abs(high)); }
};

inline Interval outward(double low, double high) {
  return {low - std::abs(low) * 0x1p-52 - 1e-300, high + std::abs(high) * 0x1p-52 + 1e-300};
}
inline Interval operator+(const Interval& a, const Interval& b) {
  return outward(a.low + b.low, a.high + b.high);
}
inline Interval operator-(const Interval& a, const Interval& b) {
  return outward(a.low - b.high, a.high - b.low);
}
inline Interval operator-(const Interval& a) {
  return {-a.high, -a.low};
}
inline Interval operator*(const Interval& a, const Interval& b) {
  const double p = a.low * b.low, q = a.low * b.high, r = a.high * b.low, s = a.high * b.high;
  return outward(std::min({p, q, r, s}), std::max({p, q, r, s}));
}

/// Bounds cosine and sine over an interval of angles of less than a quarter turn: midpoint value, slope at most 1.
inline Interval around(double value, double radius) {
  return outward(std::max(-1.0, value - radius - 4e-16), std::min(1.0, value + radius + 4e-16));
}
inline Interval cosine(const Interval& angle) {
  const double half = 0.5 * (angle.high - angle.low) * (1.0 + 1e-15) + 1e-300;
  const double middle = 0.5 * (angle.low + angle.high);
  return around(std::cos(middle), half + std::abs(middle) * 0x1p-52);
}
inline Interval sine(const Interval& angle) {
  const double half = 0.5 * (angle.high - angle.low) * (1.0 + 1e-15) + 1e-300;
  const double middle = 0.5 * (angle.low + angle.high);
  return around(std::sin(middle), half + std::abs(middle) * 0x1p-52);
}

/// Returns the rounded middle of an interval: a place to test, never part of a bound.
inline double middle(const Interval& i) {
  return 0.5 * (i.low + i.high);
}

struct IntervalPoint {
  Interval x, y;
};
inline IntervalPoint operator+(const IntervalPoint& a, const IntervalPoint& b) {
  return {a.x + b.x, a.y + b.y};
}
inline IntervalPoint operator-(const IntervalPoint& a, const IntervalPoint& b) {
  return {a.x - b.x, a.y - b.y};
}
inline Interval dot(const IntervalPoint& a, const IntervalPoint& b) {
  return a.x * b.x + a.y * b.y;
}
inline IntervalPoint quarter_turn(const IntervalPoint& a) {
  return {-a.y, a.x};
}
inline IntervalPoint turned(const IntervalPoint& a, const Interval& c, const Interval& s) {
  return {c * a.x - s * a.y, s * a.x + c * a.y};
}

}  // namespace triskin::check
