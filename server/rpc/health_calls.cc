#include "server/rpc/health_calls.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "grpc/health/v1/health.pb.h"

namespace uplink::rpc {
namespace {

namespace health_v1 = ::grpc::health::v1;
using Response = health_v1::HealthCheckResponse;

/// What the listener serves; empty: the server.
constexpr std::array<std::string_view, 4> kServices{
    "", "uplink.v1.FleetView", "uplink.v1.FleetAdmin", "grpc.health.v1.Health"};

/// Nothing: no such service is served.
std::optional<Response::ServingStatus> StatusOfService(const health::Monitor& monitor,
                                                       std::string_view service) {
  if (std::ranges::find(kServices, service) == kServices.end()) return std::nullopt;
  return monitor.readiness().ready() ? Response::SERVING : Response::NOT_SERVING;
}

absl::StatusOr<std::string> ServiceOf(std::string_view bytes) {
  health_v1::HealthCheckRequest request;
  if (!request.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return absl::InvalidArgumentError("the request is no grpc.health.v1.HealthCheckRequest");
  }
  return request.service();
}

}  // namespace

transport::Methods HealthMethods(const health::Monitor& monitor, RpcProbe& probe,
                                 const Clock& clock) {
  using CallHandlerOr = absl::StatusOr<std::unique_ptr<transport::CallHandler>>;
  transport::Methods methods;
  methods.emplace(
      "/grpc.health.v1.Health/Check",
      transport::Method{.open = true,
                        .admission = transport::Admission::kHealth,
                        .serve = [&monitor, &clock](transport::ServedCall& call) -> CallHandlerOr {
                          return std::make_unique<HealthCheck>(monitor, call, clock);
                        },
                        .ended = CountedIn(probe.Of(OtherMethod::kHealthCheck))});
  methods.emplace(
      "/grpc.health.v1.Health/Watch",
      transport::Method{.kind = transport::MethodKind::kServerStream,
                        .open = true,
                        .admission = transport::Admission::kHealth,
                        .serve = [&monitor, &clock](transport::ServedCall& call) -> CallHandlerOr {
                          return std::make_unique<HealthWatch>(monitor, call, clock);
                        },
                        .ended = CountedIn(probe.Of(OtherMethod::kHealthWatch))});
  return methods;
}

void HealthCheck::Start() {
  end_by_ = clock_.Steady() + kRequestWait;
  call_.RequestMessage();
}

void HealthCheck::OnMessage(std::string_view bytes) {
  const auto service = ServiceOf(bytes);
  if (!service.ok()) return Finish(service.status());
  const auto status = StatusOfService(monitor_, *service);
  if (!status) return Finish(absl::NotFoundError("no such service is served here"));
  Response response;
  response.set_status(*status);
  call_.Write(transport::WithPrefix(response));
  Finish(absl::OkStatus());
}

void HealthCheck::OnTooLarge(std::uint64_t /*bytes*/) {
  Finish(absl::ResourceExhaustedError("the request is too large"));
}

void HealthCheck::OnTimer() {
  if (!end_by_ || clock_.Steady() < *end_by_) return;
  Finish(absl::DeadlineExceededError("the request did not come whole in time"));
}

void HealthCheck::OnDrain(milliseconds /*grace*/) {
  Finish(absl::UnavailableError("the connection ends; ask again"));
}

void HealthCheck::Finish(const absl::Status& status) {
  end_by_.reset();
  call_.Finish(status);
}

void HealthWatch::Start() {
  look_at_ = clock_.Steady() + kRequestWait;
  call_.RequestMessage();
}

void HealthWatch::OnMessage(std::string_view bytes) {
  auto service = ServiceOf(bytes);
  if (!service.ok()) return call_.Finish(service.status());
  service_ = *std::move(service);
  Look();
}

void HealthWatch::OnTooLarge(std::uint64_t /*bytes*/) {
  call_.Finish(absl::ResourceExhaustedError("the request is too large"));
}

void HealthWatch::OnTimer() {
  if (clock_.Steady() < look_at_) return;
  if (!service_) {
    return call_.Finish(absl::DeadlineExceededError("the request did not come whole in time"));
  }
  Look();
}

void HealthWatch::Look() {
  look_at_ = clock_.Steady() + kHealthLook;
  const int status = StatusOfService(monitor_, *service_).value_or(Response::SERVICE_UNKNOWN);
  if (writing_ || told_ == status) return;
  told_ = status;
  Response response;
  response.set_status(static_cast<Response::ServingStatus>(status));
  writing_ = true;
  call_.Write(transport::WithPrefix(response));
}

void HealthWatch::OnDrain(milliseconds /*grace*/) {
  call_.Finish(absl::UnavailableError("the connection ends; ask again"));
}

}  // namespace uplink::rpc
