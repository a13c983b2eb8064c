#pragma once

#include <chrono>
#include <cstddef>

#include "server/config/config.h"

namespace uplink::journal {

/// Streams that one store call opens: it reads the quarantine of each.
inline constexpr std::size_t kOpensPerCallMax = 256;
/// Robots that one store call adopts: it locks their rows.
inline constexpr std::size_t kAdoptsPerCallMax = 256;

/// After so many failures a call is halved: a store that cannot do the whole in time may do half.
/// After so many successes it doubles again. These are more, or a store that can do the half but
/// not the whole would spend its time on failures.
inline constexpr int kFailuresToHalve = 3;
inline constexpr int kSuccessesToDouble = 16;

/// One robot's share of a commit, for which all robots of the shard wait: a few milliseconds of a
/// store's work (128 rows take PostgreSQL one to three; 256 KiB take SQLite two). A drone's samples
/// have a share of their own.
struct BatchShare {
  std::size_t records_max = 128;
  std::size_t bytes_max = std::size_t{256} * 1024;
};
/// The share of all robots of one gateway: that of two robots. All other robots of the shard wait
/// for that commit.
inline constexpr BatchShare kGatewayBatchShare = {.records_max = 256,
                                                  .bytes_max = std::size_t{512} * 1024};
/// Robots that are skipped while a batch is filled, because they have their share of it or are not
/// held.
inline constexpr std::size_t kPassedMax = 4096;

/// Past its gateway's share, a robot with nothing waiting may append one record, until all robots
/// of the gateway have this many shares.
inline constexpr std::size_t kGatewaySharesMax = 2;

/// Connections of robots that wait for the store, about a kilobyte each, over all journals: the
/// begins and ends of a large fleet that connects anew while the store is away.
inline constexpr std::size_t kConnectionsWaitingMax = 16'384;
/// Those of one commit: they must not hold up its acks.
inline constexpr std::size_t kConnectionsPerCommitMax = 128;

struct JournalLimits {
  /// Bytes above which streams are held back (journal.bytes_max).
  std::size_t bytes_max = config::JournalConfig().bytes_max;
  /// Records above which streams are held back (journal.records_max).
  std::size_t records_max = config::JournalConfig().records_max;
  /// Records of one commit (journal.batch_records_max).
  std::size_t batch_records_max = config::JournalConfig().batch_records_max;
  std::size_t batch_bytes_max = 8U * 1024 * 1024;
  BatchShare batch_robot;
  BatchShare batch_gateway = kGatewayBatchShare;
  /// One robot may have 1 / robot_share of bytes_max and records_max (journal.robot_share).
  std::size_t robot_share = config::JournalConfig().robot_share;
  /// All robots of one gateway together may have 1 / gateway_share of bytes_max and records_max, or
  /// one robot's share if that is more. With kGatewaySharesMax, half of the journal is left for
  /// others.
  std::size_t gateway_share = 4;
  /// Connections of robots that wait for the store; others are dropped.
  std::size_t connections_max = kConnectionsWaitingMax;
  /// Whether this journal sweeps the store, and keeps its histories to their age: one journal of a
  /// server does.
  bool sweeps = true;
  bool retains = false;
};

/// Rows of deliveries without records that wait for a commit; the oldest go first. There are fewer
/// packet ids, and each appears about once.
inline constexpr std::ptrdiff_t kDeliveriesWaitingMax = 131'072;

/// How often expired rows are swept from the store, and how soon again if more is left.
inline constexpr std::chrono::seconds kSweepInterval{60};
inline constexpr std::chrono::milliseconds kSweepAgain{100};

/// How often the quarantine of robots that filled theirs is checked, and how many robots per call.
inline constexpr std::chrono::seconds kTrimInterval{10};
inline constexpr std::size_t kTrimRobotsPerCall = 4;

/// How soon connections of other servers are looked at again while it is in question whether their
/// server is over.
inline constexpr std::chrono::milliseconds kEndsAgain{2'500};

/// How often old rows of histories are deleted; how soon again while the store is away, and after
/// other errors.
inline constexpr std::chrono::hours kRetainInterval{1};
inline constexpr std::chrono::seconds kRetainAgain{10};
inline constexpr std::chrono::minutes kRetainLater{5};

}  // namespace uplink::journal
