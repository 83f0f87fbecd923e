// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mesh_source.hpp"

namespace triskin::mesh {

/// Reads a 3MF file (3MF Core Specification 1.3): the part that `_rels/.rels` names, the items of its build with their
/// transforms, components, models in other parts (production extension), numbers in double precision. A transform that
/// mirrors turns the faces. Objects of the types support, solidsupport and other do not belong to the body: they are
/// left out with a note, unless --object names them. Objects are those of `name`, or of `id` if they have none. The
/// unit is millimetre if the file states none, as the standard requires. Errors: InputError naming the fault, a
/// required extension that this reader does not support, and a build without items. Cost: linear in the faces that the
/// build shows.
[[nodiscard]] MeshInUnit read_3mf(const MeshSource& source);

}  // namespace triskin::mesh
