// SPDX-License-Identifier: GPL-3.0-or-later
#include "xml_reader.hpp"

#include <expat.h>
#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <tuple>
#include <type_traits>

#include "triskin/base/error.hpp"
#include "triskin/base/lower_case.hpp"
#include "triskin/base/xml_depth.hpp"

namespace triskin::mesh {
namespace {

constexpr char kSeparator = '\n';  // A URI of a namespace cannot contain a line feed.

std::pair<std::string_view, std::string_view> split(std::string_view full) {
  const std::size_t at = full.rfind(kSeparator);
  if (at == std::string_view::npos) return {{}, full};
  return {full.substr(0, at), full.substr(at + 1)};
}

// Text that was converted from UTF-16 to UTF-8 still declares its old encoding.
bool was_utf16(std::string_view bytes) {
  const std::string head = lower_case(bytes.substr(0, std::min<std::size_t>(bytes.find("?>"), 200)));
  return head.starts_with("<?xml") && head.find("utf-16") != std::string::npos;
}

// The library calls C functions, and no exception may leave them.
class Parse {
 public:
  Parse(const std::string& name, const XmlHandler& handler, const char* encoding)
      : name_(name), handler_(handler), parser_(XML_ParserCreateNS(encoding, kSeparator), &XML_ParserFree) {
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* self, const char* tag, const char** list) { static_cast<Parse*>(self)->start(tag, list); },
        [](void* self, const char* tag) { static_cast<Parse*>(self)->end(tag); });
    XML_SetCharacterDataHandler(parser_.get(), [](void* self, const char* text, int length) {
      static_cast<Parse*>(self)->text({text, static_cast<std::size_t>(length)});
    });
    XML_SetStartNamespaceDeclHandler(parser_.get(), [](void* self, const char* prefix, const char* uri) {
      static_cast<Parse*>(self)->declare(prefix, uri);
    });
  }

  void run(std::string_view bytes) {
    // The library counts bytes in int, so large texts are passed in pieces.
    constexpr std::size_t kPiece = std::size_t{1} << 24;
    for (std::size_t at = 0;; at += kPiece) {
      const std::string_view piece = bytes.substr(std::min(at, bytes.size()), kPiece);
      const bool is_last = at + kPiece >= bytes.size();
      const XML_Status status = XML_Parse(parser_.get(), piece.data(), static_cast<int>(piece.size()), is_last ? 1 : 0);
      if (thrown_ != nullptr) std::rethrow_exception(thrown_);
      if (status != XML_STATUS_OK) fail();
      if (is_last) return;
    }
  }

 private:
  [[nodiscard]] long line() const { return static_cast<long>(XML_GetCurrentLineNumber(parser_.get())); }

  [[noreturn]] void fail() const {
    const auto says = [&](const char* what) {
      throw InputError(fmt::format("{}, line {}: {}; repair or export it again", name_, line(), what));
    };
    switch (XML_GetErrorCode(parser_.get())) {
      case XML_ERROR_NO_ELEMENTS:
      case XML_ERROR_UNCLOSED_TOKEN:
      case XML_ERROR_UNCLOSED_CDATA_SECTION:
      case XML_ERROR_PARTIAL_CHAR:
        says("the file ends in the middle of its XML: it was cut");
        break;
      case XML_ERROR_TAG_MISMATCH:
        says("a tag of its XML is closed by another one");
        break;
      case XML_ERROR_JUNK_AFTER_DOC_ELEMENT:
        says("more follows behind the end of its XML");
        break;
      case XML_ERROR_UNKNOWN_ENCODING:
      case XML_ERROR_INCORRECT_ENCODING:
        says("its XML is in another encoding than UTF-8 or UTF-16, or than it says");
        break;
      case XML_ERROR_UNBOUND_PREFIX:
        says("a prefix in its XML has no namespace");
        break;
      case XML_ERROR_UNDEFINED_ENTITY:
        says("its XML has an entity that is not defined");
        break;
      case XML_ERROR_DUPLICATE_ATTRIBUTE:
        says("a tag of its XML has an attribute twice");
        break;
      default:
        says("it is not well-formed XML");
    }
    throw InputError(name_);  // Never reached, because says() throws.
  }

  template <class Call>
  void guarded(Call call) {
    if (thrown_ != nullptr) return;
    try {
      call();
    } catch (...) {
      thrown_ = std::current_exception();
      XML_StopParser(parser_.get(), XML_FALSE);
    }
  }
  void start(const char* full, const char** list) {
    guarded([&] {
      if (++depth_ > kMaxXmlDepth) fail_too_deep(name_, line());
      if (!handler_.start) return;
      XmlTag tag;
      std::tie(tag.space, tag.name) = split(full);
      tag.line = line();
      for (; *list != nullptr; list += 2) tag.attributes.emplace_back(list[0], list[1]);
      handler_.start(tag);
    });
  }
  void end(const char* full) {
    guarded([&] {
      --depth_;
      const auto [space, name] = split(full);
      if (handler_.end) handler_.end(space, name);
    });
  }
  void text(std::string_view piece) {
    guarded([&] {
      if (handler_.text) handler_.text(piece);
    });
  }
  void declare(const char* prefix, const char* uri) {
    guarded([&] {
      if (handler_.declare) handler_.declare(prefix == nullptr ? "" : prefix, uri == nullptr ? "" : uri);
    });
  }

  const std::string& name_;
  const XmlHandler& handler_;
  std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser_;
  std::exception_ptr thrown_;
  int depth_ = 0;
};

}  // namespace

std::string_view XmlTag::attribute(std::string_view wanted, std::string_view in_space) const {
  for (const auto& [full, value] : attributes) {
    const auto [uri, local] = split(full);
    if (local == wanted && uri == in_space) return value;
  }
  return {};
}

void parse_xml(std::string_view bytes, const std::string& name, const XmlHandler& handler) {
  Parse(name, handler, was_utf16(bytes) ? "UTF-8" : nullptr).run(bytes);
}

}  // namespace triskin::mesh
