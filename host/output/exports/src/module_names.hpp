// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design.hpp"
#include "triskin/design/module_number.hpp"

namespace triskin::exports {

/// The cover of a module: one of a joint design, or the design itself.
[[nodiscard]] std::string cover_name(const design::Design& design, int id);

/// "module_19", and of a joint design "upperarm_module_19", with the cover's name by ascii_name(): an identifier that
/// no other module has.
[[nodiscard]] std::string module_name(const design::Design& design, int id);
/// "jumper_4_17", in a joint design "upperarm_jumper_4_17".
[[nodiscard]] std::string jumper_node_name(const design::Design& design, const design::Jumper& jumper);

/// The number that a patch, or an island, of the module's cover has there; −1 for −1.
[[nodiscard]] int patch_in_cover(const design::Design& design, int id, int patch);
[[nodiscard]] int island_in_cover(const design::Design& design, int id, int island);

}  // namespace triskin::exports
