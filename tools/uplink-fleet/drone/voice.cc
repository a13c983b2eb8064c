#include "tools/uplink-fleet/drone/voice.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <boost/json.hpp>
#include <fmt/core.h>
#include <google/protobuf/descriptor.h>
#include <google/protobuf/util/json_util.h>

#include "schema/base/check.h"
#include "schema/json/exact.h"
#include "tools/uplink-fleet/twin/filling.h"

namespace uplink::synthetic {
namespace {

constexpr std::int64_t kUsPerMs = 1'000;
/// A drone has been up since midnight (UTC), so that a second run soon after the first one is no
/// step back by less than kOlderMax of the server, which it takes for old samples.
constexpr std::int64_t kDayUs = 86'400'000'000;

std::unique_ptr<google::protobuf::Message> Empty(std::string_view type) {
  const std::string name = fmt::format("Publish{}Request", type);
  const auto* descriptor =
      ::uncrew::v1::PublishResponse::descriptor()->file()->FindMessageTypeByName(name);
  UPLINK_CHECK(descriptor != nullptr, name + " is of the contract");
  return std::unique_ptr<google::protobuf::Message>(
      google::protobuf::MessageFactory::generated_factory()->GetPrototype(descriptor)->New());
}

}  // namespace

void DroneVoice::SetNow(std::int64_t now_us) {
  now_us_ = std::max(now_us, now_us_ + kUsPerMs);
  if (boot_us_ == 0) boot_us_ = now_us_ - now_us_ % kDayUs;
}

AvatarDraft DroneVoice::Begin(std::string_view type, std::size_t line, std::string_view json,
                              Seeded& chance, std::uint32_t key) {
  SetNow(now_us_);
  AvatarDraft draft{.request = Empty(type),
                    .call = {.number = ++last_number_,
                             .line = line,
                             .method = fmt::format("Publish{}", type),
                             .request = {},
                             .live = false,
                             .due = {}},
                    .time_us = now_us_};
  std::optional<boost::json::value> words = json::ParseExact(json);
  UPLINK_CHECK(words.has_value(), "the words of a table are JSON");
  FillTexts(*words, chance, [&](const std::string& text) {
    return Replaced(Replaced(text, "{number}", fmt::format("{:032x}", draft.call.number)), "{key}",
                    std::to_string(key));
  });
  const auto read = google::protobuf::util::JsonStringToMessage(boost::json::serialize(*words),
                                                                draft.request.get());
  UPLINK_CHECK(read.ok(), read.ToString());
  const auto* field = draft.request->GetDescriptor()->FindFieldByName("metadata");
  auto& metadata = static_cast<::uncrew::v1::Metadata&>(
      *draft.request->GetReflection()->MutableMessage(draft.request.get(), field));
  // Every second drone names itself.
  if (options_.index % 2 == 1) metadata.set_uav_id(UavIdOf(options_.index));
  metadata.set_sampled_at_unix_us(draft.time_us);
  metadata.set_sampled_at_boot_us(static_cast<std::uint64_t>(draft.time_us - boot_us_));
  return draft;
}

AvatarCall DroneVoice::Finish(AvatarDraft draft) {
  draft.call.request = draft.request->SerializeAsString();
  return std::move(draft.call);
}

std::string DroneVoice::IdOf(std::string_view what, const AvatarDraft& draft) const {
  return fmt::format("{}.{}-{}", options_.run, what, draft.call.number);
}

}  // namespace uplink::synthetic
