#include "schema/uncrew/judge.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>

#include <google/protobuf/arena.h>

#include "schema/base/check.h"
#include "schema/uncrew/families.h"
#include "schema/uncrew/limits.h"

namespace uplink::uncrew {
namespace {

namespace uc = model::uncrew;
using schema::Path;
using schema::Violations;

/// Decoding a usual request allocates nothing.
constexpr std::size_t kArenaBytes = 4096;

/// One request under judgement.
struct Judging {
  const uc::TypeRow& row;
  std::string_view request;
  Violations violations;
  bool decoded = false;
  uc::Metadata metadata{};
};

void ReadMetadata(const v1::Metadata& from, Judging& judging) {
  const Path path;
  Reader in(judging.violations, path);
  judging.metadata = {.uav_id = from.uav_id(),
                      .sampled_at_us = in.TimeUs(from.sampled_at_unix_us()),
                      .boot_us = from.sampled_at_boot_us()};
}

/// The sample of a request of that message, which `has` and `sample` find in it; nothing if it
/// could not be read. The violations tell whether it is good.
template <typename Request, typename Has, typename Sample>
std::optional<uc::Value> ReadRequest(Judging& judging, Has has, Sample sample) {
  // NOLINTNEXTLINE(*-member-init): the arena's to fill
  alignas(std::max_align_t) std::array<char, kArenaBytes> block;
  google::protobuf::ArenaOptions options;
  options.initial_block = block.data();
  options.initial_block_size = block.size();
  google::protobuf::Arena arena(options);
  auto* request = google::protobuf::Arena::CreateMessage<Request>(&arena);
  judging.decoded =
      request->ParseFromArray(judging.request.data(), static_cast<int>(judging.request.size()));
  if (!judging.decoded) {
    judging.violations.Reject(
        schema::Malformed("the request is cut, or a text in it is not UTF-8"));
    return std::nullopt;
  }
  ReadMetadata(request->metadata(), judging);
  const Path root;
  const Path path = root.Field(judging.row.member);
  if (!has(*request)) {
    judging.violations.Reject(schema::MissingField(path, "is missing"));
    return std::nullopt;
  }
  Reader in(judging.violations, path);
  auto value = Read(in, sample(*request));
  if constexpr (requires { request->command_id(); }) {
    value.command_id = Reader(judging.violations, root)
                           .RequiredText("command_id", request->command_id(), schema::kIdBytesMax);
  }
  if (!IsKnown(value)) judging.violations.RejectIfAnyDropped();
  return value;
}

std::optional<uc::Value> ReadRequest(uc::SampleType type, Judging& judging) {
  switch (type) {
#define UPLINK_TYPE(Type, Method, member, name, kind, parts_max)             \
  case uc::SampleType::k##Type:                                              \
    return ReadRequest<v1::Method##Request>(                                 \
        judging, [](const auto& request) { return request.has_##member(); }, \
        [](const auto& request) -> const auto& { return request.member(); });
    UPLINK_UNCREW_TYPES(UPLINK_TYPE)
#undef UPLINK_TYPE
    case uc::SampleType::kRejected:
      break;
  }
  CheckFailed(__FILE__, __LINE__, "type", "a type that no method publishes");
}

}  // namespace

Judgement Judge(uc::SampleType type, std::string_view request) {
  Judgement found;
  found.type = type;
  found.payload_bytes = request.size();
  found.may_be_kept = type != uc::SampleType::kVideoStreamSettings;
  const uc::TypeRow& row = uc::RowOf(type);
  Judging judging = {
      .row = row,
      .request = request,
      .violations = Violations(
          {.durable = row.kind != uc::SampleKind::kLive,
           .quoting = found.may_be_kept ? schema::Quoting::kQuoted : schema::Quoting::kUnquoted})};
  Violations& violations = judging.violations;
  std::optional<uc::Value> value;
  if (request.size() > kRequestBytesMax) {
    violations.Reject(schema::PayloadTooLarge(request.size(), kRequestBytesMax));
  } else {
    value = ReadRequest(type, judging);
  }
  found.decoded = judging.decoded;
  found.metadata = std::move(judging.metadata);
  found.times_unknown = violations.times_unknown();
  if (violations.rejected()) {
    found.verdict = violations.TakeRejection();
    return found;
  }
  found.verdict = *std::move(value);
  found.dropped = violations.TakeDropped();
  found.unlisted = violations.TakeUnlisted();
  found.enumerants_unrecognized = violations.enumerants_unrecognized();
  found.control_characters = violations.control_characters();
  return found;
}

}  // namespace uplink::uncrew
