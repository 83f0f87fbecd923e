// SPDX-License-Identifier: GPL-3.0-or-later
#include "module_names.hpp"

#include <fmt/format.h>

#include "triskin/base/ascii_name.hpp"

namespace triskin::exports {
namespace {

std::string name_in_cover(const design::Design& design, int id, const std::string& own) {
  const design::NamedCover* cover = design::cover_of(design, id);
  return cover == nullptr ? own : ascii_name(cover->name, "", "cover") + "_" + own;
}

}  // namespace

std::string cover_name(const design::Design& design, int id) {
  const design::NamedCover* cover = design::cover_of(design, id);
  return cover == nullptr ? design.name : cover->name;
}

std::string module_name(const design::Design& design, int id) {
  return name_in_cover(design, id, fmt::format("module_{}", design::number_of(design, id)));
}

std::string jumper_node_name(const design::Design& design, const design::Jumper& jumper) {
  return name_in_cover(design, jumper.node[0],
                       fmt::format("jumper_{}_{}", design::number_of(design, jumper.node[0]),
                                   design::number_of(design, jumper.node[1])));
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
