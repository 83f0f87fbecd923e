// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <compare>
#include <concepts>
#include <cstddef>
#include <functional>
#include <type_traits>

/// Modules, patches, covers, taxels and rows are all numbered from 0, so a plain integer does not tell which of them it
/// counts, and two exchanged arguments compile. These types tell it to the compiler. They cost nothing: each is its
/// integer in memory and in registers.
namespace triskin::layout {

/// Holds an integer that counts things of one kind, named by `Tag`. It is made explicitly from an integer and converts
/// implicitly to `Integer`, so that indexing, arithmetic and output are those of the integer. It can neither be made
/// from an index of another kind nor be compared with one. `Integer` is at least as wide as int, because narrower ones
/// are printed as characters. −1 stands for none. All operations have constant cost and throw nothing.
template <class Tag, std::integral Integer = int>
  requires(!std::same_as<Integer, bool> && sizeof(Integer) >= sizeof(int))
class Index {
 public:
  using value_type = Integer;
  using tag_type = Tag;

  /// Makes the index 0.
  constexpr Index() = default;
  /// Makes the index `value`, which must be in the range of `Integer`, like the operand of a static_cast.
  template <std::integral Number>
    requires(!std::same_as<Number, bool>)
  constexpr explicit Index(Number value) : value_(static_cast<Integer>(value)) {}

  /// Returns the index that stands for none.
  [[nodiscard]] static constexpr Index none()
    requires std::signed_integral<Integer>
  {
    return Index(Integer{-1});
  }

  // The conversion is implicit so that inner loops and users of the library treat an index as the integer that it is.
  constexpr operator Integer() const { return value_; }
  /// Returns the integer, where a conversion would not take place by itself, as for a deduced argument.
  [[nodiscard]] constexpr Integer value() const { return value_; }

  constexpr Index& operator++() {
    ++value_;
    return *this;
  }

  [[nodiscard]] friend constexpr bool operator==(Index, Index) = default;
  [[nodiscard]] friend constexpr auto operator<=>(Index, Index) = default;

 private:
  Integer value_ = 0;
};

template <class Left, class A, class Right, class B>
  requires(!std::same_as<Left, Right>)
constexpr bool operator==(Index<Left, A>, Index<Right, B>) = delete;
template <class Left, class A, class Right, class B>
  requires(!std::same_as<Left, Right>)
constexpr std::strong_ordering operator<=>(Index<Left, A>, Index<Right, B>) = delete;

/// Tells for an index of modules that nobody may read it: people and files name modules by their numbers
/// (design::number_of).
template <class T>
concept HasNumber = requires { typename T::tag_type::HasNumber; };

/// nlohmann::json finds this function and writes an index as its integer.
template <class Json, class Tag, class Integer>
  requires std::constructible_from<Json, Integer> && (!HasNumber<Index<Tag, Integer>>)
constexpr void to_json(Json& json, Index<Tag, Integer> index) {
  json = index.value();
}

/// Names a module in its design: the index in ModuleLayout::modules. It is neither a row of a table nor a number
/// through several covers.
struct ModuleIdTag {
  struct HasNumber;
};
using ModuleId = Index<ModuleIdTag>;
/// Numbers a module through all covers of a skin, as the library and the page of `triskin view` do.
using SkinModule = Index<struct SkinModuleTag>;
/// Numbers a patch in its design: the index in Design::patches, from 0. The patch's controller has a node address.
using PatchIndex = Index<struct PatchIndexTag>;
/// Numbers a module within one patch: the index in Patch::modules and, in a controller, the row of its table.
using TableRow = Index<struct TableRowTag>;
/// Names a controller on its bus: 1 … 126, or 0 for a controller on another bus.
using NodeAddress = Index<struct NodeAddressTag>;
/// Numbers a cover among the designs of a stream or of a bus.
using CoverIndex = Index<struct CoverIndexTag>;
/// Numbers a taxel of a module: 0 … kTaxelsPerModule − 1.
using TaxelIndex = Index<struct TaxelIndexTag>;

static_assert(sizeof(ModuleId) == sizeof(int) && alignof(ModuleId) == alignof(int));
static_assert(std::is_trivially_copyable_v<ModuleId> && std::is_standard_layout_v<ModuleId>);

}  // namespace triskin::layout

template <class Tag, class Integer>
struct std::hash<triskin::layout::Index<Tag, Integer>> {
  [[nodiscard]] std::size_t operator()(triskin::layout::Index<Tag, Integer> index) const noexcept {
    return std::hash<Integer>{}(index.value());
  }
};
