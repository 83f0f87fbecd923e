// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace triskin::cad {

/// Takes from this process for good what a library that reads foreign files never needs: to write, make or remove a
/// file, to connect, to start a program or a process, and to signal or look into another one; such calls fail with
/// EPERM or ENOSYS. Memory, threads, reading and open descriptors stay. Returns false, and takes nothing, where the
/// kernel has no seccomp filters or the build no libseccomp. Call it in a process of its own. Cost: below 1 ms.
/// Source: seccomp(2), libseccomp 2.5.
[[nodiscard]] bool enter_reader_sandbox();

}  // namespace triskin::cad
