#include "desktop/accuracy/callgrind.h"

#include <cctype>
#include <cstdlib>

namespace pocketray {
namespace {

// Returns the text after `name` at the start of a line other than the first; null if not found.
const char* value_of(const std::string& text, const std::string& name) {
  std::size_t at = text.find("\n" + name);
  return at == std::string::npos ? nullptr : text.c_str() + at + 1 + name.size();
}

}  // namespace

bool read_callgrind_dump(const std::string& text, std::uint64_t* instructions) {
  // `totals:` is written last; `summary:` is at the top.
  const char* total = value_of(text, "totals: ");
  if (!value_of(text, "desc: Trigger: --dump-before=") || !total || text.back() != '\n') return false;
  if (!std::isdigit(static_cast<unsigned char>(*total))) return false;
  *instructions = std::strtoull(total, nullptr, 10);
  return true;
}

}  // namespace pocketray
