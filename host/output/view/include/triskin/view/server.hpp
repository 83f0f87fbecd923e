// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "triskin/design/design.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/view/latest_samples.hpp"
#include "triskin/view/notes.hpp"

namespace triskin::view {

/// The server delivers the file under the name that is its key in a Site.
struct Document {
  std::string type;  ///< The type goes into the header Content-Type.
  std::string body;
};
/// Documents are found by name: "" is the start page, then "main.js", …
using Site = std::map<std::string, Document>;

/// A page sends these requests through its WebSocket.
struct Command {
  enum class Kind {
    kPress,  ///< The simulated finger presses a module, or one taxel.
    kLift,   ///< The simulated finger is lifted from wherever it presses.
    kRest,   ///< New rest values are taken, so nobody may touch the skin.
  };
  Kind kind = Kind::kLift;
  layout::SkinModule module{};  ///< kPress sets the module, ≥ 0; the receiver must check whether the design has it.
  /// kPress sets the taxel, 0 … 11; −1 presses the whole module.
  layout::TaxelIndex taxel = layout::TaxelIndex::none();
};

/// Serves a site and the live skin to browsers on this computer: HTTP and a WebSocket on 127.0.0.1, in its own thread.
/// A request is answered only with the token in its path, the right Host and, if it has one, the right Origin, so that
/// neither other users of the computer nor other pages in the browser can read the skin. docs/view.md has the
/// limits.
class Server {
 public:
  /// Each limit of the server is > 0. The defaults suit browsers on the same computer.
  struct Limits {
    std::size_t connections = 32;  ///< This many connections with the token are served; others get 503.
    /// This many connections may be open without the token; beyond that, the oldest is closed.
    std::size_t strangers = 32;
    std::size_t header_bytes = 8192;                   ///< The header of a request has at most this size.
    std::size_t message_bytes = 256;                   ///< A message from the page has at most this size.
    std::chrono::milliseconds request_time{5'000};     ///< A request must arrive completely within this time.
    std::chrono::milliseconds write_time{5'000};       ///< A reader must accept a frame or a document within this time.
    std::chrono::milliseconds frame_interval{33};      ///< Two frames to a page are this far apart.
    std::chrono::milliseconds health_interval{1'000};  ///< Two status messages are this far apart.
    int send_buffer_bytes = 1 << 18;                   ///< The kernel buffers this much for a live connection.
  };
  using OnCommand = std::function<void(const Command&)>;

  /// Starts to listen on 127.0.0.1; `port` 0 uses a free one. `live` must outlive the server. `on_command` is called in
  /// the server's thread and must neither block nor throw. Throws DeviceError when the port is not available.
  Server(Site site, const LatestSamples& live, std::uint16_t port, OnCommand on_command, const Limits& limits);
  /// Closes every connection and waits for the thread.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Returns the address of the page with its token: "http://127.0.0.1:PORT/TOKEN/".
  [[nodiscard]] std::string address() const;
  [[nodiscard]] std::uint16_t port() const;
  /// Returns 32 hexadecimal digits from the operating system's random numbers, new for each server.
  [[nodiscard]] std::string token() const;
  /// Returns whether a page has connected to the live skin since the start. Thread-safe.
  [[nodiscard]] bool had_page() const;
  /// Counts the open connections. Thread-safe.
  [[nodiscard]] std::size_t connections() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns the page's files, the model of a design and, if `track` is not empty, a recording (FrameTrack) that the page
/// plays instead of a live skin. Throws InputError when the program has no page.
[[nodiscard]] Site site_of(const design::Design& design, std::string track = {}, const Notes& notes = {});

}  // namespace triskin::view
