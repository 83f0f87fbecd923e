// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/json_value.hpp"
#include "triskin/design/mesh.hpp"

namespace triskin::design {

/// A mesh as design files hold it: {"vertices":[[x,y,z],…],"faces":[[a,b,c],…]}, mm. Cost: linear.
[[nodiscard]] nlohmann::json mesh_json(const Mesh& mesh);
/// Reads it. Errors: InputError naming the key for what is no such mesh, corners that are not there included.
[[nodiscard]] Mesh read_mesh_json(const JsonValue& v);

}  // namespace triskin::design
