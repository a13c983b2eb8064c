#include "schema/json/read.h"

#include <optional>
#include <string>

#include <absl/status/status.h>

#include "schema/json/exact.h"

namespace uplink::json {
namespace {

/// The members of an object that holds numbers; remembers if one was not as it must be.
class Numbers final {
 public:
  explicit Numbers(std::string_view text) : body_(ParseExact(text)) {
    good_ = body_ && body_->is_object();
  }

  /// A number that must be there.
  double Required(std::string_view name) {
    const std::optional<double> number = Optional(name);
    if (!number) good_ = false;
    return number.value_or(0);
  }
  std::optional<double> Optional(std::string_view name) {
    const boost::json::value* const value =
        body_ && body_->is_object()
            ? body_->get_object().if_contains(boost::json::string_view(name.data(), name.size()))
            : nullptr;
    if (value == nullptr) return std::nullopt;
    const std::optional<double> number = NumberOf(*value);
    if (!number) good_ = false;
    return number;
  }
  [[nodiscard]] bool good() const { return good_; }

 private:
  std::optional<boost::json::value> body_;
  bool good_ = false;
};

}  // namespace

absl::StatusOr<model::Pose> ReadPose(std::string_view text) {
  Numbers numbers(text);
  const model::Pose pose{.lat_deg = numbers.Required("latDeg"),
                         .lon_deg = numbers.Required("lonDeg"),
                         .altitude_m = numbers.Optional("altitudeM"),
                         .heading_deg = numbers.Optional("headingDeg")};
  if (!numbers.good()) return absl::DataLossError("the text is no pose");
  return pose;
}

absl::StatusOr<model::Trajectory> ReadTrajectory(std::string_view text) {
  Numbers numbers(text);
  const model::Trajectory trajectory{.speed_mps = numbers.Required("speedMps"),
                                     .course_deg = numbers.Required("courseDeg"),
                                     .vertical_rate_mps = numbers.Required("verticalRateMps")};
  if (!numbers.good()) return absl::DataLossError("the text is no trajectory");
  return trajectory;
}

}  // namespace uplink::json
