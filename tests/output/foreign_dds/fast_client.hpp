// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <cstring>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <functional>
#include <string>
#include <vector>

#include "fast_reader.hpp"
#include "settings.hpp"

namespace triskin::foreign {

/// A message that is CDR already, with the four bytes of its encoding.
using Message = std::vector<std::uint8_t>;

class RawType final : public dds::TopicDataType {
 public:
  explicit RawType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 1 << 16;
    m_isGetKeyDefined = false;
  }
  bool serialize(void* data, rtps::SerializedPayload_t* out) override {
    const Message& message = *static_cast<const Message*>(data);
    out->length = static_cast<std::uint32_t>(message.size());
    std::memcpy(out->data, message.data(), message.size());
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* in, void* data) override {
    static_cast<Message*>(data)->assign(in->data, in->data + in->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<const Message*>(data)->size()); };
  }
  void* createData() override { return new Message; }
  void deleteData(void* data) override { delete static_cast<Message*>(data); }
  bool getKey(void* /*data*/, rtps::InstanceHandle_t* /*key*/, bool /*md5*/) override { return false; }
};

/// Calls a service as rmw_fastrtps_shared_cpp does when it requests, takes responses and asks for servers: the
/// request is the plain message, its inline QoS names the reader that waits; of the answers those are taken that name
/// this reader or writer and the number of the request.
class FastClient {
 public:
  /// `type` is "triskin_msgs::srv::dds_::Tare".
  FastClient(Participant& participant, const std::string& service, const std::string& type)
      : participant_(participant), request_("rq" + service + "Request"), answer_("rr" + service + "Reply") {
    dds::TypeSupport(new RawType(type + "_Request_")).register_type(&participant.entity());
    dds::TypeSupport(new RawType(type + "_Response_")).register_type(&participant.entity());
    publisher_ = participant.entity().create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    dds::DataReaderQos reader = dds::DATAREADER_QOS_DEFAULT;
    reader.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
    reader.history().depth = 10;
    reader.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    reader_ = participant.subscriber().create_datareader(topic(answer_, type + "_Response_"), reader);
    dds::DataWriterQos writer = dds::DATAWRITER_QOS_DEFAULT;
    writer.history().depth = 10;
    writer.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    writer_ = publisher_->create_datawriter(topic(request_, type + "_Request_"), writer);
    if (reader_ == nullptr || writer_ == nullptr) throw std::runtime_error("Fast DDS: no client of " + service);
  }
  FastClient(const FastClient&) = delete;
  FastClient& operator=(const FastClient&) = delete;

  /// service_is_ready: servers' readers and writers are there, and as many of the one as of the other.
  [[nodiscard]] bool is_ready() const {
    const int readers = participant_.readers_of(request_), writers = participant_.writers_of(answer_);
    return readers >= 1 && readers == writers;
  }
  void send(Message message) {
    rtps::WriteParams params;
    params.related_sample_identity().writer_guid() = reader_->guid();
    if (!writer_->write(&message, params)) throw std::runtime_error("Fast DDS: not written");
    number_ = params.sample_identity().sequence_number();
  }
  /// Calls `handler` with the answer to the last request; counts others.
  bool wait(const std::function<void(Cdr&)>& handler, const std::function<void()>& meanwhile = [] {}) {
    bool came = false;
    return wait_until([&] {
      meanwhile();
      Message message;
      dds::SampleInfo info;
      while (!came &&
             reader_->take_next_sample(&message, &info) == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
        const rtps::SampleIdentity& about = info.related_sample_identity;
        const bool is_mine = about.writer_guid() == reader_->guid() || about.writer_guid() == writer_->guid();
        if (!info.valid_data || !is_mine || about.sequence_number() != number_) {
          ++foreign;
          continue;
        }
        eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(message.data()), message.size());
        Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
        cdr.read_encapsulation();
        handler(cdr);
        came = true;
      }
      return came;
    });
  }
  int foreign = 0;

 private:
  dds::Topic* topic(const std::string& name, const std::string& type) {
    return participant_.entity().create_topic(name, type, dds::TOPIC_QOS_DEFAULT);
  }
  Participant& participant_;
  std::string request_, answer_;
  dds::Publisher* publisher_;
  dds::DataReader* reader_;
  dds::DataWriter* writer_;
  rtps::SequenceNumber_t number_;
};

}  // namespace triskin::foreign
