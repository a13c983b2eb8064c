#include "server/mqtt/wire.h"

#include <algorithm>
#include <utility>

namespace uplink::mqtt {
namespace {

constexpr std::size_t kDigitsMax = 4;

}  // namespace

Wire::Step Wire::Take(std::string_view bytes) {
  if (std::exchange(given_, false)) kept_.clear();
  switch (part_) {
    case Part::kFirst:
    case Part::kLength:
      return TakeFixedHeader(bytes);
    case Part::kHead:
      return TakeRest(bytes);
    case Part::kBody:
      return TakeBody(bytes, 0);
    case Part::kPast:
      return TakePast(bytes, 0);
    case Part::kBroken:
      return {0, fault_};
  }
  return {0, fault_};
}

Wire::Step Wire::TakeFixedHeader(std::string_view bytes) {
  std::size_t taken = 0;
  for (const char each : bytes) {
    const auto byte = static_cast<std::uint8_t>(each);
    ++taken;
    if (part_ == Part::kFirst) {
      fixed_ = {.first = byte};
      digits_ = 0;
      part_ = Part::kLength;
      continue;
    }
    fixed_.remaining |= (byte & 0x7FU) << (7U * digits_++);
    if ((byte & 0x80U) != 0) {
      if (digits_ < kDigitsMax) continue;
      return Break({EndReason::kMalformed, "a remaining length with five digits"}, taken);
    }
    if (const auto fault = CheckFixedHeader(version_, fixed_)) return Break(*fault, taken);
    part_ = Part::kHead;
    const bool is_qos1 = fixed_.is_publish() && fixed_.qos() == Qos::kAtLeastOnce;
    return {taken, Opened{is_qos1}};
  }
  return {taken, More{}};
}

Wire::Step Wire::TakeRest(std::string_view bytes) {
  if (kept_.empty() && bytes.size() >= fixed_.remaining) {
    return Whole(bytes.substr(0, fixed_.remaining), fixed_.remaining);
  }
  if (fixed_.is_publish()) return TakeHead(bytes, 0);
  part_ = Part::kBody;
  return TakeBody(bytes, 0);
}

Wire::Step Wire::TakeHead(std::string_view bytes, std::size_t before) {
  // While more of the head has arrived than its known extent, that shows a longer one.
  while (true) {
    const auto found = ExtentOfHead(version_, fixed_, kept_);
    if (const auto* fault = std::get_if<Fault>(&found)) return Break(*fault, before);
    const auto& extent = std::get<HeadExtent>(found);
    const std::size_t missing = extent.bytes - std::min(extent.bytes, kept_.size());
    if (missing == 0 && extent.known) {
      head_ = extent;
      break;
    }
    const std::string_view next = bytes.substr(0, missing);
    kept_.append(next);
    bytes.remove_prefix(next.size());
    before += next.size();
    if (next.size() < missing) return {before, More{}};
  }
  past_bytes_ = fixed_.remaining - kept_.size();
  part_ = IsWanted(head_) ? Part::kBody : Part::kPast;
  return part_ == Part::kPast ? TakePast(bytes, before) : TakeBody(bytes, before);
}

Wire::Step Wire::TakeBody(std::string_view bytes, std::size_t before) {
  const std::string_view next = bytes.substr(0, fixed_.remaining - kept_.size());
  kept_.append(next);
  if (kept_.size() < fixed_.remaining) return {before + next.size(), More{}};
  return Whole(kept_, before + next.size());
}

Wire::Step Wire::TakePast(std::string_view bytes, std::size_t before) {
  const std::size_t next = std::min(bytes.size(), past_bytes_);
  past_bytes_ -= next;
  if (past_bytes_ > 0) return {before + next, More{}};
  return WholePublish(kept_, head_, before + next);
}

Wire::Step Wire::Whole(std::string_view rest, std::size_t taken) {
  if (fixed_.is_publish()) {
    const auto found = ExtentOfHead(version_, fixed_, rest);
    if (const auto* fault = std::get_if<Fault>(&found)) return Break(*fault, taken);
    return WholePublish(rest, std::get<HeadExtent>(found), taken);
  }
  auto packet = DecodeAnswer(version_, fixed_, rest);
  if (const auto* fault = std::get_if<Fault>(&packet)) return Break(*fault, taken);
  part_ = Part::kFirst;
  given_ = true;
  return {taken, std::get<Packet>(packet)};
}

bool Wire::IsWanted(const HeadExtent& head) const {
  return !head.too_large && fixed_.remaining - head.bytes <= payload_bytes_max_;
}

Wire::Step Wire::WholePublish(std::string_view rest, const HeadExtent& head, std::size_t taken) {
  auto found = DecodePublishHead(version_, fixed_, head, rest.substr(0, head.bytes));
  if (const auto* fault = std::get_if<Fault>(&found)) return Break(*fault, taken);
  auto& message = std::get<Publish>(found);
  message.payload_bytes = fixed_.remaining - (head.too_large ? 0 : head.bytes);
  if (IsWanted(head)) message.payload = rest.substr(head.bytes);
  part_ = Part::kFirst;
  given_ = true;
  return {taken, Packet(message)};
}

Wire::Step Wire::Break(const Fault& fault, std::size_t taken) {
  part_ = Part::kBroken;
  fault_ = fault;
  return {taken, fault};
}

}  // namespace uplink::mqtt
