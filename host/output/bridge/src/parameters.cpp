// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/bridge/parameters.hpp"

#include <algorithm>
#include <functional>

#include "triskin/bridge/services.hpp"

namespace triskin::bridge {
namespace {

using recording::CdrReader;
using recording::CdrWriter;

// rcl_interfaces/msg/ParameterType
enum : std::uint8_t { kNotSet = 0, kBool = 1, kInteger = 2, kDouble = 3, kString = 4 };

std::uint8_t type_of(const Parameter* p) {
  return p == nullptr ? std::uint8_t{kNotSet} : static_cast<std::uint8_t>(kBool + p->value.index());
}

// rcl_interfaces/msg/ParameterValue: the type and a field for each type. A parameter that is not there is "not set".
void put_value(CdrWriter& w, const Parameter* p) {
  const auto or_none = [&]<class Value>(const Value& none) {
    const Value* value = p == nullptr ? nullptr : std::get_if<Value>(&p->value);
    return value == nullptr ? none : *value;
  };
  w.u8(type_of(p));
  w.u8(or_none(false) ? 1 : 0);
  w.u64(static_cast<std::uint64_t>(or_none(std::int64_t{0})));
  w.f64(or_none(0.0));
  w.text(or_none(std::string()));
  for (int array = 0; array < 5; ++array) w.count(0);  // of bytes, truth values, integers, numbers, texts
}

void pass_value(CdrReader& r) {
  const auto pass = [&](std::size_t bytes, auto read) {
    for (std::size_t n = r.count(bytes); n > 0 && r.ok(); --n) (void)read();
  };
  (void)r.u8();
  (void)r.u8();
  (void)r.u64();
  (void)r.f64();
  (void)r.text();
  pass(1, [&] { return r.u8(); });
  pass(1, [&] { return r.u8(); });
  pass(8, [&] { return r.u64(); });
  pass(8, [&] { return r.f64(); });
  pass(4, [&] { return r.text(); });
}

constexpr std::size_t kMinText_bytes = 4;

// Each request has names or parameters; what comes behind them is not needed.
struct Names {
  std::vector<std::string> names;
  void read(CdrReader& r) {
    for (std::size_t n = r.count(kMinText_bytes); n > 0 && r.ok(); --n) names.push_back(r.text());
  }
};
struct Prefixes : Names {
  std::uint64_t depth = 0;
  void read(CdrReader& r) {
    Names::read(r);
    depth = r.u64();
  }
};
struct Settings : Names {
  void read(CdrReader& r) {
    for (std::size_t n = r.count(kMinText_bytes); n > 0 && r.ok(); --n) {
      names.push_back(r.text());
      pass_value(r);
    }
  }
};
// The answer is written by who has the parameters.
struct Written {
  std::function<void(CdrWriter&)> put;
  void write(CdrWriter& w) const { put(w); }
};

#define TRISKIN_PARAMETER_SERVICE(Type, topic, Asked)                                      \
  struct Type {                                                                            \
    static constexpr std::string_view kName = "rcl_interfaces/srv/" #Type, kTopic = topic; \
    using Request = Asked;                                                                 \
    using Answer = Written;                                                                \
  };
TRISKIN_PARAMETER_SERVICE(DescribeParameters, "describe_parameters", Names)
TRISKIN_PARAMETER_SERVICE(GetParameterTypes, "get_parameter_types", Names)
TRISKIN_PARAMETER_SERVICE(GetParameters, "get_parameters", Names)
TRISKIN_PARAMETER_SERVICE(ListParameters, "list_parameters", Prefixes)
TRISKIN_PARAMETER_SERVICE(SetParameters, "set_parameters", Settings)
TRISKIN_PARAMETER_SERVICE(SetParametersAtomically, "set_parameters_atomically", Settings)
#undef TRISKIN_PARAMETER_SERVICE

// rcl_interfaces/msg/ParameterDescriptor from Humble to Kilted
void put_descriptor(CdrWriter& w, const std::string& name, const Parameter* p) {
  w.text(name);
  w.u8(type_of(p));
  w.text(p == nullptr ? "" : p->description);
  w.text("");  // no constraint in words
  w.u8(1);     // read only
  w.u8(0);     // of one type
  w.count(0);
  w.count(0);  // no ranges
}

void put_refusal(CdrWriter& w, const Parameter* p) {
  w.u8(0);
  w.text(p == nullptr ? "there is no such parameter"
                      : "fixed while the bridge runs; start it again with --ros-args -p " + p->name + ":=VALUE");
}

}  // namespace

struct ParameterServices::Impl {
  Impl(Domain& domain, std::vector<Parameter> all)
      : parameters(std::move(all)),
        describe(domain, "~"),
        types(domain, "~"),
        get(domain, "~"),
        list(domain, "~"),
        set(domain, "~"),
        set_atomically(domain, "~") {}

  [[nodiscard]] const Parameter* find(const std::string& name) const {
    const auto found = std::ranges::find(parameters, name, &Parameter::name);
    return found == parameters.end() ? nullptr : &*found;
  }
  // Answers every request with a list that has `put` for each of its names.
  template <class Type, class Put>
  void answer_each(Service<Type>& service, Put put) {
    while (const auto asked = service.take())
      service.answer(asked->id, {[&](CdrWriter& w) {
                       w.count(asked->request.names.size());
                       for (const std::string& name : asked->request.names) put(w, name, find(name));
                     }});
  }
  void step() {
    answer_each(describe, put_descriptor);
    answer_each(types, [](CdrWriter& w, const std::string&, const Parameter* p) { w.u8(type_of(p)); });
    answer_each(get, [](CdrWriter& w, const std::string&, const Parameter* p) { put_value(w, p); });
    answer_each(set, [](CdrWriter& w, const std::string&, const Parameter* p) { put_refusal(w, p); });
    while (const auto asked = set_atomically.take())
      set_atomically.answer(asked->id, {[&](CdrWriter& w) {
                              put_refusal(w,
                                          asked->request.names.empty() ? nullptr : find(asked->request.names.front()));
                            }});
    while (const auto asked = list.take())
      list.answer(asked->id, {[&](CdrWriter& w) {
                    std::vector<std::string> names;
                    for (const Parameter& p : parameters)
                      // No name has a ".", so a prefix is a whole name.
                      if (asked->request.names.empty() ||
                          std::ranges::find(asked->request.names, p.name) != asked->request.names.end())
                        names.push_back(p.name);
                    w.count(names.size());
                    for (const std::string& name : names) w.text(name);
                    w.count(0);  // prefixes
                  }});
  }

  std::vector<Parameter> parameters;
  Service<DescribeParameters> describe;
  Service<GetParameterTypes> types;
  Service<GetParameters> get;
  Service<ListParameters> list;
  Service<SetParameters> set;
  Service<SetParametersAtomically> set_atomically;
};

ParameterServices::ParameterServices(Domain& domain, std::vector<Parameter> parameters)
    : impl_(std::make_unique<Impl>(domain, std::move(parameters))) {}
ParameterServices::~ParameterServices() = default;
void ParameterServices::step() {
  impl_->step();
}

}  // namespace triskin::bridge
