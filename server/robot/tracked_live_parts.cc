#include "server/robot/tracked_live_parts.h"

#include <optional>
#include <type_traits>
#include <utility>

#include "schema/base/check.h"

namespace uplink::robot {
namespace {

/// Takes over values of the earlier part that have no newer ones. True if the store then has
/// neither side completely.
template <typename Message>
bool Merge(std::optional<Message>& part, std::optional<Message>&& before) {
  if (!part) part = std::move(before);
  return false;
}

template <typename Value, std::size_t kMax>
bool Merge(KeyedPart<Value, kMax>& part, KeyedPart<Value, kMax>&& before) {
  const bool both = !part.items().empty() && !before.items().empty();
  part.PutOnTopOf(std::move(before));
  return both;
}

}  // namespace

std::size_t TrackedLiveParts::Put(model::Body&& body, SteadyTime arrived) {
  const std::optional<storage::LivePart> part = PartOfVariant(model::VariantOf(body));
  UPLINK_CHECK(part.has_value(), "only live kinds are applied");
  const std::size_t gone = PutInto(parts_, std::move(body), arrived);
  NoteChanged(*part);
  return gone;
}

void TrackedLiveParts::Put(model::RcanState&& state) {
  parts_.rcan = std::move(state);
  NoteChanged(storage::LivePart::kRcan);
}

void TrackedLiveParts::Restore(LiveParts&& before) {
  ++changes_;
  ForEachPart(
      [this]<typename Tag>(Tag /*row*/, auto& part, auto& earlier) {
        if (dropped_.test(Tag::kIndex)) {
          changed_.set(Tag::kIndex);
          return;
        }
        if (Merge(part, std::move(earlier))) changed_.set(Tag::kIndex);
        Count(Tag::kLivePart);
      },
      parts_, before);
}

void TrackedLiveParts::Drop(storage::LivePart part) {
  ForEachPart(
      [part]<typename Tag>(Tag /*row*/, auto& each) {
        if (Tag::kLivePart == part) each = std::remove_reference_t<decltype(each)>();
      },
      parts_);
  dropped_.set(static_cast<std::size_t>(part));
  NoteChanged(part);
}

void TrackedLiveParts::Clear() {
  ++changes_;
  parts_ = {};
  changed_.reset();
  dropped_.reset();
  part_bytes_ = {};
  share_.Set(0);
}

void TrackedLiveParts::NoteChanged(storage::LivePart part) {
  changed_.set(static_cast<std::size_t>(part));
  ++changes_;
  Count(part);
}

void TrackedLiveParts::Count(storage::LivePart part) {
  std::size_t& bytes = part_bytes_[static_cast<std::size_t>(part)];
  const std::size_t others = share_.bytes() - bytes;
  bytes = HeldBytes(parts_, part);
  share_.Set(others + bytes);
}

}  // namespace uplink::robot
