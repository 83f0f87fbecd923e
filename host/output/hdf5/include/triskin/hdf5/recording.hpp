// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>

#include "triskin/recording/recorder.hpp"

namespace triskin::hdf5 {

/// Starts a recording of `design` as an HDF5 file (docs/recording.md): one row per sample of a module, appended in
/// blocks of 4,096 rows or 0.5 s, after which the file is consistent. Memory: one block. Contacts are left out. `file`
/// must be a regular file (HDF5 writes at arbitrary positions) and outlive the recorder. Throws InputError naming the
/// remedy when can_write() is false or the file is not regular; WriteFailed when it accepts no more bytes.
[[nodiscard]] std::unique_ptr<recording::Recorder> make_recorder(recording::OutputFile& file,
                                                                 const design::Design& design,
                                                                 const recording::Origin& origin);

}  // namespace triskin::hdf5
