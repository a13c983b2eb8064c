#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include <absl/status/statusor.h>

#include "storage/sqlite/database.h"

namespace uplink::storage::sqlite {

/// What the index of an open WAL (`-shm`) says. Numbers are in the machine's order, salts as they
/// stand in the WAL. A value.
///
/// Source: sqlite.org/walformat.html.
struct WalIndex {
  /// The first copy of its header, in words of four bytes.
  std::array<std::uint32_t, 12> header{};
  /// Frames that were moved into the database, and that one tried to move.
  std::uint32_t moved = 0;
  std::uint32_t moving = 0;

  bool operator==(const WalIndex&) const = default;
  /// Of the last commit; 0 if the WAL has none.
  [[nodiscard]] std::uint32_t last_frame() const { return header[4]; }
  /// Of the database as of the last commit.
  [[nodiscard]] std::uint32_t pages() const { return header[5]; }
  [[nodiscard]] std::array<std::uint32_t, 2> checksum() const { return {header[6], header[7]}; }
  /// Others once the WAL begins anew.
  [[nodiscard]] std::array<std::uint32_t, 2> salts() const { return {header[8], header[9]}; }
};

/// Of a connection whose WAL is open; nothing while another connection writes the index.
///
/// Errors: kUnavailable if it cannot be read.
[[nodiscard]] absl::StatusOr<std::optional<WalIndex>> ReadWalIndex(const Database& database);

inline constexpr std::int64_t kWalHeaderBytes = 32;
inline constexpr std::int64_t kFrameHeaderBytes = 24;

/// Where a frame ends in the WAL's file; frame 0 is the header. `page`: the bytes of a page.
[[nodiscard]] constexpr std::int64_t EndOfFrame(std::uint32_t frame, std::int64_t page) {
  return kWalHeaderBytes + std::int64_t{frame} * (kFrameHeaderBytes + page);
}

}  // namespace uplink::storage::sqlite
