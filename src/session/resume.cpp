#include "session/resume.h"

#include <cinttypes>
#include <cstdlib>
#include <cstring>

#include "base/check.h"

namespace pocketray {
namespace {

const char kHead[] = "pocketray-resume 1 ";
constexpr std::size_t kJournalBytesMax = 16u << 20;  // chosen: two million frames, in lines of at most 8 bytes

Status load_lines(const std::string& path, std::string* text) {
  platform::FileReader file;
  platform::FileError error;
  if (!platform::open_reader(path.c_str(), &file, &error)) return failure("%.300s %s", path.c_str(), error.text);
  bool ok = file.byte_count <= kJournalBytesMax;
  if (ok) text->resize(static_cast<std::size_t>(file.byte_count));
  ok = ok && platform::read_bytes(&file, &(*text)[0], text->size(), &error);
  platform::close_reader(&file);
  return ok ? success() : failure("%.300s is not a list of finished frames: delete it, or drop --resume", path.c_str());
}

bool is_kept(const FrameJournal& journal) { return journal.writer.descriptor >= 0; }

void close(FrameJournal* journal) {
  platform::FileError error;
  if (is_kept(*journal)) (void)platform::close_writer(&journal->writer, &error);  // lost lines only cost time
}

// Returns whether the name is unused or a journal's, whatever its pictures show.
bool is_free(const std::string& path) {
  if (!platform::is_plain_or_absent(path.c_str())) return false;
  if (platform::file_stamp(path.c_str()) == 0) return true;
  platform::FileReader file;
  platform::FileError error;
  char head[sizeof kHead - 1];
  const bool is_journal = platform::open_reader(path.c_str(), &file, &error) && file.byte_count >= sizeof head &&
                          platform::read_bytes(&file, head, sizeof head, &error) &&
                          std::memcmp(head, kHead, sizeof head) == 0;
  platform::close_reader(&file);
  return is_journal;
}

}  // namespace

FrameJournal::~FrameJournal() { close(this); }

std::string journal_path(const std::string& output) { return output + ".resume"; }

Status read_journal(const std::string& path, const std::string& identity, std::vector<std::uint32_t>* finished) {
  CHECK(finished != nullptr && identity.find('\n') == std::string::npos);
  finished->clear();
  if (platform::file_stamp(path.c_str()) == 0) return success();
  std::string text;
  RETURN_IF_ERROR(load_lines(path, &text));
  const std::string head = kHead + identity + "\n";
  if (text.compare(0, sizeof kHead - 1, kHead) != 0)
    return failure("%.300s is not a list of finished frames: delete it, or drop --resume", path.c_str());
  if (text.compare(0, head.size(), head) != 0)
    return failure(
        "--resume: %.300s belongs to pictures with another scene, version or options: drop --resume to render all",
        path.c_str());
  const char* at = text.c_str() + head.size();
  // A number without a line end may have been truncated.
  for (std::size_t digits; (digits = std::strspn(at, "0123456789")) > 0 && digits < 8 && at[digits] == '\n';
       at += digits + 1)
    finished->push_back(static_cast<std::uint32_t>(std::strtoul(at, nullptr, 10)));
  return success();
}

Status begin_journal(const std::string& path, const std::string& identity, const std::vector<std::uint32_t>& finished,
                     FrameJournal* journal) {
  CHECK(!is_kept(*journal));
  platform::FileError error;
  if (!platform::can_write(path.c_str(), &error)) return failure("%.300s %s", path.c_str(), error.text);
  if (!is_free(path))
    return failure(
        "%.300s is not a list of finished frames, for which this name is needed: remove it, or name another -o",
        path.c_str());
  journal->path = path;
  std::string text = kHead + identity + "\n";
  for (std::uint32_t frame : finished) text += std::to_string(frame) + "\n";
  if (platform::open_growing_writer(path.c_str(), text.data(), text.size(), &journal->writer, &error)) return success();
  return failure("%.300s %s", path.c_str(), error.text);
}

void add_to_journal(FrameJournal* journal, std::uint32_t frame) {
  if (!is_kept(*journal)) return;
  char line[16];
  const int length = std::snprintf(line, sizeof line, "%" PRIu32 "\n", frame);
  CHECK(length > 0 && length < static_cast<int>(sizeof line));
  platform::write_bytes(&journal->writer, line, static_cast<std::size_t>(length));
}

void remove_journal(FrameJournal* journal) {
  if (!is_kept(*journal)) return;
  close(journal);
  std::remove(journal->path.c_str());
}

}  // namespace pocketray
