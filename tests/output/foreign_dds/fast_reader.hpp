// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
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
#include <random>
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

/// Loses this part of all packets that come, always the same ones of a sequence.
class LossyTransport final : public eprosima::fastdds::rtps::ChainingTransport {
 public:
  LossyTransport(const eprosima::fastdds::rtps::ChainingTransportDescriptor& settings, double lost)
      : ChainingTransport(settings), low_(settings.low_level_descriptor), is_lost_(lost) {}
  [[nodiscard]] eprosima::fastdds::rtps::TransportDescriptorInterface* get_configuration() override {
    return low_.get();
  }
  bool send(rtps::SenderResource* low, const rtps::octet* data, std::uint32_t size, rtps::LocatorsIterator* first,
            rtps::LocatorsIterator* last, const std::chrono::steady_clock::time_point& until) override {
    return low->send(data, size, first, last, until);
  }
  void receive(eprosima::fastdds::rtps::TransportReceiverInterface* next, const rtps::octet* data, std::uint32_t size,
               const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
    const std::unique_lock lock(mutex_);
    if (is_lost_(random_)) return;
    next->OnDataReceived(data, size, local, remote);
  }

 private:
  std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> low_;
  std::mutex mutex_;
  std::bernoulli_distribution is_lost_;
  std::mt19937 random_{7};
};
struct LossyDescriptor final : eprosima::fastdds::rtps::ChainingTransportDescriptor {
  LossyDescriptor(const std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface>& low, double part)
      : ChainingTransportDescriptor(low), lost(part) {}
  [[nodiscard]] eprosima::fastdds::rtps::TransportInterface* create_transport() const override {
    return new LossyTransport(*this, lost);
  }
  double lost;
};

/// Takes part on the loopback interface alone, without multicast. `lost` is the part of packets that never arrive here.
class Participant : public dds::DomainParticipantListener {
 public:
  explicit Participant(std::uint32_t domain, double lost = 0.0) {
    // Between two participants of one process Fast DDS would pass pointers, and nothing would be on the wire.
    eprosima::fastrtps::LibrarySettingsAttributes library;
    library.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
    eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(library);
    dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
    const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.emplace_back("127.0.0.1");
    udp->receiveBufferSize = 1 << 20;
    qos.transport().use_builtin_transports = false;
    if (lost > 0.0) {
      std::printf("loses %g of the packets, seed 7\n", lost);
      qos.transport().user_transports.push_back(std::make_shared<LossyDescriptor>(udp, lost));
    } else {
      qos.transport().user_transports.push_back(udp);
    }
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

  void on_publisher_discovery(dds::DomainParticipant* who, rtps::WriterDiscoveryInfo&& info) override {
    const std::lock_guard lock(mutex_);
    if (info.info.guid().guidPrefix != who->guid().guidPrefix)
      info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER
          ? static_cast<void>(writers_.erase(info.info.guid()))
          : static_cast<void>(writers_[info.info.guid()] = info.info.topicName().to_string());
    Announced& a = announced_[info.info.topicName().to_string()];
    a.type = info.info.typeName().to_string();
    const auto& bytes = info.info.m_qos.m_userData.getValue();
    a.user_data.assign(bytes.begin(), bytes.end());
    a.reliable = info.info.m_qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS;
    a.latched = info.info.m_qos.m_durability.kind == dds::TRANSIENT_LOCAL_DURABILITY_QOS;
  }
  void on_subscriber_discovery(dds::DomainParticipant* who, rtps::ReaderDiscoveryInfo&& info) override {
    const std::lock_guard lock(mutex_);
    if (info.info.guid().guidPrefix != who->guid().guidPrefix)
      info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER
          ? static_cast<void>(readers_.erase(info.info.guid()))
          : static_cast<void>(readers_[info.info.guid()] = info.info.topicName().to_string());
  }
  /// Counts readers or writers of others on a topic, as rmw_fastrtps does to find out whether a service is there.
  int readers_of(const std::string& topic) { return count(readers_, topic); }
  int writers_of(const std::string& topic) { return count(writers_, topic); }
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
  using Endpoints = std::map<rtps::GUID_t, std::string>;
  int count(const Endpoints& endpoints, const std::string& topic) {
    const std::lock_guard lock(mutex_);
    return static_cast<int>(std::ranges::count_if(endpoints, [&](const auto& e) { return e.second == topic; }));
  }
  std::map<std::string, Announced> announced_;
  Endpoints readers_, writers_;
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
