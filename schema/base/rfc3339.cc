#include "schema/base/rfc3339.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstddef>
#include <system_error>

namespace uplink {
namespace {

using std::chrono::days;
using std::chrono::hours;
using std::chrono::microseconds;
using std::chrono::minutes;
using std::chrono::seconds;
using MicroTime = std::chrono::sys_time<microseconds>;

void Append(std::int64_t number, std::size_t digits, std::string& text) {
  std::array<char, 20> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
  const auto length = static_cast<std::size_t>(end - buffer.data());
  if (length < digits) text.append(digits - length, '0');
  text.append(buffer.data(), length);
}

std::string Text(MicroTime time) {
  const auto day = std::chrono::floor<days>(time);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss<microseconds> clock(time - day);
  std::string text;
  Append(static_cast<int>(date.year()), 4, text);
  text += '-';
  Append(static_cast<unsigned>(date.month()), 2, text);
  text += '-';
  Append(static_cast<unsigned>(date.day()), 2, text);
  text += 'T';
  Append(clock.hours().count(), 2, text);
  text += ':';
  Append(clock.minutes().count(), 2, text);
  text += ':';
  Append(clock.seconds().count(), 2, text);
  const std::int64_t fraction = clock.subseconds().count();
  if (fraction != 0) {
    text += '.';
    if (fraction % 1000 == 0) {
      Append(fraction / 1000, 3, text);
    } else {
      Append(fraction, 6, text);
    }
  }
  return text + 'Z';
}

/// Takes a text apart from its front.
class Scan final {
 public:
  explicit Scan(std::string_view text) : rest_(text) {}

  [[nodiscard]] bool Take(char expected) {
    if (rest_.empty() || rest_.front() != expected) return false;
    rest_.remove_prefix(1);
    return true;
  }
  /// So many digits, exactly.
  [[nodiscard]] std::optional<int> Number(std::size_t digits) {
    if (rest_.size() < digits) return std::nullopt;
    int number = 0;
    for (const char c : rest_.substr(0, digits)) {
      if (c < '0' || c > '9') return std::nullopt;
      number = number * 10 + (c - '0');
    }
    rest_.remove_prefix(digits);
    return number;
  }
  /// Digits behind the point, at least one, as milliseconds.
  [[nodiscard]] std::optional<milliseconds> Fraction() {
    const std::size_t digits = std::min(rest_.find_first_not_of("0123456789"), rest_.size());
    if (digits == 0) return std::nullopt;
    std::int64_t count = 0;
    for (std::size_t i = 0; i < 3; ++i) count = count * 10 + (i < digits ? rest_[i] - '0' : 0);
    rest_.remove_prefix(digits);
    return milliseconds(count);
  }
  [[nodiscard]] bool done() const { return rest_.empty(); }

 private:
  std::string_view rest_;
};

std::optional<SystemTime> TakeDate(Scan& scan) {
  const auto year = scan.Number(4);
  if (!year || *year == 0 || !scan.Take('-')) return std::nullopt;
  const auto month = scan.Number(2);
  if (!month || !scan.Take('-')) return std::nullopt;
  const auto day = scan.Number(2);
  if (!day) return std::nullopt;
  const std::chrono::year_month_day date(std::chrono::year(*year),
                                         std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day)));
  if (!date.ok()) return std::nullopt;
  return SystemTime(std::chrono::sys_days(date));
}

/// `23:59`.
std::optional<minutes> TakeMinutes(Scan& scan) {
  const auto hour = scan.Number(2);
  if (!hour || *hour > 23 || !scan.Take(':')) return std::nullopt;
  const auto minute = scan.Number(2);
  if (!minute || *minute > 59) return std::nullopt;
  return hours(*hour) + minutes(*minute);
}

/// What must be taken off to come to UTC.
std::optional<minutes> TakeOffset(Scan& scan) {
  if (scan.Take('Z')) return minutes(0);
  const bool ahead = scan.Take('+');
  if (!ahead && !scan.Take('-')) return std::nullopt;
  const auto offset = TakeMinutes(scan);
  if (!offset) return std::nullopt;
  return ahead ? *offset : -*offset;
}

}  // namespace

std::string Rfc3339(SystemTime time) { return Text(std::clamp(time, kRfc3339First, kRfc3339Last)); }

std::string Rfc3339OfUs(std::int64_t unix_us) {
  const MicroTime time{microseconds(unix_us)};
  return Text(std::clamp(time, MicroTime(kRfc3339First), MicroTime(kRfc3339Last)));
}

std::optional<SystemTime> FromRfc3339(std::string_view text) {
  Scan scan(text);
  const auto date = TakeDate(scan);
  if (!date || !scan.Take('T')) return std::nullopt;
  const auto clock = TakeMinutes(scan);
  if (!clock || !scan.Take(':')) return std::nullopt;
  const auto second = scan.Number(2);
  if (!second || *second > 59) return std::nullopt;
  milliseconds fraction{0};
  if (scan.Take('.')) {
    const auto taken = scan.Fraction();
    if (!taken) return std::nullopt;
    fraction = *taken;
  }
  const auto offset = TakeOffset(scan);
  if (!offset || !scan.done()) return std::nullopt;
  return *date + *clock + seconds(*second) + fraction - *offset;
}

}  // namespace uplink
