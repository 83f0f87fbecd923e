// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>

namespace triskin {

/// No input of a command is larger; a surface of 40 million triangles has 2 GB as STL.
inline constexpr std::uint64_t kMaxInput_bytes = std::uint64_t{1} << 31;

enum class Pipes { kRefused, kAllowed };

/// Throws InputError for what cannot be read as a file: a folder, a device or socket, which may never end, and a pipe
/// where it is refused. What does not exist passes; opening it says why.
void require_file(const std::filesystem::path& path, Pipes pipes);

}  // namespace triskin
