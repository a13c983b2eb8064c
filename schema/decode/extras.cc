#include <string_view>
#include <unordered_map>
#include <utility>

#include "schema/decode/decode.h"
#include "schema/decode/fields.h"
#include "schema/limits.h"
#include "schema/rules/numbers.h"
#include "schema/rules/texts.h"

namespace uplink::schema {
namespace {

/// Below this many readings a look through them is faster than an index.
constexpr std::size_t kScanMax = 16;

std::optional<model::SensorReading> DecodeReading(wire::SensorReading::Reader in, const Path& path,
                                                  Violations& violations) {
  const std::string_view key = View(in.getKey());
  if (key.empty()) {
    violations.Content(MissingField(path.Field("key"), "is empty"));
    return std::nullopt;
  }
  auto kept_key = Text(violations, path.Field("key"), key, kIdBytesMax);
  if (!kept_key) return std::nullopt;
  const Path value_path = path.Field("value");
  if (!in.hasValue()) {
    violations.Content(MissingField(value_path, "is a null pointer"));
    return std::nullopt;
  }
  auto value = JudgeValue(violations, value_path, in.getValue());
  if (!value) return std::nullopt;
  model::SensorReading out{
      .key = *std::move(kept_key), .value = *std::move(value), .unix_time_ms = {}};
  if (in.getHasUnixTimeMs()) out.unix_time_ms = Time(violations, in.getUnixTimeMs());
  return out;
}

/// Readings with unique keys: of two with one key the later wins.
class Readings {
 public:
  explicit Readings(std::size_t items) : indexed_(items > kScanMax) {
    kept_.reserve(items);  // keeps the index's views alive, too
  }

  void Put(model::SensorReading reading) {
    model::SensorReading* same = Find(reading.key);
    if (same != nullptr) {
      same->value = std::move(reading.value);
      same->unix_time_ms = reading.unix_time_ms;
      return;
    }
    kept_.push_back(std::move(reading));
    if (indexed_) by_key_.emplace(kept_.back().key, &kept_.back());
  }

  [[nodiscard]] std::vector<model::SensorReading> Take() { return std::move(kept_); }

 private:
  model::SensorReading* Find(std::string_view key) {
    if (indexed_) {
      const auto found = by_key_.find(key);
      return found == by_key_.end() ? nullptr : found->second;
    }
    for (model::SensorReading& reading : kept_) {
      if (reading.key == key) return &reading;
    }
    return nullptr;
  }

  bool indexed_;
  std::vector<model::SensorReading> kept_;
  std::unordered_map<std::string_view, model::SensorReading*> by_key_;
};

}  // namespace

model::TelemetryExtras DecodeTelemetryExtras(wire::TelemetryExtras::Reader in,
                                             Violations& violations) {
  const Path root;
  const Path kv_path = root.Field("kv");
  model::TelemetryExtras out;
  out.unix_time_ms = Time(violations, in.getUnixTimeMs());
  const auto kv = in.getKv();
  if (kv.size() > violations.extras_items_max()) {
    violations.Reject(TooManyItems(kv_path, kv.size(), violations.extras_items_max(), "readings"));
    return out;
  }
  Readings readings(kv.size());
  for (unsigned i = 0; i < kv.size(); ++i) {
    if (auto reading = DecodeReading(kv[i], kv_path.Item(i), violations)) {
      readings.Put(*std::move(reading));
    }
  }
  out.kv = readings.Take();
  if (out.kv.empty()) violations.RejectIfAnyDropped();
  return out;
}

}  // namespace uplink::schema
