#include "schema/judge.h"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <utility>

#include "schema/decode/decode.h"
#include "schema/decode/message.h"
#include "schema/limits.h"
#include "schema/rules/describe.h"
#include "schema/rules/violations.h"

namespace uplink::schema {
namespace {

static_assert(JudgeLimits{}.message_bytes_max <= JudgeLimits{}.payload_bytes_max);
static_assert(kShapePositionsMax * 2 * kWordBytes < JudgeLimits{}.payload_bytes_max,
              "the largest shape must fit a payload");

/// True for the kinds that may be as large as payload_bytes_max.
bool MayBeLarge(model::Variant variant) {
  return variant == model::Variant::kShape || variant == model::Variant::kUiCapabilities ||
         variant == model::Variant::kCurrentSettings;
}

bool IsSignOfLife(model::Variant variant) {
  return variant == model::Variant::kMotionTelemetry || variant == model::Variant::kStatusTelemetry;
}

/// The union member's struct, read and judged; a null pointer in its place is a violation.
model::Body DecodeMember(wire::UplinkMsg::Reader in, model::Variant variant,
                         Violations& violations) {
  switch (variant) {
#define UPLINK_VARIANT(Member, name, Body, settling) \
  case model::Variant::k##Member:                    \
    if (!in.has##Member()) break;                    \
    return Decode##Member(in.get##Member(), violations);
    UPLINK_VARIANTS(UPLINK_VARIANT)
#undef UPLINK_VARIANT
  }
  violations.Reject(MissingField(Path(), "holds a null pointer"));
  return {};
}

Judgement Rejected(const Violation& violation, std::optional<model::Variant> variant = {}) {
  return {.verdict = violation.Describe(),
          .variant = variant,
          .sign_of_life = false,
          .times_unknown = 0,
          .enumerants_unrecognized = 0,
          .control_characters = 0};
}

}  // namespace

/// The aligned copy of the payload at hand, kept between calls while it is small, and texts whose
/// memory is free.
struct Judge::Scratch {
  kj::Array<capnp::word> words;
  SpareTexts texts;

  kj::ArrayPtr<const capnp::word> Copy(std::span<const std::byte> payload) {
    const std::size_t count = payload.size() / kWordBytes;
    if (words.size() < count) {
      words = kj::heapArray<capnp::word>(std::max(count, words.size() * 2));
    }
    std::memcpy(words.begin(), payload.data(), payload.size());
    return words.slice(0, count);
  }
  void Shrink() {
    if (words.size() * kWordBytes > kKeptBufferBytesMax) words = nullptr;
  }
};

Judge::Judge(const JudgeLimits& limits) : limits_(limits), scratch_(std::make_unique<Scratch>()) {}

Judge::~Judge() = default;

Judgement Judge::Payload(std::span<const std::byte> payload) {
  const std::size_t bytes_max = std::max(limits_.payload_bytes_max, limits_.message_bytes_max);
  if (payload.size() > bytes_max) return Rejected(PayloadTooLarge(payload.size(), bytes_max));
  const std::string_view framing_error = FramingError(payload);
  if (!framing_error.empty()) return Rejected(Malformed(framing_error));
  Judgement judgement = Message(payload);
  scratch_->Shrink();
  return judgement;
}

std::optional<model::Variant> Judge::VariantOf(std::span<const std::byte> payload) {
  if (payload.size() > limits_.message_bytes_max) return std::nullopt;
  if (!FramingError(payload).empty()) return std::nullopt;
  using Read = std::optional<model::Variant>;
  const auto read = [](capnp::FlatArrayMessageReader& reader) -> Read {
    const auto member = static_cast<unsigned>(reader.getRoot<wire::UplinkMsg>().which());
    if (member >= model::kVariants) return std::nullopt;
    return static_cast<model::Variant>(member);
  };
  const Read variant =
      ReadMessage(scratch_->Copy(payload), read, [](std::string_view) { return Read(); });
  scratch_->Shrink();
  return variant;
}

void Judge::Reuse(model::Record&& record) {
  if (auto* const status = std::get_if<model::StatusTelemetry>(&record.body_)) {
    if (status->status) scratch_->texts.Give(*std::move(status->status));
  }
}

Judgement Judge::Message(std::span<const std::byte> payload) {
  std::optional<model::Variant> variant;
  const kj::ArrayPtr<const capnp::word> words = scratch_->Copy(payload);
  const auto read = [&](capnp::FlatArrayMessageReader& reader) -> Judgement {
    const auto message = reader.getRoot<wire::UplinkMsg>();
    const auto member = static_cast<unsigned>(message.which());
    if (member >= model::kVariants) return Rejected(UnknownVariant(Path(), member));
    if (reader.getEnd() != words.end()) return Rejected(Malformed("bytes follow the message"));
    variant = static_cast<model::Variant>(member);
    Violations violations({.durable = model::IsDurable(*variant),
                           .spare = &scratch_->texts,
                           .extras_items_max = limits_.extras_items_max,
                           .texts = limits_.texts});
    const std::size_t bytes_max =
        MayBeLarge(*variant) ? limits_.payload_bytes_max : limits_.message_bytes_max;
    const bool too_large = payload.size() > bytes_max;
    if (too_large) violations.Reject(PayloadTooLarge(payload.size(), bytes_max));
    // A body is moved as little as can be: it is large.
    model::Body body = too_large ? model::Body() : DecodeMember(message, *variant, violations);
    return {.verdict = violations.rejected()
                           ? Verdict(violations.TakeRejection())
                           : Verdict(model::Record(std::move(body), violations.TakeDropped(),
                                                   violations.TakeUnlisted(), payload.size())),
            .variant = variant,
            .sign_of_life = IsSignOfLife(*variant),
            .times_unknown = violations.times_unknown(),
            .enumerants_unrecognized = violations.enumerants_unrecognized(),
            .control_characters = violations.control_characters()};
  };
  return ReadMessage(words, read,
                     [&](std::string_view why) { return Rejected(Malformed(why), variant); });
}

}  // namespace uplink::schema
