// Verifier: whether servers send the right pixels. When a frame has all its rows, the device renders some pixels of
// each server's rows again, chosen at random behind the servers' backs, and compares them byte for byte. One that has
// sent a wrong pixel is dropped with one line and never used again, and its rows of the frame are rendered anew. A
// wrong pixel that is not among those checked is shown: spot_check.h tells how likely a lie is found. A device without
// the scene compares rows of one server with the same rows of another, and asks a third where they differ. With two it
// cannot tell who lies: it says so once, in one line, and the picture counts as disputed.
#pragma once
#include "base/arena.h"
#include "base/span.h"
#include "base/status.h"
#include "effect/settings.h"
#include "split/smooth.h"
#include "split/spot_check.h"

namespace pocketray {

struct Client;
struct Renderer;

constexpr int kCheckCountAuto = -1;   // as many checks as take kCheckShare of the time
constexpr double kCheckShare = 0.01;  // of the frames' time

// Of a server, since the client was made.
struct ServerChecks {
  std::uint64_t rows = 0;     // of it that were shown
  std::uint64_t checked = 0;  // pixels, or rows where the device has no scene; none of them was wrong
  // Had one row been wrong in each frame: the probability that it would have been dropped by now.
  double caught_row = 0;
  double caught_row_last = 0;  // in the last frame alone
};

// Of what two servers sent for a row, one is wrong.
struct Dispute {
  bool open = false;
  std::uint32_t row = 0, server = 0, other = 0;  // the row is shown as `server` sent it
  std::uint32_t asked = 0;                       // a bit for each server that has sent it
  std::uint32_t judge = ~0u;                     // a third one that is asked; ~0: none yet
  bool judged = false;                           // and has answered
};

struct Verifier {
  int check_count = kCheckCountAuto;
  Rng random;  // its seed is a secret
  CheckSchedule schedule;
  Smoothed check_ns;                              // that a pixel takes; without the scene, that all servers' rows take
  std::uint32_t frame = 0, due_count = 0;         // checks of that frame
  std::uint32_t sent_rows[kServerCountMax] = {};  // that each server had sent when last checked
  Array<std::uint16_t> rows;                      // scratch: those of a server
  Array<std::uint32_t> picks;
  Array<Span> spans;           // pixels to check
  Array<std::uint8_t> pixels;  // as they should be
  // Without the scene.
  bool is_asking = false;  // rows of one server of another, or of a judge
  std::uint64_t ask_ns = 0;
  Dispute dispute;
  Array<std::uint8_t> versions[2];  // of the row, as the two sent it
  bool again = false;               // rows have been replaced: they are to be checked, too
  bool disputed = false;            // it could not be settled
};

std::size_t verifier_need(const Settings& settings);
// `entropy` as in ClientOptions; fails where it does.
Status make_verifier(int check_count, bool (*entropy)(void*, std::size_t), const Settings& settings, Arena* arena,
                     Verifier* verifier);

// Checks a frame that has all its rows. True: it is as good as checks can tell, and may be ended. False: rows are
// missing again, or answers are awaited.
bool is_verified(Renderer* renderer, Client* client);

}  // namespace pocketray
