#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "storage/forget_requests.h"
#include "storage/numbers.h"
#include "storage/presence.h"
#include "storage/reader.h"
#include "storage/rejects.h"
#include "storage/robot_hold.h"
#include "storage/rows.h"
#include "storage/samples.h"
#include "storage/topic_leases.h"

// What a row of a statement says, for every store. A Row gives its columns by their place: Null,
// Int, Bool, Time, Uuid, Bytes. `column` is the first that is read.
namespace uplink::storage {

template <typename Row>
[[nodiscard]] std::string TextIn(const Row& row, int column) {
  return std::string(row.Bytes(column));
}

template <typename Row>
[[nodiscard]] std::uint64_t NumberIn(const Row& row, int column) {
  return static_cast<std::uint64_t>(row.Int(column));
}

/// Presence, since when, and until when it is parked; nothing if there is no presence.
template <typename Row>
[[nodiscard]] std::optional<StoredPresence> PresenceIn(const Row& row, int column) {
  if (row.Null(column)) return std::nullopt;
  StoredPresence stored{PresenceOf(row.Int(column)), row.Time(column + 1)};
  if (!row.Null(column + 2)) stored.parked_until = row.Time(column + 2);
  return stored;
}

/// Owner and epoch; nothing if there is no robot.
template <typename Row>
[[nodiscard]] std::optional<RobotHold> HoldIn(const Row& row, int column) {
  if (row.Null(column)) return std::nullopt;
  return RobotHold{row.Uuid(column).bytes(), NumberIn(row, column + 1)};
}

/// Session and the number that is settled; nothing if there is none.
template <typename Row>
[[nodiscard]] std::optional<SettledSession> SessionIn(const Row& row, int column) {
  if (row.Null(column)) return std::nullopt;
  return SettledSession{row.Uuid(column), NumberIn(row, column + 1)};
}

/// Reason, field and detail.
template <typename Row>
[[nodiscard]] model::Rejection RejectionIn(const Row& row, int column) {
  return {ReasonOf(row.Int(column)), TextIn(row, column + 1), TextIn(row, column + 2)};
}

/// Number, reason, field and detail.
template <typename Row>
[[nodiscard]] StoredReject RejectIn(const Row& row, int column = 0) {
  return {NumberIn(row, column), RejectionIn(row, column + 1)};
}

/// RURI, fleet, first and last seen, presence, session, holder, whether it was claimed.
template <typename Row>
[[nodiscard]] RobotRow RobotIn(const Row& row) {
  RobotRow robot{.robot = {TextIn(row, 0), TextIn(row, 1)},
                 .first_seen = row.Time(2),
                 .last_seen = row.Time(3),
                 .last_session = SessionIn(row, 7),
                 .holder = row.Uuid(9).bytes(),
                 .was_claimed = row.Int(10) != 0};
  if (const auto presence = PresenceIn(row, 4)) {
    robot.last_presence = presence->presence;
    robot.presence_since = presence->since;
    robot.parked_until = presence->parked_until;
  }
  return robot;
}

/// Kind, arrival, body.
template <typename Row>
[[nodiscard]] LatestRow LatestIn(const Row& row, const std::string& ruri) {
  return {ruri, static_cast<LatestKind>(row.Int(0)), TextIn(row, 2), row.Time(1)};
}

/// Reason and count.
template <typename Row>
[[nodiscard]] DroppedRow DroppedIn(const Row& row) {
  return {ReasonOf(row.Int(0)), NumberIn(row, 1)};
}

/// The first part's column in a row of live state.
inline constexpr int kFirstLivePart = 4;

/// RURI, hold, last sign of life, skew of the clock, parts.
template <typename Row>
[[nodiscard]] LiveRow LiveIn(const Row& row) {
  LiveRow live;
  live.ruri = row.Bytes(0);
  live.held_since = NumberIn(row, 1);
  if (!row.Null(2)) live.last_sign_of_life = row.Time(2);
  if (!row.Null(3)) live.clock_skew_ms = row.Int(3);
  int column = kFirstLivePart;
  for (std::optional<std::string>& part : live.parts) {
    if (!row.Null(column)) part = row.Bytes(column);
    ++column;
  }
  return live;
}

/// Answer and epoch.
template <typename Row>
[[nodiscard]] AnsweredForget AnswerIn(const Row& row) {
  return {static_cast<ForgetAnswer>(row.Int(0)), NumberIn(row, 1)};
}

/// Number, RURI, whether its stream ends, whether it is finished, hold, answer.
template <typename Row>
[[nodiscard]] PendingForget PendingIn(const Row& row) {
  return {.number = NumberIn(row, 0),
          .ruri = TextIn(row, 1),
          .end_stream = row.Bool(2),
          .finished = row.Bool(3),
          .removed = row.Int(6) == kForgetRemoved,
          .hold = HoldIn(row, 4)};
}

/// Client id, holder, epoch, whether it was released, when it was taken, one of the prefixes: rows
/// of one client id stand one after the other.
template <typename Row>
void AddTopicLease(const Row& row, std::vector<TopicLease>& leases) {
  if (leases.empty() || leases.back().client_id != row.Bytes(0)) {
    leases.push_back({.client_id = TextIn(row, 0),
                      .epoch = NumberIn(row, 2),
                      .holder = row.Uuid(1).bytes(),
                      .released = row.Bool(3),
                      .taken_at = row.Time(4)});
  }
  if (!row.Null(5)) leases.back().prefixes.push_back(TextIn(row, 5));
}

/// Type, digests, bytes of the last. Digests that no program of ours wrote are none.
template <typename Row>
[[nodiscard]] SampleMemory SamplesIn(const Row& row, int column = 0) {
  return {static_cast<std::uint32_t>(row.Int(column)),
          DigestsIn(row.Bytes(column + 1)).value_or(std::vector<SampleDigest>()),
          TextIn(row, column + 2)};
}

/// Number, packet id, digest.
template <typename Row>
[[nodiscard]] Delivery DeliveryIn(const Row& row) {
  Delivery delivery{.number = NumberIn(row, 0),
                    .packet_id = static_cast<std::uint16_t>(row.Int(1))};
  if (!row.Null(2)) delivery.digest = row.Uuid(2).bytes();
  return delivery;
}

}  // namespace uplink::storage
