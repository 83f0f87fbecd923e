// SPDX-License-Identifier: GPL-3.0-or-later
#include "dds_cyclone_messages.hpp"

#include <dds/ddsi/q_radmin.h>

#include <cstring>
#include <utility>

namespace triskin::bridge {
namespace {

// Cyclone handles this message and counts the references to it.
struct Message {
  ddsi_serdata head;  // The head must be declared first, because Cyclone uses its address for the whole object.
  std::size_t size;
  std::vector<std::uint8_t> bytes;  // The bytes are padded to a multiple of four, because Cyclone may read that many.
};
Message& message_of(const ddsi_serdata* d) {
  return *const_cast<Message*>(reinterpret_cast<const Message*>(d));
}

// Our topics have no key, so all messages of one topic are of one instance.
bool same_key(const ddsi_serdata* /*a*/, const ddsi_serdata* /*b*/) {
  return true;
}
std::uint32_t size_of(const ddsi_serdata* d) {
  return static_cast<std::uint32_t>(message_of(d).size);
}
ddsi_serdata* make(const ddsi_sertype* type, ddsi_serdata_kind kind, std::vector<std::uint8_t> bytes) {
  const std::size_t size = bytes.size();
  bytes.resize((size + 3) / 4 * 4);
  auto* m = new Message{{}, size, std::move(bytes)};
  ddsi_serdata_init(&m->head, type, kind);
  m->head.hash = type->serdata_basehash;
  return &m->head;
}
// Received messages are requests of a few bytes, so a sender cannot make us store more than this.
constexpr std::size_t kMaxReceived_bytes = 65'536;

// Joins a message from several packets, whose parts are in order but may overlap.
ddsi_serdata* from_network(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* part, std::size_t size) {
  if (size > kMaxReceived_bytes) return nullptr;  // Cyclone then drops the message.
  std::vector<std::uint8_t> bytes;
  bytes.reserve(size);
  for (; part != nullptr; part = part->nextfrag) {
    if (part->maxp1 <= bytes.size()) continue;
    const auto* first = reinterpret_cast<const std::uint8_t*>(part->rmsg + 1) + NN_RDATA_PAYLOAD_OFF(part);
    bytes.insert(bytes.end(), first + (bytes.size() - part->min), first + (part->maxp1 - part->min));
  }
  return make(type, kind, std::move(bytes));
}
ddsi_serdata* from_vector(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t n,
                          const ddsrt_iovec_t* parts, std::size_t size) {
  if (size > kMaxReceived_bytes) return nullptr;
  std::vector<std::uint8_t> bytes;
  bytes.reserve(size);
  for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k) {
    const auto* first = static_cast<const std::uint8_t*>(parts[k].iov_base);
    bytes.insert(bytes.end(), first, first + parts[k].iov_len);
  }
  return make(type, kind, std::move(bytes));
}
ddsi_serdata* from_hash(const ddsi_sertype* type, const ddsi_keyhash* /*hash*/) {
  return make(type, SDK_KEY, {0, 1, 0, 0});
}
ddsi_serdata* from_sample(const ddsi_sertype* /*type*/, ddsi_serdata_kind /*kind*/, const void* /*sample*/) {
  return nullptr;
}
void copy_out(const ddsi_serdata* d, std::size_t offset, std::size_t size, void* out) {
  std::memcpy(out, message_of(d).bytes.data() + offset, size);
}
ddsi_serdata* lend(const ddsi_serdata* d, std::size_t offset, std::size_t size, ddsrt_iovec_t* out) {
  out->iov_base = message_of(d).bytes.data() + offset;
  out->iov_len = size;
  return ddsi_serdata_ref(d);
}
void take_back(ddsi_serdata* d, const ddsrt_iovec_t* /*part*/) {
  ddsi_serdata_unref(d);
}
bool to_sample(const ddsi_serdata* /*d*/, void* /*sample*/, void** /*buffer*/, void* /*end*/) {
  return false;
}
ddsi_serdata* to_untyped(const ddsi_serdata* d) {
  ddsi_serdata* key = make(d->type, SDK_KEY, {0, 1, 0, 0});
  key->type = nullptr;
  return key;
}
bool untyped_to_sample(const ddsi_sertype* /*type*/, const ddsi_serdata* /*d*/, void* /*sample*/, void** /*buffer*/,
                       void* /*end*/) {
  return true;
}
void release(ddsi_serdata* d) {
  delete &message_of(d);
}
std::size_t print(const ddsi_sertype* /*type*/, const ddsi_serdata* /*d*/, char* out, std::size_t size) {
  if (size > 0) *out = '\0';
  return 0;
}
void key_hash(const ddsi_serdata* /*d*/, ddsi_keyhash* out, bool /*md5*/) {
  std::memset(out, 0, sizeof *out);
}

const ddsi_serdata_ops& data_operations() {
  static const ddsi_serdata_ops kOps = [] {
    ddsi_serdata_ops ops{};
    ops.eqkey = same_key;
    ops.get_size = size_of;
    ops.from_ser = from_network;
    ops.from_ser_iov = from_vector;
    ops.from_keyhash = from_hash;
    ops.from_sample = from_sample;
    ops.to_ser = copy_out;
    ops.to_ser_ref = lend;
    ops.to_ser_unref = take_back;
    ops.to_sample = to_sample;
    ops.to_untyped = to_untyped;
    ops.untyped_to_sample = untyped_to_sample;
    ops.free = release;
    ops.print = print;
    ops.get_keyhash = key_hash;
    return ops;
  }();
  return kOps;
}

void free_type(ddsi_sertype* type) {
  ddsi_sertype_fini(type);
  delete type;
}
bool same_type(const ddsi_sertype* /*a*/, const ddsi_sertype* /*b*/) {
  return true;  // The names were already compared.
}
std::uint32_t hash_type(const ddsi_sertype* /*type*/) {
  return 0;
}

const ddsi_sertype_ops& type_operations() {
  static const ddsi_sertype_ops kOps = [] {
    ddsi_sertype_ops ops{};
    ops.version = ddsi_sertype_v0;
    ops.free = free_type;
    ops.equal = same_type;
    ops.hash = hash_type;
    return ops;
  }();
  return kOps;
}

}  // namespace

ddsi_sertype* make_message_type(const std::string& name) {
  auto* type = new ddsi_sertype{};
  ddsi_sertype_init_flags(type, name.c_str(), &type_operations(), &data_operations(),
                          DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return type;
}

ddsi_serdata* make_message(const ddsi_sertype* type, Bytes message) {
  return make(type, SDK_DATA, {message.begin(), message.end()});
}

std::vector<std::uint8_t> bytes_of_message(const ddsi_serdata* message) {
  const Message& m = message_of(message);
  return {m.bytes.begin(), m.bytes.begin() + static_cast<std::ptrdiff_t>(m.size)};
}

}  // namespace triskin::bridge
