// Verifier: spot checks of servers' pixels. When a frame has all its rows, the device renders random pixels of each
// server's rows, which servers cannot predict, and compares them byte for byte. A server with a wrong pixel is dropped
// for good with one log line, and its rows of the frame are rendered again. Wrong pixels that are not checked are
// shown: spot_check.h gives the probability of detection. A device without the scene compares one server's rows with
// another's and asks a third if they differ. With only two it cannot tell which is right: it logs that once and the
// picture counts as disputed. Frames shared by effect are not checked, since the device has only its own indirect light
// there; frames by rows come at least every kRetryFrames.
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

constexpr int kCheckCountAuto = -1;   // as many checks as fit in kCheckShare of the time
constexpr double kCheckShare = 0.01;  // of the frames' time: a fifth of what a network may cost (client.cpp)

// Checks of a server since the client was created.
struct ServerChecks {
  std::uint64_t rows = 0;     // shown rows of this server
  std::uint64_t checked = 0;  // pixels, or rows if the device has no scene; none was wrong
  // Probability that the server would have been dropped by now if one row had been wrong in each frame.
  double caught_row = 0;
  double caught_row_last = 0;  // in the last frame only
};

// Two servers sent different pixels for a row.
struct Dispute {
  bool open = false;
  std::uint32_t row = 0, server = 0, other = 0;  // the picture shows `server`'s row
  std::uint32_t asked = 0;                       // bit mask of servers that have sent it
  std::uint32_t judge = ~0u;                     // the third server asked; ~0: none yet
  bool judged = false;                           // the judge has answered
};

struct Verifier {
  int check_count = kCheckCountAuto;
  Rng random;  // secretly seeded
  CheckSchedule schedule;
  Smoothed check_ns;                              // per checked pixel; without the scene, for one row of every server
  std::uint32_t frame = 0, due_count = 0;         // checks for that frame
  std::uint32_t sent_rows[kServerCountMax] = {};  // sent by each server when last checked
  Array<std::uint16_t> rows;                      // scratch: a server's rows
  Array<std::uint32_t> picks;
  Array<Span> spans;           // pixels to check
  Array<std::uint8_t> pixels;  // correct values
  // Without the scene.
  bool is_asking = false;  // waiting for one server's row from another, or from a judge
  std::uint64_t ask_ns = 0;
  Dispute dispute;
  Array<std::uint8_t> versions[2];  // of the disputed row, from the two servers
  bool again = false;               // rows have been replaced and must be checked
  bool disputed = false;            // a dispute could not be settled
};

std::size_t verifier_need(const Settings& settings);
// `entropy` as in ClientOptions; fails if `entropy` fails.
Status make_verifier(int check_count, bool (*entropy)(void*, std::size_t), const Settings& settings, Arena* arena,
                     Verifier* verifier);

// Checks a frame that has all its rows. Returns true if it passes and may be ended; false if rows are missing again or
// answers are due.
bool is_verified(Renderer* renderer, Client* client);

}  // namespace pocketray
