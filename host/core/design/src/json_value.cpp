// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/json_value.hpp"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <set>
#include <vector>

#include "triskin/base/json_cause.hpp"

namespace triskin::design {
namespace {

// The parser is recursive, so the depth is limited before it runs.
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

// Remembers the keys of the open objects and refuses a repeated one.
struct RepeatedKey {
  std::string key;
};
class KeysOnce {
 public:
  bool operator()(int /*depth*/, nlohmann::json::parse_event_t event, nlohmann::json& value) {
    using Event = nlohmann::json::parse_event_t;
    if (event == Event::object_start) open_.emplace_back();
    if (event == Event::object_end) open_.pop_back();
    if (event == Event::key && !open_.back().insert(value.get<std::string>()).second)
      throw RepeatedKey{value.get<std::string>()};
    return true;
  }

 private:
  std::vector<std::set<std::string>> open_;
};

// Counts the lines that a parser has consumed.
class CountedText {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;
  CountedText(const char* at, std::size_t& lines) : at_(at), lines_(&lines) {}
  reference operator*() const { return *at_; }
  CountedText& operator++() {
    if (*at_++ == '\n') ++*lines_;
    return *this;
  }
  CountedText operator++(int) {
    const CountedText before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountedText& other) const { return at_ == other.at_; }
  bool operator!=(const CountedText& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  std::size_t* lines_;
};

// The parser does not say where it was when it found a repeated key or a huge number, so the text is parsed once more.
std::size_t line_of_failure(const std::string& text) {
  std::size_t line = 1;
  try {
    [[maybe_unused]] const nlohmann::json parsed =
        nlohmann::json::parse(CountedText(text.data(), line), CountedText(text.data() + text.size(), line), KeysOnce());
  } catch (const RepeatedKey&) {
    return line;
  } catch (const nlohmann::json::exception&) {
    return line;
  }
  return line;
}

// Scans JSON text without storing its values.
class JsonWalk {
 public:
  explicit JsonWalk(const std::string& text) : text_(text) { skip_space(); }
  [[nodiscard]] std::size_t line() const {
    return 1 +
           static_cast<std::size_t>(std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n'));
  }
  // Moves to the value of a key, or stays in place if there is no such key.
  bool enter(const std::string& key) {
    const std::size_t begin = at_;
    for (bool more = open('{'); more; more = next('}')) {
      const std::size_t key_begin = at_;
      skip_value();
      const bool found = text_.compare(key_begin, at_ - key_begin, '"' + key + '"') == 0;
      skip_space();
      if (at_ < text_.size()) ++at_;  // Here the scan skips the colon.
      skip_space();
      if (found) return true;
      skip_value();
    }
    at_ = begin;
    return false;
  }
  bool enter(std::size_t index) {
    const std::size_t begin = at_;
    for (bool more = open('['); more; more = next(']')) {
      if (index-- == 0) return true;
      skip_value();
    }
    at_ = begin;
    return false;
  }

 private:
  void skip_space() {
    while (at_ < text_.size() && (text_[at_] == ' ' || (text_[at_] >= '\t' && text_[at_] <= '\r'))) ++at_;
  }
  bool open(char bracket) {
    if (at_ >= text_.size() || text_[at_] != bracket) return false;
    ++at_;
    skip_space();
    return at_ < text_.size() && text_[at_] != '}' && text_[at_] != ']';
  }
  bool next(char end) {
    skip_space();
    if (at_ >= text_.size() || text_[at_] == end) return false;
    ++at_;  // Here the scan skips the comma.
    skip_space();
    return at_ < text_.size();
  }
  void skip_text() {
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\') ++at_;
    }
    if (at_ < text_.size()) ++at_;
  }
  void skip_value() {
    int depth = 0;
    do {
      const char c = at_ < text_.size() ? text_[at_] : '\0';
      if (c == '"') {
        skip_text();
      } else if (c == '{' || c == '[') {
        ++depth, ++at_;
      } else if (c == '}' || c == ']') {
        --depth, ++at_;
      } else if (depth > 0) {
        ++at_;
      } else {
        while (at_ < text_.size() && text_.find_first_of(",]}: \t\r\n", at_) != at_) ++at_;
      }
    } while (depth > 0 && at_ < text_.size());
  }

  const std::string& text_;
  std::size_t at_ = 0;
};

}  // namespace

std::size_t line_of(const std::string& text, const std::string& place) {
  JsonWalk walk(text);
  for (std::size_t k = 0; k < place.size();) {
    const std::size_t end = std::min(place.find_first_of(place[k] == '[' ? "]" : ".[", k), place.size());
    std::size_t index = 0;
    const bool in_list = place[k] == '[';
    // An unknown key may also contain brackets.
    if (in_list && std::from_chars(place.data() + k + 1, place.data() + end, index).ec != std::errc{}) break;
    if (!(in_list ? walk.enter(index) : walk.enter(place.substr(k, end - k)))) break;
    k = end;
    if (k < place.size() && (place[k] == ']' || place[k] == '.')) ++k;
    if (k < place.size() && place[k] == '.') ++k;
  }
  return walk.line();
}

// A repeated key is refused, because the parser would silently drop one of the two values.
nlohmann::json parse_json(const std::string& text, const std::string& file) {
  require_shallow(text, file);
  try {
    return nlohmann::json::parse(text, KeysOnce());
  } catch (const RepeatedKey& e) {
    throw InputError(
        fmt::format("{}:{}: key \"{}\" stands twice in one object; leave one out", file, line_of_failure(text), e.key));
  } catch (const nlohmann::json::parse_error& e) {
    throw InputError(fmt::format("{}: is not JSON: {}", file, json_cause(e.what())));
  } catch (const nlohmann::json::exception&) {
    throw InputError(fmt::format("{}:{}: is not JSON: a number is out of range", file, line_of_failure(text)));
  }
}

std::string JsonValue::text() const {
  if (!value_.is_string()) fail("must be a text");
  return value_.get<std::string>();
}

void require_format(const JsonValue& v, std::string_view wanted) {
  const std::string format = v["format"].text();
  if (format != wanted) v["format"].fail(fmt::format("is \"{}\", and this file must be \"{}\"", format, wanted));
}

}  // namespace triskin::design
