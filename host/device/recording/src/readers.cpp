// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/recording/readers.hpp"

#include "triskin/recording/cdr.hpp"

namespace triskin::recording {

Readers::Readers(const design::Design& design) {
  patch_at_.fill(layout::PatchIndex::none());
  for (const layout::PatchIndex p : design::patches_here(design))
    patch_at_.at(static_cast<std::size_t>(design::node_address_of(design, p))) = p;
  for (const design::ModuleWiring& m : design::wiring_of(design)) {
    readers_.push_back({m.patch, m.patch < 0 ? layout::NodeAddress{} : design::node_address_of(design, m.patch)});
  }
}

bool Readers::add(const ModuleSample& sample) {
  const auto module = static_cast<std::size_t>(sample.module);
  const layout::NodeAddress node{sample.sample.node_address};
  const layout::PatchIndex patch = patch_at_[sample.sample.node_address];
  if (module >= readers_.size() || patch < 0 || readers_[module].node == node) return false;
  readers_[module] = {patch, node};
  return true;
}

std::vector<std::uint8_t> encode_readers(std::span<const Reader> readers, std::uint64_t link_time_us,
                                         std::uint64_t stamp_ns) {
  CdrWriter w;
  put_header(w, stamp_ns, kMeshFrame);
  w.u64(link_time_us);
  w.count(readers.size());
  for (const Reader& r : readers) w.u32(static_cast<std::uint32_t>(r.patch));
  w.count(readers.size());
  for (const Reader& r : readers) w.u8(static_cast<std::uint8_t>(r.node));
  return {w.message().begin(), w.message().end()};
}

std::optional<ReadersAt> decode_readers(Bytes message) {
  CdrReader r(message);
  (void)r.u64();  // The fields of the header are not needed.
  (void)r.text();
  ReadersAt at;
  at.link_time_us = r.u64();
  at.readers.resize(r.count(sizeof(std::uint32_t)));
  for (Reader& reader : at.readers) reader.patch = layout::PatchIndex{static_cast<std::int32_t>(r.u32())};
  if (r.count(1) != at.readers.size()) return std::nullopt;
  for (Reader& reader : at.readers) reader.node = layout::NodeAddress{r.u8()};
  if (!r.ok()) return std::nullopt;
  return at;
}

}  // namespace triskin::recording
