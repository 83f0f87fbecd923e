// SPDX-License-Identifier: GPL-3.0-or-later
// Cyclone DDS is given messages that are CDR already: a sertype and a serdata of our own carry the bytes as they are.
#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <fmt/format.h>

#include <cstring>
#include <utility>
#include <vector>

#include "triskin/bridge/dds.hpp"
#include "triskin/host/error.hpp"

namespace triskin::bridge {
namespace {

// One message on its way. Cyclone counts who needs it.
struct Message {
  ddsi_serdata head;  // first: Cyclone knows it by this address
  std::size_t size;
  std::vector<std::uint8_t> bytes;  // up to a multiple of four: so many may be asked for
};
Message& message_of(const ddsi_serdata* d) {
  return *const_cast<Message*>(reinterpret_cast<const Message*>(d));
}

// Topics of ours have no key, so all messages of one are of one instance.
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
// Nothing is read: the participant has writers only.
ddsi_serdata* from_network(const ddsi_sertype* /*type*/, ddsi_serdata_kind /*kind*/, const nn_rdata* /*chain*/,
                           std::size_t /*size*/) {
  return nullptr;
}
ddsi_serdata* from_vector(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t n,
                          const ddsrt_iovec_t* parts, std::size_t size) {
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
  return true;  // the names were compared
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

ddsi_sertype* make_type(const std::string& name) {
  auto* type = new ddsi_sertype{};
  ddsi_sertype_init_flags(type, name.c_str(), &type_operations(), &data_operations(),
                          DDSI_SERTYPE_FLAG_TOPICKIND_NO_KEY);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return type;
}

dds_entity_t checked(dds_entity_t entity, const std::string& what) {
  if (entity >= 0) return entity;
  throw DeviceError(fmt::format("DDS: {}: {}; look at CYCLONEDDS_URI and the network", what, dds_strretcode(-entity)));
}

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

Qos qos_of(const Delivery& delivery, std::string_view type_hash) {
  Qos qos(dds_create_qos());
  const dds_data_representation_id_t plain = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, delivery.depth);
  dds_qset_durability(qos.get(), delivery.latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (delivery.latched)
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, delivery.depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  dds_qset_data_representation(qos.get(), 1, &plain);
  const std::string data = fmt::format("typehash={};", type_hash);
  dds_qset_userdata(qos.get(), data.data(), data.size());
  return qos;
}

class CyclonePublisher final : public Publisher {
 public:
  CyclonePublisher(dds_entity_t participant, const std::string& name, const RosType& type, const Delivery& delivery)
      : name_("rt" + name), type_(make_type(dds_name(type.message.name))) {
    const Qos qos = qos_of(delivery, type.hash);
    const dds_entity_t topic = dds_create_topic_sertype(participant, name_.c_str(), &type_, nullptr, nullptr, nullptr);
    if (topic < 0) ddsi_sertype_unref(type_);
    topic_ = checked(topic, "topic " + name_);
    writer_ = checked(dds_create_writer(participant, topic_, qos.get(), nullptr), "writer of " + name_);
  }
  ~CyclonePublisher() override {
    (void)dds_delete(writer_);
    (void)dds_delete(topic_);
  }
  CyclonePublisher(const CyclonePublisher&) = delete;
  CyclonePublisher& operator=(const CyclonePublisher&) = delete;

  void write(Bytes message) override {
    const dds_return_t result = dds_writecdr(writer_, make(type_, SDK_DATA, {message.begin(), message.end()}));
    // A reader that takes nothing holds the writer up; its messages are dropped, and the others get theirs.
    if (result != DDS_RETCODE_TIMEOUT) (void)checked(result, "write to " + name_);
  }
  [[nodiscard]] int readers() const override {
    dds_publication_matched_status_t status{};
    return dds_get_publication_matched_status(writer_, &status) == DDS_RETCODE_OK
               ? static_cast<int>(status.current_count)
               : 0;
  }

 private:
  std::string name_;
  ddsi_sertype* type_;  // of the topic
  dds_entity_t topic_ = 0, writer_ = 0;
};

class CycloneDomain final : public Domain {
 public:
  explicit CycloneDomain(std::uint32_t id)
      : participant_(checked(dds_create_participant(id, nullptr, nullptr), fmt::format("domain {}", id))) {}
  ~CycloneDomain() override { (void)dds_delete(participant_); }
  CycloneDomain(const CycloneDomain&) = delete;
  CycloneDomain& operator=(const CycloneDomain&) = delete;
  std::unique_ptr<Publisher> advertise(const std::string& name, const RosType& type,
                                       const Delivery& delivery) override {
    return std::make_unique<CyclonePublisher>(participant_, name, type, delivery);
  }

 private:
  dds_entity_t participant_;
};

}  // namespace

bool dds_available() {
  return true;
}

std::unique_ptr<Domain> join_domain(std::uint32_t id) {
  return std::make_unique<CycloneDomain>(id);
}

}  // namespace triskin::bridge
