#include "schema/cyberwave/detail.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

#include "schema/base/utf8.h"
#include "schema/cyberwave/limits.h"
#include "schema/cyberwave/reader.h"
#include "schema/rules/describe.h"
#include "schema/rules/path.h"

namespace uplink::cyberwave {
namespace {

namespace js = boost::json;
using schema::Path;
using schema::Violations;

/// Goes through a value once. Confined to one judgement.
class Cleaner final {
 public:
  explicit Cleaner(Violations& violations) : violations_(violations) {}

  [[nodiscard]] std::size_t controls() const { return controls_; }

  // The depth is that of the payload, which is bounded.
  // NOLINTNEXTLINE(misc-no-recursion): see above
  void Object(js::object& object, const Path& path) {
    ++depth_;
    if (!KeysAreClean(object)) CleanKeys(object, path);
    for (auto& member : object) {
      const Path field = path.Key(FromBoost(member.key()));
      if (!Keep(member.value(), field)) member.value() = nullptr;
    }
    --depth_;
  }

 private:
  static bool KeysAreClean(const js::object& object) {
    return std::all_of(object.begin(), object.end(), [](const auto& member) {
      return CountControls(FromBoost(member.key())) == std::size_t{0};
    });
  }

  void CleanKeys(js::object& object, const Path& path) {
    js::object clean(object.storage());
    for (auto& member : object) {
      const std::string_view key = FromBoost(member.key());
      const std::optional<std::size_t> controls = CountControls(key);
      if (!controls) {
        const Path field = path.Key(key);
        violations_.Content(schema::TextNotUtf8(field, key));
        continue;
      }
      controls_ += *controls;
      clean.insert_or_assign(ToBoost(ReplaceControls(key, *controls)), std::move(member.value()));
    }
    object = std::move(clean);
  }

  // NOLINTNEXTLINE(misc-no-recursion): as Object
  void Items(js::array& items, const Path& path) {
    ++depth_;
    for (std::size_t i = 0; i < items.size(); ++i) {
      const Path item = path.Item(i);
      if (!Keep(items[i], item)) items[i] = nullptr;
    }
    --depth_;
  }

  // NOLINTNEXTLINE(misc-no-recursion): as Object
  bool KeepNested(js::value& value, const Path& path) {
    const bool shown = depth_ < kShownDepthMax;
    if (!shown && !violations_.durable()) {
      violations_.Content(schema::TooDeep(path, kShownDepthMax));
      return false;
    }
    if (js::object* object = value.if_object()) Object(*object, path);
    if (js::array* items = value.if_array()) Items(*items, path);
    // What lies deeper yet is part of that text.
    if (depth_ == kShownDepthMax) {
      const std::string text = js::serialize(value);
      value = js::string(ToBoost(text), value.storage());
    }
    return true;
  }

  // NOLINTNEXTLINE(misc-no-recursion): as Object
  bool Keep(js::value& value, const Path& path) {
    if (value.is_structured()) return KeepNested(value, path);
    if (js::string* text = value.if_string()) return KeepText(*text, path);
    const double* number = value.if_double();
    return number == nullptr || schema::Finite(violations_, path, *number).has_value();
  }

  bool KeepText(js::string& text, const Path& path) {
    const std::string_view said(text.data(), text.size());
    const std::optional<std::size_t> controls = CountControls(said);
    if (!controls) {
      violations_.Content(schema::TextNotUtf8(path, said));
      return false;
    }
    controls_ += *controls;
    if (*controls > 0) text = ToBoost(ReplaceControls(said, *controls));
    return true;
  }

  Violations& violations_;
  std::size_t controls_ = 0;
  /// Of the object or list that is gone through.
  std::size_t depth_ = 0;
};

std::string Cleaned(js::object& object, const Path& path, Violations& violations) {
  Cleaner cleaner(violations);
  cleaner.Object(object, path);
  // Those of members that were read by their own rules are among them, and counted.
  const std::size_t counted = violations.control_characters();
  if (cleaner.controls() > counted) violations.CountControls(cleaner.controls() - counted);
  return violations.rejected() ? std::string() : js::serialize(object);
}

}  // namespace

std::string DetailOf(js::object& object, Violations& violations) {
  return Cleaned(object, Path(), violations);
}

std::string DetailIn(js::object& object, std::string_view name, Violations& violations) {
  js::value* value = object.if_contains(ToBoost(name));
  js::object* inner = value == nullptr ? nullptr : value->if_object();
  if (inner == nullptr) return "{}";
  const Path root;
  const Path field = root.Field(name);
  return Cleaned(*inner, field, violations);
}

}  // namespace uplink::cyberwave
