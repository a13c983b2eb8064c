#include "schema/json/uncrew.h"

#include <optional>
#include <tuple>
#include <variant>
#include <vector>

#include "schema/base/rfc3339.h"
#include "schema/json/fields.h"
#include "schema/model/uncrew/fields.h"

namespace uplink::json {
namespace {

using boost::json::object;
namespace uc = model::uncrew;

template <uc::Listed Struct>
object ObjectOf(const Struct& body);

/// Adds one field, unless it says nothing; one overload for each sort of it.
struct Adding {
  Fields& to;
  std::string_view name;

  template <Scalar T>
  void operator()(const T& scalar) const {
    to.Set(name, scalar);
  }
  /// A time; 0: unknown.
  void operator()(std::int64_t unix_us) const {
    if (unix_us != 0) to.Set(name, unix_us);
  }
  void operator()(const std::string& text) const {
    if (!text.empty()) to.Set(name, text);
  }
  template <model::OpenEnum E>
  void operator()(E member) const {
    to.Set(name, model::EnumText(member));
  }
  void operator()(model::OperatorRequestKind kind) const {
    to.Set(name, std::string(ToText(kind)));
  }
  template <uc::Listed Struct>
  void operator()(const Struct& body) const {
    to.Set(name, ObjectOf(body));
  }
  void operator()(const std::vector<float>& values) const {
    if (!values.empty()) to.Set(name, ListOf(values, [](float value) { return Json(value); }));
  }
  template <typename T>
  void operator()(const std::optional<T>& value) const {
    if (value) (*this)(*value);
  }
  template <uc::Listed Struct>
  void operator()(const std::vector<Struct>& items) const {
    to.Set(name, ListOf(items, [](const Struct& item) { return ObjectOf(item); }));
  }
};

template <uc::Listed Struct>
object ObjectOf(const Struct& body) {
  Fields fields;
  std::apply(
      [&](const auto&... field) {
        (Adding{fields, field.name}(body.*field.member), ...);
      },
      uc::kFields<Struct>);
  return fields.Take();
}

template <uc::Listed Struct>
object Stamped(const Struct& body, const SampleTimes& times) {
  object stamped = ObjectOf(body);
  if (times.sampled_at_us != 0) stamped["sampledAt"] = Rfc3339OfUs(times.sampled_at_us);
  stamped["receivedAt"] = Rfc3339(times.received_at);
  return stamped;
}

const std::string& IdOf(const uc::Alert& alert) { return alert.alert_id; }
const std::string& IdOf(const uc::OperatorActionRequest& request) { return request.request_id; }

/// What a change of it is about; one overload for each type that is durable on change.
struct Changing {
  boost::json::value operator()(const uc::Armed& body) const {
    return body.is_armed ? boost::json::value(*body.is_armed) : boost::json::value();
  }
  boost::json::value operator()(const uc::FlightMode& body) const {
    return Json(model::EnumText(body.mode));
  }
  boost::json::value operator()(const uc::UncrewFlightMode& body) const { return Json(body.mode); }
  template <uc::Listed Struct>
  boost::json::value operator()(const Struct& body) const {
    return ObjectOf(body);
  }
};

}  // namespace

object Render(const uc::Value& value, const SampleTimes& times) {
  return std::visit(
      [&](const auto& body) {
        if constexpr (requires { body.items; }) {
          Fields by_id;
          for (const auto& item : body.items) by_id.Set(IdOf(item), Stamped(item, times));
          return by_id.Take();
        } else {
          return Stamped(body, times);
        }
      },
      value);
}

std::string Text(const uc::Value& value) {
  return boost::json::serialize(std::visit([](const auto& body) { return ObjectOf(body); }, value));
}

std::string ChangeText(const uc::Value* before, const uc::Value& now) {
  Fields fields;
  if (before != nullptr) fields.Set("from", std::visit(Changing(), *before));
  return boost::json::serialize(fields.Set("to", std::visit(Changing(), now)).Take());
}

}  // namespace uplink::json
