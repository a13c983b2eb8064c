#include "server/front/call/response.h"

#include <utility>

#include "server/front/call/grpc_status.h"

namespace uplink::front {
namespace {

constexpr std::string_view kContentType = "application/grpc";

}  // namespace

void Response::Write(std::string message) {
  out_.Set(std::move(message));
  Send();
}

void Response::Write(std::vector<SharedMessage> messages) {
  out_.Set(std::move(messages));
  Send();
}

void Response::Send() {
  writing_ = true;
  if (std::exchange(begun_, true)) return http2_.Resume(stream_);
  http2_.Respond(stream_, {{":status", "200"}, {"content-type", std::string(kContentType)}},
                 Http2::Then::kBody);
}

Http2Stream::Body Response::Take(char* into, std::size_t size) {
  using State = Http2Stream::Body::State;
  const std::size_t bytes = out_.Take(into, size);
  if (!out_.empty()) return {State::kMore, bytes};
  writing_ = false;
  return {finished_ ? State::kEnd : State::kWait, bytes};
}

void Response::SendTrailers() { http2_.Trailers(stream_, StatusFields()); }

Headers Response::StatusFields() const {
  Headers fields{{"grpc-status", std::to_string(GrpcCode(status_.code()))}};
  if (!status_.message().empty()) {
    fields.emplace_back("grpc-message", PercentEncoded(std::string(status_.message())));
  }
  if (names_encodings_) fields.emplace_back("grpc-accept-encoding", "identity");
  return fields;
}

void Response::Finish(const absl::Status& status) {
  finished_ = true;
  status_ = status;
  // With a message under way, the end follows it.
  if (begun_) return http2_.Resume(stream_);
  begun_ = true;
  Headers fields{{":status", "200"}, {"content-type", std::string(kContentType)}};
  for (auto& field : StatusFields()) fields.push_back(std::move(field));
  http2_.Respond(stream_, fields, Http2::Then::kEnd);
}

void Response::DropMessage() {
  if (!out_.begun()) out_.Clear();
}

void Response::FinishHttp(int http_status) {
  begun_ = finished_ = true;
  http2_.Respond(stream_, {{":status", std::to_string(http_status)}}, Http2::Then::kEnd);
}

}  // namespace uplink::front
