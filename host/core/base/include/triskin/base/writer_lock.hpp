// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <filesystem>
#include <string>

namespace triskin {

/// Tells who holds the lock (flock) on the open file `fd`: "process 4711 (triskin)", "this process"; "another program"
/// if the kernel does not say, for example on a network file system. Cost: reads /proc/locks.
[[nodiscard]] std::string lock_holder(int fd);

/// Locks the open file `fd` for one writer until it is closed. Throws InputError with `name` and the holder when
/// another program writes it. Without effect on a file system that has no locks.
void lock_for_writing(int fd, const std::string& name);

/// Keeps other programs of this user from changing the file at a path. The file is replaced whole when it is written,
/// so the lock cannot be on the file itself: it is on a file in state_home()/locks. Not recursive.
class WriterLock {
 public:
  /// Waits for another writer for `patience`; then throws InputError with `path` and the holder.
  explicit WriterLock(const std::filesystem::path& path, std::chrono::milliseconds patience = {});
  ~WriterLock();
  WriterLock(const WriterLock&) = delete;
  WriterLock& operator=(const WriterLock&) = delete;

 private:
  int fd_ = -1;
};

}  // namespace triskin
