#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "storage/samples.h"
#include "storage/tables/table.h"

// What is remembered of drones' samples.
namespace uplink::storage {

/// The memory of one type of a drone. The views must outlive it.
struct KeptSamples {
  KeptSamples(std::string_view of_ruri, const SampleMemory& memory)
      : ruri(of_ruri),
        type(static_cast<std::int32_t>(memory.type)),
        digests(PackedDigests(memory.digests)),
        last(memory.last) {}

  std::string_view ruri;
  std::int32_t type = 0;
  std::string digests;
  std::string_view last;
};

inline constexpr Table<KeptSamples, Unlisted, 4> kSamplesTable = {
    "samples",
    Writes::kUpserts,
    {},
    std::array<Column<KeptSamples, Unlisted>, 4>{
        Col("ruri", [](const auto& row) { return row.ruri; }).Key(),
        Col("type", [](const auto& row) { return row.type; }).Key(),
        Col("digests", [](const auto& row) { return Bytes{row.digests}; }),
        Col("last", [](const auto& row) { return Bytes{row.last}; }),
    }};

}  // namespace uplink::storage
