// pocketray keygen: makes a key that a device and its render servers share.
#include "app/network/network_commands.h"
#include "platform/entropy.h"
#include "platform/net/key_file.h"
#include "session/note.h"
#include "session/report.h"

namespace pocketray {
namespace {

int run(const std::string& path) {
  if (path == "-") return report(failure("-o -: a key needs a file that only its owner may read: name one"));
  platform::SharedKey key;
  platform::FileError error;
  if (!platform::random_bytes(key.bytes, sizeof key.bytes))
    return report(failure("this system has no random bytes yet: try again later"));
  bool ok = platform::create_key_file(path.c_str(), key, &error);
  platform::wipe(&key, sizeof key);
  if (!ok) return report(failure("-o %.200s: %s", path.c_str(), error.text));
  std::printf("%s: copy it to the server and to the device, and give it to `serve` and beside --server: --key %s\n",
              shown(path).c_str(), shown(path).c_str());
  return kExitDone;
}

}  // namespace

void add_keygen_command(Command program, int* exit_status) {
  auto path = std::make_shared<std::string>("pocketray.key");
  Command command = program.add_subcommand("keygen", "make a key that encrypts links to render servers");
  command.chapter("Output");
  command.add_option("-o,--output FILE", *path, "file to write, unless it exists").capture_default_str();
  command.about(
      "The file has one line, pocketray-key-1: and 64 hexadecimal digits: 256 random bits. Whoever has them can use "
      "the "
      "server and read what it sends, so its mode is 0600; copy it by a way that you trust, such as scp or a card.");
  command.callback([=] { *exit_status = run(*path); });
}

}  // namespace pocketray
