#include "server/transport/end_cause.h"

namespace uplink::transport {

model::ConnectionEnd WhyOf(EndCause cause) {
  using model::ConnectionEnd;
  switch (cause) {
    case EndCause::kClosed:
      return ConnectionEnd::kOrderly;
    case EndCause::kReset:
    case EndCause::kCut:
      return ConnectionEnd::kBroken;
    case EndCause::kUnanswered:
      return ConnectionEnd::kSilent;
    case EndCause::kSuperseded:
      return ConnectionEnd::kReplaced;
    case EndCause::kDrain:
    case EndCause::kAge:
      return ConnectionEnd::kDrained;
    case EndCause::kExpired:
      return ConnectionEnd::kCertificateExpired;
    case EndCause::kNotRead:
      return ConnectionEnd::kNotRead;
    case EndCause::kBrokeRules:
      return ConnectionEnd::kProtocolError;
    case EndCause::kBound:
    case EndCause::kUnconfirmed:
    case EndCause::kNotAllowed:
    case EndCause::kForgotten:
    case EndCause::kBlocked:
    case EndCause::kDisconnected:
    case EndCause::kStoreLost:
      return ConnectionEnd::kRefused;
    case EndCause::kServerStops:
      return ConnectionEnd::kServerEnded;
  }
  return ConnectionEnd::kBroken;
}

std::string_view SentenceOf(EndCause cause) {
  switch (cause) {
    case EndCause::kClosed:
      return "the robot closed it";
    case EndCause::kReset:
      return "the agent reset the stream";
    case EndCause::kCut:
      return "the connection was cut";
    case EndCause::kUnanswered:
      return "nothing answered the server's keepalive";
    case EndCause::kSuperseded:
      return "superseded";
    case EndCause::kDrain:
      return "the server drains";
    case EndCause::kAge:
      return "the connection was old, or its certificate expires soon";
    case EndCause::kExpired:
      return "its certificate has expired";
    case EndCause::kNotRead:
      return "the robot did not read what the server sent";
    case EndCause::kBrokeRules:
      return "the peer broke a rule of HTTP/2";
    case EndCause::kBound:
      return "a bound of the server";
    case EndCause::kUnconfirmed:
      return "too many Rejects are not confirmed";
    case EndCause::kNotAllowed:
      return "its certificate may not speak for the robot";
    case EndCause::kForgotten:
      return "an operator ended the stream";
    case EndCause::kBlocked:
      return "blocked";
    case EndCause::kDisconnected:
      return "disconnected by an operator";
    case EndCause::kStoreLost:
      return "the store lost what it had of the robot";
    case EndCause::kServerStops:
      return "the server stopped";
  }
  return "";
}

}  // namespace uplink::transport
