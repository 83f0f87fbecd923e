// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <nlohmann/json.hpp>

#include "converter_properties.hpp"
#include "scene_reader.hpp"

namespace triskin::hardware {

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
