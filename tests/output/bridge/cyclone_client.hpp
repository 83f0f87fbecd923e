// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "reader.hpp"

namespace triskin::bridge {

/// Acts as a client of rmw_cyclonedds: reader and writer announce one client id, and its number and that of the request
/// stand before the message (rmw_cyclonedds_cpp/src/serdata.hpp).
template <class Request, class Answer>
class Client {
 public:
  Client(dds_entity_t participant, const std::string& service, const dds_topic_descriptor_t& request,
         const dds_topic_descriptor_t& answer)
      : id_(next_id()), answers_(participant, answer, ("rr" + service + "Reply").c_str(), true, false, id_) {
    dds_qos_t* qos = dds_create_qos();
    dds_qset_userdata(qos, id_.data(), id_.size());
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 10);
    const std::string topic = "rq" + service + "Request";
    writer_ = dds_create_writer(participant, dds_create_topic(participant, &request, topic.c_str(), nullptr, nullptr),
                                qos, nullptr);
    dds_delete_qos(qos);
    EXPECT_GT(writer_, 0);
    dds_get_instance_handle(writer_, &me_);
  }
  [[nodiscard]] bool matched() const {
    dds_publication_matched_status_t status{};
    return answers_.matched() && dds_get_publication_matched_status(writer_, &status) == DDS_RETCODE_OK &&
           status.current_count > 0;
  }
  void send(Request request) {
    request.client = me_;
    request.number = ++number_;
    EXPECT_EQ(dds_write(writer_, &request), DDS_RETCODE_OK);
  }
  /// Passes answers to the latest request to `handler` and counts the others.
  bool wait(const std::function<void(const Answer&)>& handler, const std::function<void()>& meanwhile = [] {}) {
    bool came = false;
    return wait_until([&] {
      meanwhile();
      answers_.take([&](const Answer& a) {
        came = a.client == me_ && a.number == number_;
        came ? handler(a) : static_cast<void>(++foreign);
      });
      return came;
    });
  }
  /// Returns the user data of the server's reader.
  [[nodiscard]] std::string server_id() const {
    dds_instance_handle_t reader = 0;
    if (dds_get_matched_subscriptions(writer_, &reader, 1) != 1) return "no reader";
    return user_data_of(dds_get_matched_subscription_data(writer_, reader));
  }
  [[nodiscard]] const Reader<Answer>& answers() const { return answers_; }
  int foreign = 0;

 private:
  // Sixteen bytes in hexadecimal, the first with two digits.
  static std::string next_id() {
    static int clients = 0;
    return "clientid=0a.b.c.d.e.f.10.11.12.13.14.15." + std::to_string(::getpid() % 90 + 10) + ".17.18." +
           std::to_string(++clients) + ";";
  }
  std::string id_;
  Reader<Answer> answers_;
  dds_entity_t writer_ = 0;
  dds_instance_handle_t me_ = 0;
  std::int64_t number_ = 100;
};

}  // namespace triskin::bridge
