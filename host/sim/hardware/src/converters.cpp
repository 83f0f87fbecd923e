// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/converters.hpp"

#include <algorithm>

#include "scene_reader.hpp"

namespace triskin::hardware {
namespace {

// SplitMix64 (Steele, Lea, Flood 2014).
double uniform(std::uint64_t x) {
  x += 0x9E3779B97F4A7C15ULL;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9ULL;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBULL;
  return static_cast<double>((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

void set(Ad7147Behaviour& chip, const ConverterProperty& p, double value) {
  if (p.number != nullptr)
    chip.*p.number = value;
  else
    chip.*p.flag = value >= 0.5;
}

}  // namespace

Ad7147Behaviour Converters::of(std::uint64_t serial) const {
  Ad7147Behaviour chip;
  chip.serial = serial;
  if (drawn) {
    std::uint64_t stream = serial * 64;
    for (const ConverterProperty& p : kConverterProperties)
      set(chip, p, p.drawn_low + (p.drawn_high - p.drawn_low) * uniform(++stream));
  }
  for (const Given& g : given) set(chip, *g.property, g.value);
  return chip;
}

Converters read_converters(const design::JsonValue& v) {
  Converters converters;
  converters.drawn = true;
  if (v.raw().is_string()) {
    if (v.text() != "ideal" && v.text() != "drawn") v.fail("must be \"drawn\", \"ideal\" or an object with properties");
    converters.drawn = v.text() == "drawn";
    return converters;
  }
  if (!v.raw().is_object()) v.fail("must be \"drawn\", \"ideal\" or an object with properties");
  for (const auto& [key, value] : v.raw().items()) {
    const design::JsonValue item = v[key.c_str()];
    if (key == "others") {
      if (item.text() != "ideal" && item.text() != "drawn") item.fail("must be \"drawn\" or \"ideal\"");
      converters.drawn = item.text() == "drawn";
      continue;
    }
    const auto found = std::ranges::find(kConverterProperties, key, &ConverterProperty::key);
    if (found == kConverterProperties.end())
      item.fail("is no property of a converter; docs/scene.md lists them under \"converters\"");
    converters.given.push_back({&*found, found->flag != nullptr
                                             ? (item.boolean() ? 1.0 : 0.0)
                                             : design::number_in(item, found->lowest, found->highest)});
  }
  return converters;
}

}  // namespace triskin::hardware
