// Links over TCP, IPv4 and IPv6. Nothing raises SIGPIPE; small writes travel at once (TCP_NODELAY).
#pragma once
#include "platform/link.h"

namespace platform {

extern const LinkBackend kTcpLink;

}  // namespace platform
