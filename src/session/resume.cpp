#include "session/resume.h"

#include <cinttypes>
#include <cstdlib>
#include <cstring>

#include "base/check.h"
#include "platform/file.h"

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

}  // namespace

FrameJournal::~FrameJournal() {
  if (file) std::fclose(file);
}

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
        "--resume: %.300s is of pictures with another scene, version or options: drop --resume to render all",
        path.c_str());
  const char* at = text.c_str() + head.size();
  // A number without its line's end may have been cut off.
  for (std::size_t digits; (digits = std::strspn(at, "0123456789")) > 0 && digits < 8 && at[digits] == '\n';
       at += digits + 1)
    finished->push_back(static_cast<std::uint32_t>(std::strtoul(at, nullptr, 10)));
  return success();
}

Status begin_journal(const std::string& path, const std::string& identity, const std::vector<std::uint32_t>& finished,
                     FrameJournal* journal) {
  CHECK(journal->file == nullptr);
  platform::FileError error;
  if (!platform::can_write(path.c_str(), &error)) return failure("%.300s %s", path.c_str(), error.text);
  journal->path = path;
  journal->file = std::fopen(path.c_str(), "w");
  if (!journal->file) return failure("%.300s cannot be written", path.c_str());
  std::setvbuf(journal->file, nullptr, _IONBF, 0);  // each number at once, and no buffer to allocate
  std::string text = kHead + identity + "\n";
  for (std::uint32_t frame : finished) text += std::to_string(frame) + "\n";
  if (std::fwrite(text.data(), 1, text.size(), journal->file) == text.size()) return success();
  return failure("%.300s could not be written completely: is the disk full?", path.c_str());
}

void add_to_journal(FrameJournal* journal, std::uint32_t frame) {
  if (!journal->file) return;
  char line[16];
  const int length = std::snprintf(line, sizeof line, "%" PRIu32 "\n", frame);
  CHECK(length > 0 && length < static_cast<int>(sizeof line));
  std::fwrite(line, 1, static_cast<std::size_t>(length), journal->file);
}

void remove_journal(FrameJournal* journal) {
  if (!journal->file) return;
  std::fclose(journal->file);
  journal->file = nullptr;
  std::remove(journal->path.c_str());
}

}  // namespace pocketray
