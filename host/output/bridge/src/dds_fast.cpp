// SPDX-License-Identifier: GPL-3.0-or-later
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <deque>
#include <fastdds/dds/core/policy/QosPolicies.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/log/Log.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <map>
#include <mutex>
#include <set>
#include <utility>
#include <vector>

#include "triskin/base/error.hpp"
#include "triskin/bridge/dds.hpp"
#include "triskin/recording/cdr.hpp"

namespace triskin::bridge {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using ReturnCode = eprosima::fastrtps::types::ReturnCode_t;
using Clock = std::chrono::steady_clock;
using rtps::GUID_t;

// Requests are short, so a sender cannot make us store more than this; Fast DDS drops what is longer.
constexpr std::uint32_t kMaxReceived_bytes = 65'536;

[[noreturn]] void fail(const std::string& what) {
  throw DeviceError(
      fmt::format("DDS: {} failed; look at the network and at FASTRTPS_DEFAULT_PROFILES_FILE, then try again", what));
}
void require(const ReturnCode& code, const std::string& what) {
  if (code != ReturnCode::RETCODE_OK) fail(what);
}
template <class Entity>
Entity* made(Entity* entity, const std::string& what) {
  return entity != nullptr ? entity : (fail("making " + what), nullptr);
}

// Messages are CDR already: one type for all, by name. Writers get a Bytes, readers a vector.
class MessageType final : public dds::TopicDataType {
 public:
  explicit MessageType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = kMaxReceived_bytes;
    m_isGetKeyDefined = false;
    auto_fill_type_information(false);
    auto_fill_type_object(false);
  }
  bool serialize(void* data, rtps::SerializedPayload_t* out) override {
    const Bytes& message = *static_cast<const Bytes*>(data);
    if (message.size() > out->max_size) return false;
    out->length = static_cast<std::uint32_t>(message.size());
    out->encapsulation = CDR_LE;
    std::memcpy(out->data, message.data(), message.size());
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* in, void* data) override {
    static_cast<std::vector<std::uint8_t>*>(data)->assign(in->data, in->data + in->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<const Bytes*>(data)->size()); };
  }
  void* createData() override { return new std::vector<std::uint8_t>; }
  void deleteData(void* data) override { delete static_cast<std::vector<std::uint8_t>*>(data); }
  bool getKey(void* /*data*/, rtps::InstanceHandle_t* /*key*/, bool /*md5*/) override { return false; }
};

dds::DataWriterQos writer_qos(const Delivery& delivery, const std::string& user_data) {
  dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
  qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  qos.reliability().max_blocking_time = eprosima::fastrtps::Duration_t(0, 100'000'000);
  qos.durability().kind = delivery.latched ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = delivery.depth;
  qos.resource_limits().max_samples = qos.resource_limits().max_samples_per_instance = delivery.depth;
  qos.resource_limits().allocated_samples = 1;
  qos.endpoint().history_memory_policy = rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
  // A heartbeat that overtakes its message, as it can from a thread of its own, makes a reader of Cyclone DDS that has
  // just come skip that message.
  qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  // A reader that lost the last message of a burst asks for it after this time.
  qos.reliable_writer_qos().times.heartbeatPeriod = eprosima::fastrtps::Duration_t(0, 200'000'000);
  qos.data_sharing().off();
  qos.user_data().setValue({user_data.begin(), user_data.end()});
  return qos;
}

dds::DataReaderQos reader_qos(bool reliable, int depth, const std::string& user_data) {
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  qos.reliability().kind = reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = depth;
  qos.resource_limits().max_samples = qos.resource_limits().max_samples_per_instance = depth;
  qos.resource_limits().allocated_samples = 1;
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_MEMORY_MODE;  // This limits what is received.
  qos.data_sharing().off();
  qos.user_data().setValue({user_data.begin(), user_data.end()});
  return qos;
}

std::array<std::uint8_t, 16> bytes_of(const GUID_t& guid) {
  std::array<std::uint8_t, 16> bytes{};
  std::copy_n(guid.guidPrefix.value, 12, bytes.begin());
  std::copy_n(guid.entityId.value, 4, bytes.begin() + 12);
  return bytes;
}
GUID_t guid_of(const std::array<std::uint8_t, 16>& bytes) {
  GUID_t guid;
  std::copy_n(bytes.begin(), 12, guid.guidPrefix.value);
  std::copy_n(bytes.begin() + 12, 4, guid.entityId.value);
  return guid;
}

// rmw_cyclonedds announces "clientid=…;" with reader and writer of a client; the other middleware announces none.
std::string client_id_of(const std::vector<std::uint8_t>& user_data) {
  const std::string_view text(reinterpret_cast<const char*>(user_data.data()), user_data.size());
  constexpr std::string_view kKey = "clientid=";
  const std::size_t at = text.find(kKey);
  if (at == std::string_view::npos || (at > 0 && text[at - 1] != ';')) return {};
  const std::string_view rest = text.substr(at + kKey.size());
  return std::string(rest.substr(0, rest.find(';')));
}

// What others announced. The threads of Fast DDS write here.
class Discovered final : public dds::DomainParticipantListener {
 public:
  void on_publisher_discovery(dds::DomainParticipant* who, rtps::WriterDiscoveryInfo&& info) override {
    note(who, writers_, info.info, info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER);
  }
  void on_subscriber_discovery(dds::DomainParticipant* who, rtps::ReaderDiscoveryInfo&& info) override {
    note(who, readers_, info.info, info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER);
  }
  [[nodiscard]] int writers_of(const std::string& topic) const {
    const std::lock_guard lock(mutex_);
    return static_cast<int>(std::ranges::count_if(writers_, [&](const auto& w) { return w.second.topic == topic; }));
  }
  [[nodiscard]] std::string client_of_writer(const GUID_t& guid) const { return client_in(writers_, guid); }
  [[nodiscard]] std::string client_of_reader(const GUID_t& guid) const { return client_in(readers_, guid); }

 private:
  struct Endpoint {
    std::string topic, client;
  };
  using Endpoints = std::map<GUID_t, Endpoint>;

  template <class Info>
  void note(const dds::DomainParticipant* who, Endpoints& endpoints, const Info& info, bool removed) {
    if (info.guid().guidPrefix == who->guid().guidPrefix) return;
    const std::lock_guard lock(mutex_);
    if (removed) {
      endpoints.erase(info.guid());
    } else {
      endpoints[info.guid()] = {info.topicName().to_string(), client_id_of(info.m_qos.m_userData.getValue())};
    }
  }
  std::string client_in(const Endpoints& endpoints, const GUID_t& guid) const {
    const std::lock_guard lock(mutex_);
    const auto found = endpoints.find(guid);
    return found == endpoints.end() ? "" : found->second.client;
  }

  mutable std::mutex mutex_;
  Endpoints writers_, readers_;
};

class FastPublisher : public Publisher, private dds::DataWriterListener {
 public:
  FastPublisher(dds::Publisher& publisher, dds::Topic& topic, const dds::DataWriterQos& qos)
      : publisher_(publisher),
        name_(topic.get_name()),
        writer_(made(publisher.create_datawriter(&topic, qos, this, dds::StatusMask::publication_matched()),
                     "the writer of " + name_)) {}
  ~FastPublisher() override {
    // What a reader still lacks is sent again for at most a second.
    (void)writer_->wait_for_acknowledgments(eprosima::fastrtps::Duration_t(1, 0));
    (void)writer_->set_listener(nullptr);
    (void)publisher_.delete_datawriter(writer_);
  }
  FastPublisher(const FastPublisher&) = delete;
  FastPublisher& operator=(const FastPublisher&) = delete;

  void write(Bytes message) override {
    // A reader that accepts nothing does not hold up the others: the oldest message goes.
    if (!writer_->write(&message)) fail("writing to " + name_);
  }
  void answer(Bytes message, const rtps::SampleIdentity& request) {
    rtps::WriteParams params;
    params.related_sample_identity(request);
    if (!writer_->write(&message, params)) fail("writing to " + name_);
  }
  [[nodiscard]] int readers() const override {
    const std::lock_guard lock(mutex_);
    return static_cast<int>(matched_.size());
  }
  [[nodiscard]] std::set<GUID_t> matched() const {
    const std::lock_guard lock(mutex_);
    return matched_;
  }
  [[nodiscard]] GUID_t guid() const { return writer_->guid(); }

 private:
  void on_publication_matched(dds::DataWriter* /*writer*/, const dds::PublicationMatchedStatus& status) override {
    const GUID_t reader = rtps::iHandle2GUID(status.last_subscription_handle);
    const std::lock_guard lock(mutex_);
    if (status.current_count_change > 0) {
      matched_.insert(reader);
    } else {
      matched_.erase(reader);
    }
  }

  dds::Publisher& publisher_;
  std::string name_;
  mutable std::mutex mutex_;
  std::set<GUID_t> matched_;
  dds::DataWriter* writer_;  // last: its thread calls the listener as soon as it is there
};

class FastReader {
 public:
  FastReader(dds::Subscriber& subscriber, dds::Topic& topic, const dds::DataReaderQos& qos)
      : subscriber_(subscriber),
        reader_(made(subscriber.create_datareader(&topic, qos), "the reader of " + topic.get_name())) {}
  ~FastReader() { (void)subscriber_.delete_datareader(reader_); }
  FastReader(const FastReader&) = delete;
  FastReader& operator=(const FastReader&) = delete;
  bool take(std::vector<std::uint8_t>& message, dds::SampleInfo& info) {
    while (reader_->take_next_sample(&message, &info) == ReturnCode::RETCODE_OK)
      if (info.valid_data) return true;
    return false;
  }
  [[nodiscard]] GUID_t guid() const { return reader_->guid(); }

 private:
  dds::Subscriber& subscriber_;
  dds::DataReader* reader_;
};

class FastSubscriber final : public Subscriber {
 public:
  FastSubscriber(dds::Subscriber& subscriber, dds::Topic& topic)
      : reader_(subscriber, topic, reader_qos(false, 1, "")) {}
  std::optional<std::vector<std::uint8_t>> take() override {
    std::vector<std::uint8_t> message;
    dds::SampleInfo info;
    bool any = false;
    while (reader_.take(message, info)) any = true;
    return any ? std::optional(std::move(message)) : std::nullopt;
  }
  [[nodiscard]] GUID_t guid() const { return reader_.guid(); }

 private:
  FastReader reader_;
};

// A client of rmw_fastrtps sends the plain message and waits for an answer whose inline QoS names the GUID of its
// reader and the RTPS sequence number of its request. A client of rmw_cyclonedds writes a number of itself and of the
// request, 8 bytes each, before both. Which of the two a request is follows from who sent it, before a byte of it is
// read (ros2/rmw_cyclonedds#577).
class FastServer final : public Server {
 public:
  FastServer(const Discovered& discovered, std::unique_ptr<FastReader> requests, std::unique_ptr<FastPublisher> answers)
      : discovered_(discovered), requests_(std::move(requests)), answers_(std::move(answers)) {}

  std::optional<Request> take() override {
    send_waiting();
    std::vector<std::uint8_t> message;
    dds::SampleInfo info;
    while (requests_->take(message, info)) {
      const GUID_t& sender = info.sample_identity.writer_guid();
      Request request;
      request.id.cyclone_client = discovered_.client_of_writer(sender);
      if (request.id.cyclone_client.empty()) {
        const GUID_t& waiting = info.related_sample_identity.writer_guid();
        request.id.client = bytes_of(waiting == GUID_t::unknown() ? sender : waiting);
        request.id.number = info.sample_identity.sequence_number().to64long();
      } else {
        if (message.size() < kEncoding + kCycloneHead) continue;
        std::copy_n(message.begin() + kEncoding, 8, request.id.client.begin());
        std::memcpy(&request.id.number, message.data() + kEncoding + 8, 8);
        message.erase(message.begin() + kEncoding, message.begin() + kEncoding + kCycloneHead);
      }
      request.message = std::move(message);
      return request;
    }
    return std::nullopt;
  }

  void write(const RequestId& id, Bytes answer) override {
    waiting_.push_back({id, {answer.begin(), answer.end()}, Clock::now() + std::chrono::seconds(2)});
    send_waiting();
  }

 private:
  static constexpr std::ptrdiff_t kEncoding = 4, kCycloneHead = 16;
  struct Waiting {
    RequestId id;
    std::vector<std::uint8_t> answer;
    Clock::time_point until;
  };

  // A volatile writer sends only to readers that it has matched, so an answer waits for that.
  void send_waiting() {
    const std::set<GUID_t> readers = answers_->matched();
    std::erase_if(waiting_, [&](const Waiting& w) {
      if (!is_matched(w.id, readers)) return Clock::now() > w.until;
      send(w);
      return true;
    });
  }
  [[nodiscard]] bool is_matched(const RequestId& id, const std::set<GUID_t>& readers) const {
    if (!id.cyclone_client.empty())
      return std::ranges::any_of(readers,
                                 [&](const GUID_t& r) { return discovered_.client_of_reader(r) == id.cyclone_client; });
    const bool is_reader = (id.client[15] & 0x04U) != 0;  // DDSI-RTPS 9.3.1.2, entityKind
    return !is_reader || readers.contains(guid_of(id.client));
  }
  void send(const Waiting& w) {
    if (w.id.cyclone_client.empty()) {
      rtps::SampleIdentity request;
      request.writer_guid(guid_of(w.id.client));
      request.sequence_number(rtps::SequenceNumber_t(static_cast<std::int32_t>(w.id.number >> 32),
                                                     static_cast<std::uint32_t>(w.id.number)));
      return answers_->answer(w.answer, request);
    }
    std::vector<std::uint8_t> message(w.answer.begin(), w.answer.begin() + kEncoding);
    message.insert(message.end(), w.id.client.begin(), w.id.client.begin() + 8);
    for (unsigned k = 0; k < 8; ++k) message.push_back(static_cast<std::uint8_t>(w.id.number >> (8 * k)));
    message.insert(message.end(), w.answer.begin() + kEncoding, w.answer.end());
    answers_->write(message);
  }

  const Discovered& discovered_;
  std::unique_ptr<FastReader> requests_;
  std::unique_ptr<FastPublisher> answers_;
  std::deque<Waiting> waiting_;
};

rtps::Locator_t udp(const std::string& address, std::uint32_t port) {
  rtps::Locator_t locator;
  if (!rtps::IPLocator::setIPv4(locator, address)) fail("reading the address " + address);
  locator.port = port;
  return locator;
}

// Fast DDS tries the ports of this many participants at each peer, as nodes of ROS 2 do.
constexpr std::uint32_t kParticipantsOfPeer = 32;

// The settings of ROS 2 on top of the user's own profile.
dds::DomainParticipantQos participant_qos(std::uint32_t domain, const RosDiscovery& discovery) {
  auto* factory = dds::DomainParticipantFactory::get_instance();
  require(factory->load_profiles(), "reading the profile of Fast DDS");
  dds::DomainParticipantQos qos = factory->get_default_participant_qos();
  qos.name("triskin");
  const std::string enclave = "enclave=/;";
  qos.user_data().setValue({enclave.begin(), enclave.end()});
  auto& transport = qos.transport();
  const bool loopback = discovery.range == DiscoveryRange::kLoopback;
  // UDP alone: shared memory fails silently between users and containers of one computer, and 6 MB/s need none.
  if (loopback || (transport.use_builtin_transports && transport.user_transports.empty())) {
    const auto udp4 = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp4->maxInitialPeersRange = kParticipantsOfPeer;
    udp4->sendBufferSize = udp4->receiveBufferSize = 1U << 20U;
    if (loopback) udp4->interfaceWhiteList.emplace_back("127.0.0.1");
    transport.use_builtin_transports = false;
    transport.user_transports = {udp4};
  }
  auto& builtin = qos.wire_protocol().builtin;
  const bool local = loopback || discovery.range == DiscoveryRange::kLocalhost;
  if (local) builtin.initialPeersList.push_back(udp("127.0.0.1", 0));
  // A named unicast port keeps Fast DDS from joining the multicast group.
  if (discovery.range == DiscoveryRange::kLocalhost || discovery.range == DiscoveryRange::kOff)
    builtin.metatrafficUnicastLocatorList.push_back(udp("0.0.0.0", 0));
  for (const std::string& peer : discovery.peers) {
    const auto addresses = rtps::IPLocator::resolveNameDNS(peer).first;
    if (addresses.empty()) throw InputError(fmt::format("ROS_STATIC_PEERS: {} has no IPv4 address", peer));
    for (const std::string& address : addresses) builtin.initialPeersList.push_back(udp(address, 0));
  }
  constexpr std::uint32_t kFirstPort = 7400, kPortsOfDomain = 250;  // DDSI-RTPS 9.6.2.3
  if (!local && !discovery.peers.empty())
    builtin.initialPeersList.push_back(udp("239.255.0.1", kFirstPort + kPortsOfDomain * domain));
  if (discovery.range == DiscoveryRange::kOff)
    builtin.discovery_config.discoveryProtocol = rtps::DiscoveryProtocol_t::NONE;
  return qos;
}

// Messages of Fast DDS belong on stderr, beside ours; stdout has the results. Anybody on the network can cause them, so
// only the first are shown.
class FewMessages final : public dds::LogConsumer {
 public:
  void Consume(const dds::Log::Entry& entry) override {
    constexpr int kShown = 5;
    if (shown_ < kShown) fmt::print(stderr, "DDS: {}\n", entry.message);
    if (++shown_ == kShown) fmt::print(stderr, "DDS: further messages are not shown\n");
  }

 private:
  int shown_ = 0;  // Fast DDS calls from one thread.
};

class FastDomain final : public Domain {
 public:
  FastDomain(std::uint32_t id, const RosDiscovery& discovery, RosNode node) : node_(std::move(node)) {
    dds::Log::ClearConsumers();
    dds::Log::RegisterConsumer(std::make_unique<FewMessages>());
    participant_ = made(dds::DomainParticipantFactory::get_instance()->create_participant(
                            id, participant_qos(id, discovery), &discovered_, dds::StatusMask::none()),
                        fmt::format("a participant of domain {}", id));
    publisher_ = made(participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT), "a publisher");
    subscriber_ = made(participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT), "a subscriber");
    // Not a topic of a node, so without "rt/".
    graph_ = std::make_unique<FastPublisher>(
        *publisher_, topic("ros_discovery_info", "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"),
        writer_qos({.depth = 1, .latched = true}, ""));
    tell_node();
  }
  ~FastDomain() override {
    graph_.reset();
    (void)participant_->set_listener(nullptr);
    (void)participant_->delete_contained_entities();
    (void)dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  FastDomain(const FastDomain&) = delete;
  FastDomain& operator=(const FastDomain&) = delete;

  std::unique_ptr<Publisher> advertise(const std::string& name, const RosType& type,
                                       const Delivery& delivery) override {
    const std::lock_guard lock(mutex_);
    auto publisher =
        std::make_unique<FastPublisher>(*publisher_, topic("rt" + node_.resolve(name), dds_name(type.message.name)),
                                        writer_qos(delivery, fmt::format("typehash={};", type.hash)));
    writers_.push_back(publisher->guid());
    tell_node();
    return publisher;
  }
  std::unique_ptr<Subscriber> subscribe(const std::string& name, std::string_view type) override {
    const std::lock_guard lock(mutex_);
    auto subscriber = std::make_unique<FastSubscriber>(*subscriber_, topic("rt" + node_.resolve(name), dds_name(type)));
    readers_.push_back(subscriber->guid());
    tell_node();
    return subscriber;
  }
  std::unique_ptr<Server> serve(const std::string& name, std::string_view type) override {
    const std::lock_guard lock(mutex_);
    const std::string types = dds_service_name(type), service = next_service_id(), full = node_.resolve(name);
    constexpr int kDepth = 10;
    auto answers = std::make_unique<FastPublisher>(*publisher_, topic("rr" + full + "Reply", types + "_Response_"),
                                                   writer_qos({.depth = kDepth, .latched = false}, service));
    auto requests = std::make_unique<FastReader>(*subscriber_, topic("rq" + full + "Request", types + "_Request_"),
                                                 reader_qos(true, kDepth, service));
    writers_.push_back(answers->guid());
    readers_.push_back(requests->guid());
    tell_node();
    return std::make_unique<FastServer>(discovered_, std::move(requests), std::move(answers));
  }
  int other_writers(const std::string& name) override { return discovered_.writers_of("rt" + node_.resolve(name)); }

 private:
  // Fast DDS wants one topic and type object of a name.
  dds::Topic& topic(const std::string& name, const std::string& type) {
    dds::Topic*& found = topics_[name];
    if (found != nullptr) return *found;
    if (participant_->find_type(type).empty())
      require(dds::TypeSupport(new MessageType(type)).register_type(participant_), "registering the type " + type);
    found = made(participant_->create_topic(name, type, dds::TOPIC_QOS_DEFAULT), "the topic " + name);
    return *found;
  }

  // The identifier tells a client of rmw_cyclonedds that a reader of requests and a writer of answers are one service:
  // 16 bytes, made from the participant and a number.
  std::string next_service_id() {
    auto bytes = bytes_of(participant_->guid());
    ++services_;
    for (std::size_t k = 0; k < 4; ++k) bytes[12 + k] = static_cast<std::uint8_t>(services_ >> (24 - 8 * k));
    std::string id = fmt::format("serviceid={:02x}", bytes[0]);
    for (std::size_t k = 1; k < bytes.size(); ++k) id += fmt::format(".{:x}", bytes[k]);
    return id + ";";
  }

  // rmw_dds_common/msg/ParticipantEntitiesInfo: ROS 2 learns from it which endpoints are those of which node.
  void tell_node() {
    recording::CdrWriter w;
    const auto put_gid = [&](const GUID_t& guid) {
      for (const std::uint8_t byte : bytes_of(guid)) w.u8(byte);
      if (node_.gid_has_24_bytes)
        for (int k = 0; k < 8; ++k) w.u8(0);
    };
    put_gid(participant_->guid());
    w.count(1);
    w.text(node_.space);
    w.text(node_.name);
    for (const auto* list : {&readers_, &writers_}) {
      w.count(list->size());
      for (const GUID_t& guid : *list) put_gid(guid);
    }
    graph_->write(w.message());
  }

  RosNode node_;
  Discovered discovered_;
  std::mutex mutex_;  // protects what follows when endpoints are made
  dds::DomainParticipant* participant_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
  std::map<std::string, dds::Topic*> topics_;
  std::unique_ptr<FastPublisher> graph_;
  std::vector<GUID_t> readers_, writers_;
  std::uint32_t services_ = 0;
};

}  // namespace

bool dds_available() {
  return true;
}

std::unique_ptr<Domain> join_domain(std::uint32_t id, const RosDiscovery& discovery, const RosNode& node) {
  return std::make_unique<FastDomain>(id, discovery, node);
}

}  // namespace triskin::bridge

#if defined(__SANITIZE_ADDRESS__)
#define TRISKIN_ADDRESS_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define TRISKIN_ADDRESS_SANITIZER
#endif
#endif
#ifdef TRISKIN_ADDRESS_SANITIZER
// Fast DDS 2.9 deletes objects by a type of another size, inside itself.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "new_delete_type_mismatch=0";
}
#endif
