// SPDX-License-Identifier: GPL-3.0-or-later
#include <dds/dds.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "dds_cyclone_messages.hpp"
#include "triskin/base/error.hpp"
#include "triskin/bridge/dds.hpp"

namespace triskin::bridge {
namespace {

dds_entity_t checked(dds_entity_t entity, const std::string& what) {
  if (entity >= 0) return entity;
  throw DeviceError(fmt::format("DDS: {}: {}; look at CYCLONEDDS_URI and the network", what, dds_strretcode(-entity)));
}

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

Qos qos_of(const Delivery& delivery, const std::string& user_data) {
  Qos qos(dds_create_qos());
  const dds_data_representation_id_t plain = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, DDS_MSECS(100));
  dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, delivery.depth);
  dds_qset_durability(qos.get(), delivery.latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (delivery.latched)
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, delivery.depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  dds_qset_data_representation(qos.get(), 1, &plain);
  dds_qset_userdata(qos.get(), user_data.data(), user_data.size());
  return qos;
}

class CycloneTopic {
 public:
  CycloneTopic(dds_entity_t participant, const std::string& name, const std::string& type)
      : type_(make_message_type(type)) {
    const dds_entity_t topic = dds_create_topic_sertype(participant, name.c_str(), &type_, nullptr, nullptr, nullptr);
    if (topic < 0) ddsi_sertype_unref(type_);
    topic_ = checked(topic, "topic " + name);
  }
  ~CycloneTopic() { (void)dds_delete(topic_); }
  CycloneTopic(const CycloneTopic&) = delete;
  CycloneTopic& operator=(const CycloneTopic&) = delete;
  [[nodiscard]] dds_entity_t entity() const { return topic_; }
  [[nodiscard]] const ddsi_sertype* type() const { return type_; }

 private:
  ddsi_sertype* type_;
  dds_entity_t topic_ = 0;
};

class CyclonePublisher final : public Publisher {
 public:
  CyclonePublisher(dds_entity_t participant, const std::string& name, const std::string& type, const Qos& qos)
      : name_(name),
        topic_(participant, name, type),
        writer_(checked(dds_create_writer(participant, topic_.entity(), qos.get(), nullptr), "writer of " + name)) {}
  ~CyclonePublisher() override { (void)dds_delete(writer_); }
  CyclonePublisher(const CyclonePublisher&) = delete;
  CyclonePublisher& operator=(const CyclonePublisher&) = delete;

  void write(Bytes message) override {
    const dds_return_t result = dds_writecdr(writer_, make_message(topic_.type(), message));
    // A reader that accepts nothing blocks the writer until the time-out; its messages are dropped, and the other
    // readers get theirs.
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
  CycloneTopic topic_;
  dds_entity_t writer_;
};

// Receives the requests of a service; a publisher writes its answers.
class CycloneServer final : public Server {
 public:
  CycloneServer(dds_entity_t participant, const std::string& name, const std::string& type, const Qos& qos)
      : requests_(participant, "rq" + name + "Request", type + "_Request_"),
        answers_(participant, "rr" + name + "Reply", type + "_Response_", qos),
        reader_(checked(dds_create_reader(participant, requests_.entity(), qos.get(), nullptr), "reader of " + name)) {}
  ~CycloneServer() override { (void)dds_delete(reader_); }
  CycloneServer(const CycloneServer&) = delete;
  CycloneServer& operator=(const CycloneServer&) = delete;

  std::optional<std::vector<std::uint8_t>> take() override {
    while (true) {
      ddsi_serdata* message = nullptr;
      dds_sample_info_t info{};
      if (checked(dds_takecdr(reader_, &message, 1, &info, DDS_ANY_STATE), "take a request") == 0) return std::nullopt;
      std::vector<std::uint8_t> bytes;
      if (info.valid_data) bytes = bytes_of_message(message);
      ddsi_serdata_unref(message);
      if (info.valid_data) return bytes;
    }
  }
  void write(Bytes answer) override { answers_.write(answer); }

 private:
  CycloneTopic requests_;
  CyclonePublisher answers_;
  dds_entity_t reader_;
};

// Knows the writers in the domain from discovery.
class CycloneWriters {
 public:
  explicit CycloneWriters(dds_entity_t participant)
      : reader_(checked(dds_create_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
                        "reader of the writers")) {}
  ~CycloneWriters() { (void)dds_delete(reader_); }
  CycloneWriters(const CycloneWriters&) = delete;
  CycloneWriters& operator=(const CycloneWriters&) = delete;

  // Counts the writers of a topic that belong to other participants.
  [[nodiscard]] int count(const std::string& topic, const dds_guid_t& own) const {
    constexpr std::size_t kMaxWriters = 4096;
    std::vector<void*> samples(kMaxWriters, nullptr);
    std::vector<dds_sample_info_t> infos(kMaxWriters);
    const dds_entity_t n = checked(
        dds_read_mask(reader_, samples.data(), infos.data(), kMaxWriters, kMaxWriters, DDS_ALIVE_INSTANCE_STATE),
        "read the writers of the domain");
    int found = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(n); ++k) {
      const auto* writer = static_cast<const dds_builtintopic_endpoint_t*>(samples[k]);
      if (!infos[k].valid_data || writer->topic_name != topic) continue;
      if (std::memcmp(writer->participant_key.v, own.v, sizeof own.v) != 0) ++found;
    }
    if (n > 0) (void)dds_return_loan(reader_, samples.data(), n);
    return found;
  }

 private:
  dds_entity_t reader_;
};

// Combines the settings of the ROS 2 variables with the user's own configuration, which is appended so that it wins.
// The result is 0 if the variables set nothing; the library then reads the user's configuration by itself.
dds_entity_t configured_domain(std::uint32_t id, RosDiscovery discovery) {
  const char* variable = std::getenv("CYCLONEDDS_URI");
  const std::string own = variable == nullptr ? "" : variable;
  // The library refuses an interface that is named twice.
  if (discovery.range == DiscoveryRange::kLoopback && own.find("NetworkInterface") != std::string::npos)
    discovery.range = DiscoveryRange::kLocalhost;
  std::string settings = cyclone_configuration(discovery, ::getpid());
  if (settings.empty()) return 0;
  if (!own.empty()) settings += "," + own;
  return checked(dds_create_domain(id, settings.c_str()), fmt::format("domain {}", id));
}

class CycloneDomain final : public Domain {
 public:
  CycloneDomain(std::uint32_t id, const RosDiscovery& discovery)
      : domain_(configured_domain(id, discovery)),
        participant_(checked(dds_create_participant(id, nullptr, nullptr), fmt::format("domain {}", id))) {}
  ~CycloneDomain() override {
    writers_.reset();  // With the last participant the library ends, and after that it must not be called.
    (void)dds_delete(participant_);
    if (domain_ > 0) (void)dds_delete(domain_);
  }
  CycloneDomain(const CycloneDomain&) = delete;
  CycloneDomain& operator=(const CycloneDomain&) = delete;
  std::unique_ptr<Publisher> advertise(const std::string& name, const RosType& type,
                                       const Delivery& delivery) override {
    return std::make_unique<CyclonePublisher>(participant_, "rt" + name, dds_name(type.message.name),
                                              qos_of(delivery, fmt::format("typehash={};", type.hash)));
  }
  std::unique_ptr<Server> serve(const std::string& name, std::string_view type) override {
    return std::make_unique<CycloneServer>(participant_, name, dds_service_name(type),
                                           qos_of({.depth = 10, .latched = false}, next_service_id()));
  }

  int other_writers(const std::string& name) override {
    const std::lock_guard lock(mutex_);
    if (!writers_) writers_.emplace(participant_);
    dds_guid_t own{};
    (void)checked(dds_get_guid(participant_, &own), "identifier of the participant");
    return writers_->count("rt" + name, own);
  }

 private:
  // The identifier tells a client that a reader of requests and a writer of answers are one service. It has 16 bytes,
  // made from the participant and a number, as rmw_cyclonedds writes it.
  std::string next_service_id() {
    dds_guid_t guid{};
    (void)checked(dds_get_guid(participant_, &guid), "identifier of the participant");
    const std::lock_guard lock(mutex_);
    ++services_;
    for (std::size_t k = 0; k < 4; ++k) guid.v[12 + k] = static_cast<std::uint8_t>(services_ >> (24 - 8 * k));
    return fmt::format("serviceid={:x};", fmt::join(guid.v, "."));
  }

  std::mutex mutex_;  // It protects services_ and writers_.
  std::uint32_t services_ = 0;
  std::optional<CycloneWriters> writers_;
  dds_entity_t domain_;  // The handle is 0 if the library created the domain by itself.
  dds_entity_t participant_;
};

}  // namespace

bool dds_available() {
  return true;
}

std::unique_ptr<Domain> join_domain(std::uint32_t id, const RosDiscovery& discovery) {
  return std::make_unique<CycloneDomain>(id, discovery);
}

}  // namespace triskin::bridge
