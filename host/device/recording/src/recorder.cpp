// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/recording/recorder.hpp"

#include <fmt/format.h>

#include "mcap_recorder.hpp"
#include "triskin/design/module_number.hpp"
#include "triskin/recording/readers.hpp"

namespace triskin::recording {
namespace {

// Writes one line for each sample of a module.
class CsvRecorder final : public Recorder {
 public:
  CsvRecorder(OutputFile& file, const design::Design& design, bool is_simulated)
      : file_(file), readers_(design), numbers_(design::all_numbers(design.layout)), mark_(is_simulated ? '1' : '0') {
    text_ = "link_time_us,device_time_us,sample,module,valid";
    for (int t = 0; t < layout::kTaxelsPerModule; ++t) text_ += fmt::format(",taxel_{}", t);
    text_ += ",sampled_ns,error_us,reader_patch,reader_node,simulated\n";
    flush();
  }
  void add(const ModuleSample& s) override {
    fmt::format_to(std::back_inserter(text_), "{},{},{},{},{}", s.link_time_us, s.sample.device_time_us,
                   s.sample.sample, numbers_.at(static_cast<std::size_t>(s.module)), s.sample.valid);
    for (const std::uint16_t v : s.sample.value) fmt::format_to(std::back_inserter(text_), ",{}", v);
    if (s.error_us == ModuleSample::kNoBound)
      text_ += ",,";
    else
      fmt::format_to(std::back_inserter(text_), ",{},{}", s.sampled_ns, s.error_us);
    const Reader reader = readers_.of(s);
    fmt::format_to(std::back_inserter(text_), ",{},{},{}\n", reader.patch, reader.node, mark_);
    if (text_.size() >= kMaxBytes) flush();
  }
  void add_contacts(std::uint64_t /*link_time_us*/, std::span<const Contact> /*contacts*/) override {}
  void tick(std::uint64_t /*steady_us*/) override { flush(); }
  void finish(const std::map<std::string, std::string>& /*result*/) override { flush(); }

 private:
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 10;
  void flush() {
    file_.write({reinterpret_cast<const std::uint8_t*>(text_.data()), text_.size()});
    text_.clear();
  }
  OutputFile& file_;
  Readers readers_;
  std::vector<int> numbers_;
  char mark_;  // The column "simulated" contains this character.
  std::string text_;
};

}  // namespace

std::unique_ptr<Recorder> make_recorder(Format format, OutputFile& file, const design::Design& design, Origin origin) {
  if (format == Format::kCsv) return std::make_unique<CsvRecorder>(file, design, origin.facts.contains("simulated"));
  return std::make_unique<McapRecorder>(file, design, std::move(origin));
}

}  // namespace triskin::recording
