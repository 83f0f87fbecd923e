// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

#include <cstdint>
#include <fastdds/dds/core/policy/QosPolicies.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

/// Reads with Fast DDS and its own CDR. Types are structures with a function read(Cdr&).
namespace triskin::foreign {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using Cdr = eprosima::fastcdr::Cdr;

/// Describes a structure `Type` to Fast DDS, for reading only.
template <class Type>
class ReadType final : public dds::TopicDataType {
 public:
  explicit ReadType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 1 << 20;
    m_isGetKeyDefined = false;
  }
  bool serialize(void* /*data*/, rtps::SerializedPayload_t* /*out*/) override { return false; }
  bool deserialize(rtps::SerializedPayload_t* in, void* data) override {
    eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(in->data), in->length);
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    try {
      cdr.read_encapsulation();
      static_cast<Type*>(data)->read(cdr);
    } catch (const eprosima::fastcdr::exception::Exception&) {
      return false;
    }
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* /*data*/) override {
    return [] { return 0U; };
  }
  void* createData() override { return new Type; }
  void deleteData(void* data) override { delete static_cast<Type*>(data); }
  bool getKey(void* /*data*/, rtps::InstanceHandle_t* /*key*/, bool /*md5*/) override { return false; }
};

/// Holds what a writer announced when it was discovered.
struct Announced {
  std::string type, user_data;
  bool reliable = false, latched = false;
};

/// Takes part on the loopback interface alone, without multicast.
class Participant : public dds::DomainParticipantListener {
 public:
  explicit Participant(std::uint32_t domain) {
    dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
    const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.emplace_back("127.0.0.1");
    udp->receiveBufferSize = 1 << 20;
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    for (std::uint32_t k = 0; k < 8; ++k) {  // RTPS defines the ports of the participants of this domain by this rule.
      rtps::Locator_t peer;
      rtps::IPLocator::setIPv4(peer, "127.0.0.1");
      peer.port = 7400 + 250 * domain + 10 + 2 * k;
      qos.wire_protocol().builtin.initialPeersList.push_back(peer);
    }
    me_ = dds::DomainParticipantFactory::get_instance()->create_participant(domain, qos, this, dds::StatusMask::none());
    if (me_ == nullptr) throw std::runtime_error("Fast DDS: no participant");
    subscriber_ = me_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  }
  ~Participant() override {
    me_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(me_);
  }
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  void on_publisher_discovery(dds::DomainParticipant* /*who*/, rtps::WriterDiscoveryInfo&& info) override {
    const std::lock_guard lock(mutex_);
    Announced& a = announced_[info.info.topicName().to_string()];
    a.type = info.info.typeName().to_string();
    const auto& bytes = info.info.m_qos.m_userData.getValue();
    a.user_data.assign(bytes.begin(), bytes.end());
    a.reliable = info.info.m_qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS;
    a.latched = info.info.m_qos.m_durability.kind == dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  }
  Announced announced(const std::string& topic) {
    const std::lock_guard lock(mutex_);
    return announced_[topic];
  }
  [[nodiscard]] dds::DomainParticipant& entity() { return *me_; }
  [[nodiscard]] dds::Subscriber& subscriber() { return *subscriber_; }

 private:
  dds::DomainParticipant* me_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
  std::mutex mutex_;
  std::map<std::string, Announced> announced_;
};

template <class Type>
class FastReader {
 public:
  FastReader(Participant& participant, const std::string& topic, const std::string& type, bool reliable, bool latched) {
    dds::TypeSupport support(new ReadType<Type>(type));
    support.register_type(&participant.entity());
    dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
    qos.reliability().kind = reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
    qos.durability().kind = latched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
    qos.history().kind = dds::KEEP_ALL_HISTORY_QOS;
    qos.resource_limits().max_samples = 20'000;
    qos.resource_limits().max_samples_per_instance = 20'000;
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    reader_ = participant.subscriber().create_datareader(
        participant.entity().create_topic(topic, type, dds::TOPIC_QOS_DEFAULT), qos, &listener_);
    if (reader_ == nullptr) throw std::runtime_error("Fast DDS: no reader of " + topic);
  }
  ~FastReader() { reader_->set_listener(nullptr); }
  FastReader(const FastReader&) = delete;
  FastReader& operator=(const FastReader&) = delete;

  /// Calls `handler` with each message and its number in the writer's sequence, from 1.
  std::size_t take(const std::function<void(const Type&, std::uint64_t)>& handler) {
    std::size_t taken = 0;
    while (true) {
      Type message;
      dds::SampleInfo info;
      if (reader_->take_next_sample(&message, &info) != eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK)
        return taken;
      if (!info.valid_data) continue;
      handler(message, info.sample_identity.sequence_number().to64long());
      ++taken;
    }
  }
  [[nodiscard]] bool matched() const {
    dds::SubscriptionMatchedStatus status;
    return reader_->get_subscription_matched_status(status) == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK &&
           status.current_count > 0;
  }
  /// Returns the messages that Fast DDS reports as lost.
  [[nodiscard]] int lost() const { return listener_.lost; }

 private:
  struct Listener : dds::DataReaderListener {
    void on_sample_lost(dds::DataReader* /*reader*/, const dds::SampleLostStatus& status) override {
      lost = status.total_count;
    }
    std::atomic<int> lost = 0;
  };
  Listener listener_;
  dds::DataReader* reader_ = nullptr;
};

}  // namespace triskin::foreign
