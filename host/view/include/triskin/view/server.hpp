// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "triskin/design/calibration.hpp"
#include "triskin/design/design.hpp"
#include "triskin/view/live_skin.hpp"
#include "triskin/view/notes.hpp"

namespace triskin::view {

/// A file that the server gives out.
struct Document {
  std::string type;  ///< It goes into the header Content-Type.
  std::string body;
};
/// Documents by name: "" is the start page, "main.js", …
using Site = std::map<std::string, Document>;

/// What a page asks for.
struct Command {
  enum class Kind {
    kPress,  ///< The simulated finger presses a module, or one taxel.
    kLift,   ///< The simulated finger is lifted.
    kRest,   ///< Rest values are taken anew.
  };
  Kind kind = Kind::kLift;
  int module = 0;  ///< kPress has it, ≥ 0; whether the design has the module is for the receiver to check.
  int taxel = -1;  ///< kPress has it, 0 … 11; −1 presses the whole module.
};

/// Serves a site and the live skin to browsers on this computer: HTTP and a WebSocket on 127.0.0.1, in its own thread.
/// A request is answered only with the token in its path, the right Host and, where there is one, the right Origin; so
/// neither other users of the computer nor other pages of the browser read the skin. docs/view_server.md has the
/// limits.
class Server {
 public:
  /// Limits; each > 0. The defaults suit browsers on the same computer.
  struct Limits {
    std::size_t connections = 32;                      ///< connections that have shown the token; others get 503
    std::size_t strangers = 32;                        ///< connections that have not; beyond it the oldest is closed
    std::size_t header_bytes = 8192;                   ///< The header of a request has this size at most.
    std::size_t message_bytes = 256;                   ///< A message from the page has this size at most.
    std::chrono::milliseconds request_time{5'000};     ///< A request must arrive in full within this time.
    std::chrono::milliseconds write_time{5'000};       ///< A reader must take a frame or a document within this time.
    std::chrono::milliseconds frame_interval{33};      ///< Two frames to a page are this far apart.
    std::chrono::milliseconds health_interval{1'000};  ///< Two status messages are this far apart.
    int send_buffer_bytes = 1 << 18;                   ///< The kernel buffers so much for a live connection.
  };
  using OnCommand = std::function<void(const Command&)>;

  /// Starts to listen on 127.0.0.1. `port`: 0 takes a free one. `live` outlives the server. `on_command` is called in
  /// the server's thread and must not block or throw. Throws DeviceError when the port cannot be had.
  Server(Site site, const LiveSkin& live, std::uint16_t port, OnCommand on_command, const Limits& limits);
  /// Closes every connection and waits for the thread.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Address of the page with its token: "http://127.0.0.1:PORT/TOKEN/".
  [[nodiscard]] std::string address() const;
  [[nodiscard]] std::uint16_t port() const;
  /// 32 hexadecimal digits from the operating system's random numbers, new for each server.
  [[nodiscard]] std::string token() const;
  /// Connections that are open now. Thread-safe.
  [[nodiscard]] std::size_t connections() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The page's files, the model of a design and, where `track` is not empty, a recording (FrameTrack) that the page
/// plays instead of a live skin. Throws InputError when the program has no page.
[[nodiscard]] Site site_of(const design::Design& design, std::string track = {},
                           const design::SkinCalibration& calibration = {}, const Notes& notes = {});

}  // namespace triskin::view
