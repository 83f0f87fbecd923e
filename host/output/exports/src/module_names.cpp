// SPDX-License-Identifier: GPL-3.0-or-later
#include "module_names.hpp"

#include <fmt/format.h>

#include "triskin/base/ascii_name.hpp"

namespace triskin::exports {

std::string cover_name(const design::Design& design, int id) {
  const design::NamedCover* cover = design::cover_of(design, id);
  return cover == nullptr ? design.name : cover->name;
}

std::string module_name(const design::Design& design, int id) {
  const design::NamedCover* cover = design::cover_of(design, id);
  const std::string own = fmt::format("module_{}", design::number_of(design, id));
  return cover == nullptr ? own : ascii_name(cover->name, "", "cover") + "_" + own;
}

int patch_in_cover(const design::Design& design, int id, int patch) {
  const design::NamedCover* cover = design::cover_of(design, id);
  return cover == nullptr || patch < 0 ? patch : patch - cover->first.patch;
}

int island_in_cover(const design::Design& design, int id, int island) {
  const design::NamedCover* cover = design::cover_of(design, id);
  return cover == nullptr ? island : island - cover->first.island;
}

}  // namespace triskin::exports
