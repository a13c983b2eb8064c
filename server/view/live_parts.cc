#include "server/view/live_parts.h"

#include <optional>
#include <string>

#include "schema/base/rfc3339.h"
#include "schema/json/fields.h"
#include "schema/json/render.h"

namespace uplink::view {
namespace {

using json::Fields;
using json::Render;

boost::json::object RenderItem(const robot::Extra& extra) {
  Fields fields;
  fields.Set("value", Render(extra.value));
  if (extra.sampled_at_ms != 0) {
    fields.Set("sampledAt", Rfc3339(FromUnixMs(extra.sampled_at_ms)));
  }
  return fields.Take();
}

template <typename Message>
boost::json::object RenderItem(const Message& message) {
  return Render(message);
}

// One overload for each type of part; nothing if the part was never reported.
template <typename Message>
std::optional<boost::json::object> RenderPart(const std::optional<Message>& part,
                                              const std::string& /*ruri*/) {
  if (!part) return std::nullopt;
  return Render(*part);
}

/// The robot's state, and the server's own count of the sequence numbers that were skipped.
std::optional<boost::json::object> RenderPart(const std::optional<model::RcanState>& part,
                                              const std::string& ruri) {
  if (!part) return std::nullopt;
  boost::json::object fields = Render(*part, ruri);
  fields["seq_missing"] = part->seq_missing;
  return fields;
}

/// An object with one member for each key.
template <typename Value, std::size_t kMax>
std::optional<boost::json::object> RenderPart(const robot::KeyedPart<Value, kMax>& part,
                                              const std::string& /*ruri*/) {
  if (part.items().empty()) return std::nullopt;
  Fields fields;
  for (const auto& [key, value] : part.items()) fields.Set(key, RenderItem(value));
  return fields.Take();
}

}  // namespace

void AddLiveParts(const robot::LiveParts& live, const PartSet& wanted, const std::string& ruri,
                  TextMembers& texts) {
  robot::ForEachPart(
      [&]<typename Tag>(Tag /*row*/, const auto& part) {
        if (!wanted.Has(ToPart(Tag::kLivePart))) return;
        const std::optional<boost::json::object> value = RenderPart(part, ruri);
        if (value) texts.Add(storage::RowOf(Tag::kLivePart).view, *value);
      },
      live);
}

}  // namespace uplink::view
