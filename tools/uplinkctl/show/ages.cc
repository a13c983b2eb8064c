#include "tools/uplinkctl/show/ages.h"

#include <fmt/core.h>

#include "schema/base/rfc3339.h"
#include "server/config/units.h"

namespace uplink::ctl {
namespace {

using std::chrono::days;
using std::chrono::duration_cast;
using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;

/// From here on the smaller unit tells nothing.
constexpr hours kOnlyMinutesBelow{1};
constexpr days kHoursBelow{2};
constexpr days kOnlyDaysFrom{14};

std::string WithRest(long long whole, const char* unit, long long rest, const char* rest_unit) {
  return rest == 0 ? fmt::format("{} {}", whole, unit)
                   : fmt::format("{} {} {} {}", whole, unit, rest, rest_unit);
}

/// `22:00Z`.
std::optional<SystemTime> LastTimeOfDay(std::string_view text, SystemTime now) {
  if (text.size() != 6 || text[2] != ':' || text[5] != 'Z') return std::nullopt;
  const auto hour = config::ParseCount(text.substr(0, 2));
  const auto minute = config::ParseCount(text.substr(3, 2));
  if (!hour || !minute || *hour > 23 || *minute > 59) return std::nullopt;
  const SystemTime today = std::chrono::floor<days>(now) + hours(static_cast<int>(*hour)) +
                           minutes(static_cast<int>(*minute));
  return today <= now ? today : today - days(1);
}

}  // namespace

std::string LengthText(milliseconds length) {
  if (length < minutes(1)) return fmt::format("{} s", duration_cast<seconds>(length).count());
  if (length < kOnlyMinutesBelow) {
    return fmt::format("{} min", duration_cast<minutes>(length).count());
  }
  if (length < kHoursBelow) {
    const auto whole = duration_cast<hours>(length);
    return WithRest(whole.count(), "h", duration_cast<minutes>(length - whole).count(), "min");
  }
  const auto whole = duration_cast<days>(length);
  if (whole >= kOnlyDaysFrom) return fmt::format("{} d", whole.count());
  return WithRest(whole.count(), "d", duration_cast<hours>(length - whole).count(), "h");
}

std::string AgeText(SystemTime time, SystemTime now) {
  const milliseconds age = now - time;
  // Clocks of two machines differ by as much.
  if (age < seconds(1) && age > seconds(-1)) return "now";
  return age < milliseconds(0) ? "in " + LengthText(-age) : LengthText(age);
}

std::optional<SystemTime> ParseMoment(std::string_view text, SystemTime now) {
  if (const auto length = config::ParseDuration(text)) return now - *length;
  if (const auto time = FromRfc3339(text)) return time;
  return LastTimeOfDay(text, now);
}

}  // namespace uplink::ctl
