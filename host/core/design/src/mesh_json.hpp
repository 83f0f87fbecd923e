// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/json_value.hpp"
#include "triskin/design/mesh.hpp"

namespace triskin::design {

/// Writes a mesh in the form of design files: {"vertices":[[x,y,z],…],"faces":[[a,b,c],…]}, mm. Cost: linear.
[[nodiscard]] nlohmann::json mesh_json(const Mesh& mesh);
/// Reads such a mesh. Errors: InputError naming the key if the form is wrong or a face names a missing vertex.
[[nodiscard]] Mesh read_mesh_json(const JsonValue& v);

}  // namespace triskin::design
