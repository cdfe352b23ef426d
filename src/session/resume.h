// Records which pictures of an interrupted sequence are finished: a small text file beside them.
#pragma once
#include <string>
#include <vector>

#include "base/status.h"
#include "platform/file.h"

namespace pocketray {

// "out.png.resume" holds a line that identifies what the pictures show and how they were made, then the number of each
// finished one. A picture is replaced atomically before its number is added, so lost numbers only cost time.
struct FrameJournal {
  std::string path;
  platform::FileWriter writer;  // closed: none is kept

  FrameJournal() = default;
  FrameJournal(const FrameJournal&) = delete;
  FrameJournal& operator=(const FrameJournal&) = delete;
  ~FrameJournal();
};

std::string journal_path(const std::string& output);

// Finds the finished frames of a journal written with this identity; none if there is no journal. Fails if its pictures
// were made differently.
Status read_journal(const std::string& path, const std::string& identity, std::vector<std::uint32_t>* finished);
// Begins a journal with these frames. Allocates its memory here, not later. The user did not choose its name, so
// anything else there is refused: a link, a pipe, a file with other content.
Status begin_journal(const std::string& path, const std::string& identity, const std::vector<std::uint32_t>& finished,
                     FrameJournal* journal);
void add_to_journal(FrameJournal* journal, std::uint32_t frame);
// Removes the file: the sequence is complete.
void remove_journal(FrameJournal* journal);

}  // namespace pocketray
