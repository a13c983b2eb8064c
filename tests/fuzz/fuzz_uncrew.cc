// A request of a drone: the number of its type, then the bytes of its message.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <variant>
#include <vector>

#include "schema/base/check.h"
#include "schema/base/utf8.h"
#include "schema/limits.h"
#include "schema/model/uncrew/fields.h"
#include "schema/uncrew/judge.h"
#include "schema/uncrew/limits.h"
#include "schema/uncrew/records.h"
#include "tests/fuzz/check_violation.h"

namespace {

namespace uc = uplink::model::uncrew;
using uplink::fuzz::CheckViolation;
using uplink::uncrew::Judgement;

/// What every field keeps to, whatever the input was.
struct Checking {
  template <typename T>
  void operator()(const T& value) const {
    if constexpr (uc::Listed<T>) {
      std::apply([&](const auto&... field) { ((*this)(value.*field.member), ...); },
                 uc::kFields<T>);
    } else if constexpr (std::is_floating_point_v<T>) {
      UPLINK_CHECK(std::isfinite(value), "a kept number is finite");
    }
  }
  void operator()(const std::string& text) const {
    UPLINK_CHECK(uplink::IsCleanUtf8(text), "a kept text is clean");
  }
  template <typename T>
  void operator()(const std::optional<T>& value) const {
    if (value) (*this)(*value);
  }
  template <typename T>
  void operator()(const std::vector<T>& items) const {
    UPLINK_CHECK(items.size() <= uplink::uncrew::kAlertsMax, "lists are bounded");
    for (const T& item : items) (*this)(item);
  }
};

/// Nothing that is stored is what another sample of the same says again.
void CheckRecords(const Judgement& judged) {
  const uc::SampleKind kind = uc::RowOf(judged.type).kind;
  const auto records = uplink::uncrew::Records::Of(judged, nullptr);
  UPLINK_CHECK(records.empty() || kind != uc::SampleKind::kLive, "live samples are not stored");
  if (uplink::uncrew::MemoryOf(judged.type, "x").empty()) return;
  UPLINK_CHECK(uplink::uncrew::Records::Of(judged, judged.value()).empty(), "no change, no record");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0 || data[0] == 0 || data[0] > uc::kTypeRows.size()) return 0;
  const std::string_view request(reinterpret_cast<const char*>(data + 1), size - 1);
  const Judgement judged = uplink::uncrew::Judge(static_cast<uc::SampleType>(data[0]), request);
  UPLINK_CHECK(judged.dropped.size() <= uplink::schema::kDroppedFieldsListedMax,
               "the listed fields are few");
  for (const auto& field : judged.dropped) CheckViolation(field);
  UPLINK_CHECK(uc::RowOf(judged.type).kind == uc::SampleKind::kLive || judged.dropped.empty(),
               "a durable sample is whole");
  if (judged.rejection() != nullptr) {
    CheckViolation(*judged.rejection());
    return 0;
  }
  UPLINK_CHECK(judged.decoded, "what is good was decoded");
  UPLINK_CHECK(TypeOf(*judged.value()) == judged.type, "a value has its type");
  std::visit(Checking(), *judged.value());
  CheckRecords(judged);
  return 0;
}
