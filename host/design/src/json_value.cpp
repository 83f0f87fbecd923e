// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/json_value.hpp"

#include <set>
#include <vector>

#include "triskin/base/json_cause.hpp"

namespace triskin::design {
namespace {

// The parser recurses: the depth is bounded before it does.
void require_shallow(const std::string& text, const std::string& file) {
  int depth = 0;
  bool in_text = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (in_text) {
      if (c == '\\') ++k;
      if (c == '"') in_text = false;
    } else if (c == '"') {
      in_text = true;
    } else if (c == '[' || c == '{') {
      if (++depth > 64) throw InputError(fmt::format("{}: nested deeper than 64", file));
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
}

// Keeps the keys of the objects that are open, and refuses one that comes again.
class KeysOnce {
 public:
  explicit KeysOnce(const std::string& file) : file_(file) {}
  bool operator()(int /*depth*/, nlohmann::json::parse_event_t event, nlohmann::json& value) {
    using Event = nlohmann::json::parse_event_t;
    if (event == Event::object_start) open_.emplace_back();
    if (event == Event::object_end) open_.pop_back();
    if (event == Event::key && !open_.back().insert(value.get<std::string>()).second)
      throw InputError(
          fmt::format("{}: key \"{}\" stands twice in one object; leave one out", file_, value.get<std::string>()));
    return true;
  }

 private:
  const std::string& file_;
  std::vector<std::set<std::string>> open_;
};

}  // namespace

// A key that stands twice is refused: one of the two would be dropped without a word.
nlohmann::json parse_json(const std::string& text, const std::string& file) {
  require_shallow(text, file);
  try {
    return nlohmann::json::parse(text, KeysOnce(file));
  } catch (const nlohmann::json::parse_error& e) {
    throw InputError(fmt::format("{}: is not JSON: {}", file, json_cause(e.what())));
  } catch (const nlohmann::json::exception&) {
    throw InputError(fmt::format("{}: is not JSON: a number is out of range", file));
  }
}

}  // namespace triskin::design
