#include "remote/encryption.h"

#include "base/check.h"
#ifdef POCKETRAY_HAVE_TLS
#include "platform/entropy.h"
#include "platform/net/tls/tls_link.h"
#endif

namespace pocketray {

#ifdef POCKETRAY_HAVE_TLS

Status read_key(const std::string& path, platform::SharedKey* key) {
  CHECK(key != nullptr);
  platform::FileError error;
  if (platform::read_key_file(path.c_str(), key, &error)) return success();
  return failure("--key %.200s: %s", path.c_str(), error.text);
}

std::size_t encrypted_link_need(int stream_count) { return platform::tls_link_need(stream_count); }

platform::Link* open_encrypted_link(platform::Link* below, const platform::LinkOptions& options,
                                    const platform::SharedKey& key, platform::Error* error) {
  CHECK(below != nullptr);
  platform::TlsLinkSettings settings;
  settings.key = key;
  settings.random = platform::random_bytes;
  platform::Link* link = platform::tls_link_open(below, options, settings, error);
  platform::wipe(&settings.key, sizeof settings.key);
  return link;
}

#else

Status read_key(const std::string&, platform::SharedKey*) {
  return failure("--key: this build has no TLS: rebuild it where mbedTLS is installed, with -DPOCKETRAY_TLS=ON");
}

std::size_t encrypted_link_need(int) { return 0; }

platform::Link* open_encrypted_link(platform::Link*, const platform::LinkOptions&, const platform::SharedKey&,
                                    platform::Error*) {
  CHECK(false);  // no key is read
  return nullptr;
}

#endif

}  // namespace pocketray
