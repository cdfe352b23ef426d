// Encrypted links to render servers in builds with TLS; others refuse --key.
#pragma once
#include <string>

#include "base/status.h"
#include "platform/link.h"
#include "platform/net/key_file.h"

namespace pocketray {

// Reads the file of --key. Also fails in builds without TLS.
Status read_key(const std::string& path, platform::SharedKey* key);

// Bytes of memory for an encrypted link of that many streams; 0 without TLS.
std::size_t encrypted_link_need(int stream_count);
// A link over `below` for holders of the key, in options.memory (platform/net/tls/tls_link.h). Null on failure.
platform::Link* open_encrypted_link(platform::Link* below, const platform::LinkOptions& options,
                                    const platform::SharedKey& key, platform::Error* error);

}  // namespace pocketray
