#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "schema/cyberwave/families.h"
#include "schema/json/exact.h"
#include "schema/limits.h"
#include "schema/rules/describe.h"
#include "schema/rules/texts.h"

namespace uplink::cyberwave {
namespace {

namespace js = boost::json;
using model::cyberwave::Metric;
using model::cyberwave::Metrics;
using model::cyberwave::MetricValue;
using schema::Path;
using schema::Violations;

constexpr std::string_view kErrors = "errors";

/// The metrics of the vendor's page that are numbers; all others are free.
struct NumberName {
  std::string_view category;
  std::string_view name;
  bool percent = false;
};
constexpr std::array kNumbers = {
    NumberName{.category = "power", .name = "battery_percent", .percent = true},
    NumberName{.category = "power", .name = "voltage"},
    NumberName{.category = "power", .name = "estimated_runtime_minutes"},
    NumberName{.category = "navigation", .name = "distance_remaining_m"},
    NumberName{.category = "navigation", .name = "eta_seconds"},
};

/// Null for a metric that may be anything.
const NumberName* NumberNameOf(const Metric& metric) {
  const auto found = std::find_if(kNumbers.begin(), kNumbers.end(), [&](const NumberName& number) {
    return number.category == metric.category && number.name == metric.name;
  });
  return found == kNumbers.end() ? nullptr : found;
}

/// Collects the values of one message. Confined to one judgement.
class Collector final {
 public:
  explicit Collector(Violations& violations) : violations_(violations) {}

  [[nodiscard]] std::vector<Metric> Take() { return std::move(metrics_); }

  // The depth is that of the payload, which is bounded.
  // NOLINTNEXTLINE(misc-no-recursion): see above
  void Add(const js::value& value, const Path& path, std::string_view category,
           const std::string& name) {
    if (value.is_null() || violations_.rejected()) return;
    if (const js::object* object = value.if_object()) {
      for (const auto& member : *object) {
        const std::string_view key = FromBoost(member.key());
        const Path field = path.Key(key);
        Add(member.value(), field, category, Joined(name, key));
      }
    } else if (const js::array* items = value.if_array()) {
      for (std::size_t i = 0; i < items->size(); ++i) {
        const Path item = path.Item(i);
        Add((*items)[i], item, category, Joined(name, std::to_string(i)));
      }
    } else {
      AddScalar(value, path, category, name);
    }
  }

 private:
  /// Longer names than may be kept are not built: each level would copy those above it.
  static std::string Joined(const std::string& above, std::string_view name) {
    std::string joined = above.substr(0, schema::kNameBytesMax + 1);
    if (!joined.empty()) joined += '/';
    return joined.append(name);
  }

  void AddScalar(const js::value& value, const Path& path, std::string_view category,
                 const std::string& name) {
    if (++values_ > kMetricsMax) {
      const Path root;
      const Path all = root.Field("metrics");
      return violations_.Reject(schema::TooManyItems(all, values_, kMetricsMax, "values"));
    }
    const std::size_t bytes = category.size() + 1 + name.size();
    if (bytes > schema::kNameBytesMax) {
      return violations_.Content(schema::TextTooLong(path, bytes, schema::kNameBytesMax));
    }
    std::optional<std::string> kept_category =
        schema::Text(violations_, path, category, schema::kNameBytesMax);
    std::optional<std::string> kept_name =
        schema::Text(violations_, path, name, schema::kNameBytesMax);
    if (!kept_category || !kept_name) return;
    Metric metric = {
        .category = *std::move(kept_category), .name = *std::move(kept_name), .value = {}};
    std::optional<MetricValue> kept = ValueOf(value, path, NumberNameOf(metric));
    if (!kept) return;
    metric.value = *std::move(kept);
    metrics_.push_back(std::move(metric));
  }

  std::optional<MetricValue> ValueOf(const js::value& value, const Path& path,
                                     const NumberName* number) {
    if (number != nullptr || value.is_number()) {
      const std::optional<double> kept = NumberOf(violations_, path, value);
      if (!kept || number == nullptr || !number->percent) return kept;
      return PercentOf(violations_, path, *kept);
    }
    if (const bool* flag = value.if_bool()) return *flag;
    return schema::Text(violations_, path, FromBoost(value.get_string()),
                        schema::kMessageTextBytesMax);
  }

  Violations& violations_;
  std::vector<Metric> metrics_;
  std::size_t values_ = 0;
};

/// The durable part: what is wrong in it rejects, so that no fault is missed or cleared silently.
std::vector<std::string> ErrorsOf(Violations& violations, const Path& path,
                                  const js::array& items) {
  std::vector<std::string> errors;
  if (items.size() > kErrorsMax) {
    violations.Reject(schema::TooManyItems(path, items.size(), kErrorsMax, "errors"));
    return errors;
  }
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].is_null()) continue;
    const Path item = path.Item(i);
    const js::string* text = items[i].if_string();
    if (text == nullptr) {
      violations.Reject(schema::TypeMismatch(item, json::KindOf(items[i]), "string"));
      continue;
    }
    if (text->empty()) violations.Reject(schema::MissingField(item, "is empty"));
    const std::string_view said(text->data(), text->size());
    const schema::TextFinding found = schema::ReadText(item, said, schema::kMessageTextBytesMax);
    if (found.violation) {
      violations.Reject(*found.violation);
      continue;
    }
    errors.push_back(schema::KeptText(violations, said, found.controls));
  }
  return errors;
}

}  // namespace

Metrics ReadMetrics(Reader& in) {
  Metrics metrics;
  const js::object* object = in.Object("metrics", Need::kMust);
  if (object == nullptr) return metrics;
  const Path path = in.path().Field("metrics");
  Reader members(*object, path, in.violations());
  // Absent is no violation, but what is there must be a list.
  const Need need = members.Find(kErrors) == nullptr ? Need::kMay : Need::kMust;
  if (const js::array* errors = members.List(kErrors, need)) {
    const Path field = path.Field(kErrors);
    metrics.errors = ErrorsOf(in.violations(), field, *errors);
  }
  Collector collector(in.violations());
  for (const auto& member : *object) {
    const std::string_view category = FromBoost(member.key());
    if (category == kErrors) continue;
    const Path field = path.Key(category);
    collector.Add(member.value(), field, category, {});
  }
  metrics.metrics = collector.Take();
  if (metrics == Metrics()) in.violations().RejectIfAnyDropped();
  return metrics;
}

}  // namespace uplink::cyberwave
