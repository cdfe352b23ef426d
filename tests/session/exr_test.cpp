// OpenEXR pictures. Another program compares their values: app/cli_output_test.sh.
#include "session/exr.h"

#include <doctest/doctest.h>

#include <cstring>
#include <vector>

#include "session/picture.h"

using namespace pocketray;

// Goal: a build says whether it has OpenEXR. Method: a path of that kind is accepted or refused in one line.
TEST_CASE("exr_is_there_or_refused") {
  const Status status = check_picture_path("a.exr");
  CHECK(status.ok == has_exr());
  if (!status.ok) CHECK(std::string(status.message).find("has no OpenEXR support: write .pfm") != std::string::npos);
  CHECK(stores_values("a.exr"));
  CHECK(stores_values("a.pfm"));
  CHECK_FALSE(stores_values("a.png"));
}

// Goal: a file begins with the format's magic number. Method: a picture of one pixel.
TEST_CASE("exr_has_its_magic_number") {
  if (!has_exr()) return;
  std::vector<std::uint8_t> written;
  auto append = [](void* to, const void* bytes, std::size_t count) {
    auto* file = static_cast<std::vector<std::uint8_t>*>(to);
    const auto* begin = static_cast<const std::uint8_t*>(bytes);
    file->insert(file->end(), begin, begin + count);
  };
  const float value[3] = {1, 2, 3};
  REQUIRE(encode_exr(value, 1, 1, 3, {append, &written}).ok);
  const std::uint8_t magic[4] = {0x76, 0x2f, 0x31, 0x01};
  REQUIRE(written.size() > sizeof magic);
  CHECK(std::memcmp(written.data(), magic, sizeof magic) == 0);
}
