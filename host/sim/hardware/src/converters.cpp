// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/converters.hpp"

#include "converter_properties.hpp"

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

}  // namespace triskin::hardware
