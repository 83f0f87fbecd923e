// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cassert>
#include <concepts>
#include <cstddef>
#include <tuple>
#include <utility>
#include <vector>

namespace triskin::geometry {

/// What numbers the elements of a table: a plain integer, or an integer that knows what it counts, such as
/// layout::Index.
template <class T>
concept TableKey = std::integral<T> || requires(const T index) {
  { index.value() } -> std::integral;
  { T::none() } -> std::same_as<T>;
};

/// A vector whose elements are numbered by one kind of index: `mesh.vertices[mesh.faces[face][side]]` needs no cast. A
/// plain integer is taken as well, because files fill the corners of faces; an index of another kind does not compile
/// unless the key is a plain integer. Bounds are checked where assertions are on: in debug and sanitizer builds.
template <TableKey Key, class Value>
class Table : public std::vector<Value> {
 public:
  using Base = std::vector<Value>;
  using Base::Base;
  Table() = default;
  explicit(false) Table(Base&& values) : Base(std::move(values)) {}
  explicit Table(const Base& values) : Base(values) {}

  template <std::integral Integer>
  [[nodiscard]] typename Base::reference operator[](Integer k) {
    return Base::operator[](checked(k));
  }
  template <std::integral Integer>
  [[nodiscard]] typename Base::const_reference operator[](Integer k) const {
    return Base::operator[](checked(k));
  }
  [[nodiscard]] typename Base::reference operator[](Key key) { return Base::operator[](checked(key)); }
  [[nodiscard]] typename Base::const_reference operator[](Key key) const { return Base::operator[](checked(key)); }

  /// Returns the index after the last.
  [[nodiscard]] Key end_key() const { return static_cast<Key>(this->size()); }

 private:
  [[nodiscard]] std::size_t checked(auto k) const {
    const auto place = static_cast<std::size_t>(k);
    assert(place < this->size());  // A negative integer is a large place.
    return place;
  }
};

/// Three values, one for each corner, side or axis, numbered by any integer 0 … 2. Bounds are checked as those of
/// Table.
template <class Value>
struct Triple : std::array<Value, 3> {
  using Base = std::array<Value, 3>;
  constexpr Triple() : Base{} {}
  constexpr Triple(Value a, Value b, Value c) : Base{std::move(a), std::move(b), std::move(c)} {}
  constexpr explicit(false) Triple(const Base& values) : Base(values) {}

  template <class Integer>
    requires std::convertible_to<Integer, int>
  [[nodiscard]] constexpr Value& operator[](Integer k) {
    assert(static_cast<std::size_t>(k) < 3);
    return Base::operator[](static_cast<std::size_t>(k));
  }
  template <class Integer>
    requires std::convertible_to<Integer, int>
  [[nodiscard]] constexpr const Value& operator[](Integer k) const {
    assert(static_cast<std::size_t>(k) < 3);
    return Base::operator[](static_cast<std::size_t>(k));
  }
};

}  // namespace triskin::geometry

template <class Value>
struct std::tuple_size<triskin::geometry::Triple<Value>> : std::integral_constant<std::size_t, 3> {};
template <std::size_t Place, class Value>
struct std::tuple_element<Place, triskin::geometry::Triple<Value>> {
  using type = Value;
};
