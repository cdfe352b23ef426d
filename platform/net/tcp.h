// Links over TCP, IPv4 and IPv6. They never raise SIGPIPE; small writes are sent at once (TCP_NODELAY).
#pragma once
#include "platform/link.h"

namespace platform {

extern const LinkBackend kTcpLink;

}  // namespace platform
