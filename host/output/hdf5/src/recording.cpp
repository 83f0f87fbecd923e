// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hdf5/recording.hpp"

#include "triskin/base/error.hpp"
#include "triskin/hdf5/taxel_table.hpp"

#ifdef TRISKIN_HDF5
#include <array>
#include <charconv>
#include <mutex>
#include <vector>

#include "hdf5_object.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/layout/module.hpp"
#include "triskin/recording/readers.hpp"

namespace triskin::hdf5 {
namespace {

constexpr std::size_t kBlockRows = 4096;
constexpr std::uint64_t kMaxWait_us = 500'000;

// A growing table has N rows with `columns` numbers each.
struct Column {
  const char* name;
  const char* unit;
  const char* meaning;
};
class GrowingTable {
 public:
  GrowingTable(hid_t file, const Column& column, hsize_t columns, hid_t stored, hid_t given)
      : name_(column.name), columns_(columns), given_(given), table_(make(file, column, columns, stored)) {
    write_text(table_.id(), "unit", column.unit);
    write_text(table_.id(), "meaning", column.meaning);
  }
  void append(hsize_t rows, const void* values) {
    const std::array<hsize_t, 2> size{rows_ + rows, columns_}, start{rows_, 0}, count{rows, columns_};
    require(H5Dset_extent(table_.id(), size.data()), name_);
    const Handle all(H5Dget_space(table_.id()), H5Sclose, name_),
        part(H5Screate_simple(rank(), count.data(), nullptr), H5Sclose, name_);
    require(H5Sselect_hyperslab(all.id(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr), name_);
    require(H5Dwrite(table_.id(), given_, part.id(), all.id(), H5P_DEFAULT, values), name_);
    rows_ += rows;
  }

 private:
  [[nodiscard]] int rank() const { return columns_ == 1 ? 1 : 2; }
  static Handle make(hid_t file, const Column& column, hsize_t columns, hid_t stored) {
    const std::array<hsize_t, 2> none{0, columns}, most{H5S_UNLIMITED, columns}, chunk{kBlockRows, columns};
    const int rank = columns == 1 ? 1 : 2;
    const Handle space(H5Screate_simple(rank, none.data(), most.data()), H5Sclose, column.name),
        wish(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, column.name);
    require(H5Pset_chunk(wish.id(), rank, chunk.data()), column.name);
    return {H5Dcreate2(file, column.name, stored, space.id(), H5P_DEFAULT, wish.id(), H5P_DEFAULT), H5Dclose,
            column.name};
  }

  std::string name_;
  hsize_t columns_, rows_ = 0;
  hid_t given_;
  Handle table_;
};

// Samples wait here to be written, with one list per table.
struct Block {
  std::vector<std::int32_t> module, reader_patch;
  std::vector<std::uint32_t> sample, error_us;
  std::vector<std::uint64_t> link_time_us, device_time_us, sampled_ns;
  std::vector<std::uint16_t> valid, value;
  std::vector<std::uint8_t> state, reader_node;
};

Handle create(recording::OutputFile& file) {
  // At the program's end the library would once more write what a full disk has refused, and fall.
  (void)H5dont_atexit();
  if (!file.can_read())
    throw InputError(file.name() +
                     ": HDF5 writes at any place of a file, which this does not allow; record to mcap or csv");
  // The library must not print its errors, because the exception has the message.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  file.write({});  // The call empties a file that already exists.
  // We already hold a lock on the file, so the library's own lock would be refused.
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, file.name());
  require(H5Pset_file_locking(access.id(), false, true), file.name());
  return {H5Fcreate(file.name().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose, file.name()};
}

class Hdf5Recorder {
 public:
  Hdf5Recorder(recording::OutputFile& file, const design::Design& design, const recording::Origin& origin)
      : name_(file.name()), file_(create(file)), readers_(design), numbers_(design::all_numbers(design.layout)) {
    guarded([&] {
      const hid_t root = file_.id();
      write_text(root, "format", "triskin-recording");
      write_number(root, "version", std::uint64_t{1});
      write_text(root, "design_id", fmt::format("{:016x}", design.design_id));
      write_number(root, "link_start_us", origin.link_start_us);
      write_number(root, "unix_start_ns", origin.unix_start_ns);
      for (const auto& [key, value] : origin.facts) write_text(root, key, value);
      write_design(origin.design_text);
      require(H5Fflush(root, H5F_SCOPE_GLOBAL), name_);
    });
  }
  void add(const recording::ModuleSample& s) {
    block_.module.push_back(numbers_.at(static_cast<std::size_t>(s.module)));
    block_.sample.push_back(s.sample.sample);
    block_.state.push_back(static_cast<std::uint8_t>(s.sample.state));
    block_.valid.push_back(s.sample.valid);
    block_.link_time_us.push_back(s.link_time_us);
    block_.device_time_us.push_back(s.sample.device_time_us);
    block_.sampled_ns.push_back(s.sampled_ns);
    block_.error_us.push_back(s.error_us);
    const recording::Reader reader = readers_.of(s);
    block_.reader_patch.push_back(reader.patch);
    block_.reader_node.push_back(static_cast<std::uint8_t>(reader.node));
    block_.value.insert(block_.value.end(), s.sample.value.begin(), s.sample.value.end());
    if (block_.module.size() >= kBlockRows) flush();
  }
  void tick(std::uint64_t steady_us) {
    if (steady_us - flushed_us_ < kMaxWait_us) return;
    flushed_us_ = steady_us;
    flush();
  }
  void finish(const std::map<std::string, std::string>& result) {
    flush();
    guarded([&] {
      for (const auto& [key, value] : result) write_result(key, value);
      require(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL), name_);
    });
  }

 private:
  template <class Work>
  void guarded(Work work) const {
    try {
      work();
    } catch (const InputError& e) {
      throw recording::WriteFailed(
          fmt::format("{}: {}; what was written before is there, check the disk", name_, e.what()));
    }
  }
  // What is a number in words becomes one.
  void write_result(const std::string& key, const std::string& text) const {
    const std::string name = "result_" + key;
    const char* const end = text.data() + text.size();
    std::uint64_t whole = 0;
    double number = 0.0;
    if (const auto r = std::from_chars(text.data(), end, whole); r.ec == std::errc{} && r.ptr == end)
      write_number(file_.id(), name, whole);
    else if (const auto d = std::from_chars(text.data(), end, number); d.ec == std::errc{} && d.ptr == end)
      write_number(file_.id(), name, number);
    else
      write_text(file_.id(), name, text);
  }
  void write_design(const std::string& text) const {
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "the design"), space(H5Screate(H5S_SCALAR), H5Sclose, "the design");
    require(H5Tset_size(type.id(), std::max<std::size_t>(1, text.size())), "the design");
    require(H5Tset_cset(type.id(), H5T_CSET_UTF8), "the design");
    const Handle set(H5Dcreate2(file_.id(), "design", type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose, "the design");
    require(H5Dwrite(set.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.empty() ? "" : text.data()),
            "the design");
  }
  void flush() {
    const hsize_t rows = block_.module.size();
    if (rows == 0) return;
    guarded([&] {
      module_.append(rows, block_.module.data());
      sample_.append(rows, block_.sample.data());
      state_.append(rows, block_.state.data());
      valid_.append(rows, block_.valid.data());
      link_time_.append(rows, block_.link_time_us.data());
      device_time_.append(rows, block_.device_time_us.data());
      sampled_.append(rows, block_.sampled_ns.data());
      error_.append(rows, block_.error_us.data());
      reader_patch_.append(rows, block_.reader_patch.data());
      reader_node_.append(rows, block_.reader_node.data());
      value_.append(rows, block_.value.data());
      require(H5Fflush(file_.id(), H5F_SCOPE_GLOBAL), name_);
    });
    block_ = {};
  }
  GrowingTable list(const Column& column, hid_t stored, hid_t given) const {
    return {file_.id(), column, 1, stored, given};
  }

  std::string name_;
  Handle file_;
  recording::Readers readers_;
  std::vector<int> numbers_;  // by module
  GrowingTable module_ = list({"module", "1", "number in the design"}, H5T_STD_I32LE, H5T_NATIVE_INT32),
               sample_ = list({"sample", "1", "number of the module's sample; a gap is a lost one"}, H5T_STD_U32LE,
                              H5T_NATIVE_UINT32),
               state_ = list({"state", "1", "of the module (docs/protocol.md)"}, H5T_STD_U8LE, H5T_NATIVE_UINT8),
               valid_ = list({"valid", "1", "bit t: taxel t"}, H5T_STD_U16LE, H5T_NATIVE_UINT16),
               link_time_ =
                   list({"link_time", "us", "when it came, clock of the link"}, H5T_STD_U64LE, H5T_NATIVE_UINT64),
               device_time_ = list({"device_time", "us", "clock of the controller"}, H5T_STD_U64LE, H5T_NATIVE_UINT64),
               sampled_ = list({"sampled", "ns", "when it was taken, since 1970, within error; 0: not known"},
                               H5T_STD_U64LE, H5T_NATIVE_UINT64),
               error_ = list({"error", "us", "bound of the error of sampled; 4294967295: none"}, H5T_STD_U32LE,
                             H5T_NATIVE_UINT32),
               reader_patch_ =
                   list({"reader_patch", "1", "patch whose controller read it; not the module's own: adopted"},
                        H5T_STD_I32LE, H5T_NATIVE_INT32),
               reader_node_ =
                   list({"reader_node", "1", "node address of that controller"}, H5T_STD_U8LE, H5T_NATIVE_UINT8),
               value_{file_.id(),
                      {"value", "counts", "of the twelve taxels"},
                      layout::kTaxelsPerModule,
                      H5T_STD_U16LE,
                      H5T_NATIVE_UINT16};
  Block block_;
  std::uint64_t flushed_us_ = 0;
};

// The library supports only one thread at a time, but each bus of a robot is recorded by its own thread.
std::mutex one_at_a_time;

class LockedRecorder final : public recording::Recorder {
 public:
  LockedRecorder(recording::OutputFile& file, const design::Design& design, const recording::Origin& origin) {
    const std::lock_guard lock(one_at_a_time);
    recorder_ = std::make_unique<Hdf5Recorder>(file, design, origin);
  }
  ~LockedRecorder() override {
    const std::lock_guard lock(one_at_a_time);
    recorder_.reset();
  }
  LockedRecorder(const LockedRecorder&) = delete;
  LockedRecorder& operator=(const LockedRecorder&) = delete;
  void add(const recording::ModuleSample& sample) override {
    const std::lock_guard lock(one_at_a_time);
    recorder_->add(sample);
  }
  void add_contacts(std::uint64_t /*link_time_us*/, std::span<const recording::Contact> /*contacts*/) override {}
  void tick(std::uint64_t steady_us) override {
    const std::lock_guard lock(one_at_a_time);
    recorder_->tick(steady_us);
  }
  void finish(const std::map<std::string, std::string>& result) override {
    const std::lock_guard lock(one_at_a_time);
    recorder_->finish(result);
  }

 private:
  std::unique_ptr<Hdf5Recorder> recorder_;
};

}  // namespace

std::unique_ptr<recording::Recorder> make_recorder(recording::OutputFile& file, const design::Design& design,
                                                   const recording::Origin& origin) {
  return std::make_unique<LockedRecorder>(file, design, origin);
}

}  // namespace triskin::hdf5

#else

namespace triskin::hdf5 {

std::unique_ptr<recording::Recorder> make_recorder(recording::OutputFile& /*file*/, const design::Design& /*design*/,
                                                   const recording::Origin& /*origin*/) {
  throw InputError(
      "this triskin was built without HDF5; install the package libhdf5-dev and build again, or record to mcap or csv");
}

}  // namespace triskin::hdf5

#endif
