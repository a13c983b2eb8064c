#include "schema/cyberwave/topic.h"

#include <cstddef>

#include "schema/limits.h"
#include "schema/rules/describe.h"
#include "schema/rules/path.h"
#include "schema/rules/texts.h"

namespace uplink::cyberwave {
namespace {

using model::cyberwave::Uuid;
using schema::Path;

/// The longest prefix that the topic stands under; null if there is none.
const std::string* PrefixOf(std::string_view topic, std::span<const std::string> prefixes) {
  const std::string* found = nullptr;
  for (const std::string& prefix : prefixes) {
    if (!topic.starts_with(prefix)) continue;
    if (!topic.substr(prefix.size()).starts_with(kRoot)) continue;
    if (found == nullptr || prefix.size() > found->size()) found = &prefix;
  }
  return found;
}

const TopicRow* RowOf(std::string_view scope, std::string_view tail) {
  for (const TopicRow& row : TopicRows()) {
    if (row.scope != scope) continue;
    const bool any = row.tail == "+" && tail.find('/') == std::string_view::npos;
    if (any || row.tail == tail) return &row;
  }
  return nullptr;
}

/// The level before the first slash, which is taken off `rest` with it; nothing without a slash.
std::optional<std::string_view> TakeLevel(std::string_view& rest) {
  const std::size_t slash = rest.find('/');
  if (slash == std::string_view::npos) return std::nullopt;
  const std::string_view level = rest.substr(0, slash);
  rest.remove_prefix(slash + 1);
  return level;
}

/// Keeps the name if it is a good one.
std::optional<model::Rejection> ReadName(Topic& topic, std::string_view name,
                                         std::size_t bytes_max) {
  const Path root;
  const Path field = root.Field("topic");
  if (name.empty()) return schema::Malformed("a name in the topic is empty").Describe();
  const schema::TextFinding found = schema::ReadText(field, name, bytes_max);
  if (found.violation) return found.violation->Describe();
  // It would be a wildcard in the topic of an answer.
  if (name.find_first_of("+#") != std::string_view::npos) {
    return schema::Malformed("a name in the topic holds a wildcard").Describe();
  }
  topic.name = name;
  return std::nullopt;
}

/// The part that only the kind says how to read.
std::optional<model::Rejection> ReadId(Topic& topic, std::string_view id, std::string_view tail) {
  if (topic.kind == TopicKind::kPing) return ReadName(topic, id, schema::kIdBytesMax);
  const std::optional<Uuid> uuid = Uuid::FromText(id);
  if (!uuid) return schema::Malformed("the id in the topic is no UUID").Describe();
  topic.id = *uuid;
  if (topic.kind != TopicKind::kEnvironment) return std::nullopt;
  return ReadName(topic, tail, schema::kNameBytesMax);
}

}  // namespace

bool IsOfTwin(TopicKind kind) {
  return kind != TopicKind::kEnvironment && kind != TopicKind::kWorkflowRun &&
         kind != TopicKind::kPing && kind != TopicKind::kOther;
}

TopicReading ParseTopic(std::string_view topic, std::span<const std::string> prefixes) {
  TopicReading reading;
  const std::string* prefix = PrefixOf(topic, prefixes);
  if (prefix == nullptr) return reading;
  std::string_view rest = topic.substr(prefix->size() + kRoot.size());
  const std::optional<std::string_view> scope = TakeLevel(rest);
  const std::optional<std::string_view> id = scope ? TakeLevel(rest) : std::nullopt;
  const TopicRow* row = id ? RowOf(*scope, rest) : nullptr;
  if (row == nullptr) return reading;
  reading.topic.kind = row->kind;
  reading.topic.message_class = row->message_class;
  reading.topic.prefix = *prefix;
  reading.rejection = ReadId(reading.topic, *id, rest);
  reading.topic.identified = !reading.rejection;
  return reading;
}

std::string KeptTopic(std::string_view topic, const Topic& read) {
  if (read.kind == TopicKind::kOther) return std::string(ToText(read.kind));
  if (MayBeKept(read.message_class)) return std::string(topic);
  const std::size_t root_bytes = read.prefix.size() + kRoot.size();
  std::string_view rest = topic.substr(root_bytes);
  const std::optional<std::string_view> scope = TakeLevel(rest);
  const std::optional<std::string_view> id = scope ? TakeLevel(rest) : std::nullopt;
  if (!id) return std::string(ToText(read.kind));
  std::string kept(topic.substr(0, root_bytes));
  kept.append(*scope).append("/").append(Uuid::FromText(*id) ? *id : "?");
  return kept.append("/").append(rest);
}

}  // namespace uplink::cyberwave
