// Misbehaving readers, each in a child process.
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <thread>
#include <vector>

#include "desktop/import/contained.h"
#include "desktop/import/import_error.h"
#include "import/import_testing.h"

using namespace pocketray;

namespace {

constexpr ContainerLimits kLimits = {std::uint64_t(128) << 20, 1, 3600, 1u << 20};  // the clock ends none

std::string error_of(const std::function<void(ImportedScene*)>& read, const ContainerLimits& limits = kLimits) {
  ImportedScene result;
  try {
    import_contained(limits, read, &result);
  } catch (const ImportError& error) {
    return error.what();
  }
  return "";
}

// A scene of one triangle in memory of its own.
void make_triangle(ImportedScene* imported) {
  struct Arrays {
    Vec3 positions[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    Triangle triangle = Triangle(0, 1, 2, 0);
    Material material;
  };
  auto arrays = std::make_shared<Arrays>();
  imported->scene.positions = {arrays->positions, 3};
  imported->scene.triangles = {&arrays->triangle, 1};
  imported->scene.materials = {&arrays->material, 1};
  imported->storage = arrays;
  imported->warning = "not used: a hat";
  imported->parts = {{"brim of hat", {{-1, 0.1f, 0}, {1, 1e30f, 3}}}, {"two\nlines", {{0, 0, 0}, {0, 0, 0}}}};
  imported->material_names = {"felt", "", "two\nlines"};
  imported->files = {"hat.dae", "two\nlines.png", " file x"};
}

}  // namespace

// Goal: the scene, warning and names of a contained reader arrive. Method: a triangle; all descriptors are closed
// again.
TEST_CASE("contained_scene_and_warning_arrive") {
  int before = dup(0);
  close(before);
  for (int round = 0; round < 3; ++round) {
    ImportedScene result;
    import_contained(kLimits, make_triangle, &result);
    REQUIRE(result.scene.triangles.count == 1);
    CHECK(result.scene.positions[1] == Vec3{1, 0, 0});
    CHECK(result.warning == "not used: a hat");
    REQUIRE(result.parts.size() == 2);
    CHECK(result.parts[0].first == "brim of hat");
    CHECK(result.parts[0].second.low == Vec3{-1, 0.1f, 0});
    CHECK(result.parts[0].second.high == Vec3{1, 1e30f, 3});
    CHECK(result.parts[1].first == "two lines");
    CHECK(result.material_names == std::vector<std::string>{"felt", "", "two lines"});
    CHECK(result.files == std::vector<std::string>{"hat.dae", "two\nlines.png", " file x"});
  }
  int after = dup(0);
  close(after);
  CHECK(after == before);
}

// Goal: a reader that crashes, throws, loops, or allocates too much ends in one line, and this process continues; its
// output and changes are not visible. Method: each once.
TEST_CASE("contained_reader_takes_nothing_with_it") {
  CHECK(contains(error_of([](ImportedScene*) { std::raise(SIGSEGV); }), "signal 11"));
  CHECK(contains(error_of([](ImportedScene*) { std::raise(SIGBUS); }), "signal 7"));
  CHECK(contains(error_of([](ImportedScene*) { std::abort(); }), "signal 6"));
  CHECK(contains(error_of([](ImportedScene*) { _exit(0); }), "crash"));
  CHECK(contains(error_of([](ImportedScene*) { std::raise(SIGINT); }), "interrupted"));
  CHECK(error_of([](ImportedScene*) { fail_import("line %d is no line", 7); }) == "line 7 is no line");
  CHECK(contains(error_of([](ImportedScene*) { throw 7; }), "cannot be read"));
  CHECK(contains(error_of([](ImportedScene*) {
                   for (volatile std::uint64_t i = 0;; i = i + 1) {
                   }
                 }),
                 "more than 1 seconds of processor time"));
  std::string damaged = error_of([](ImportedScene* imported) {
    make_triangle(imported);
    static const Triangle beyond = Triangle(0, 1, 9, 0);
    imported->scene.triangles.data = &beyond;
  });
  CHECK_MESSAGE(contains(damaged, "triangle"), damaged);
  int touched = 0;
  error_of([&](ImportedScene* imported) { touched = 1, make_triangle(imported); });
  CHECK(touched == 0);
#if !defined(__SANITIZE_ADDRESS__)
  CHECK(contains(error_of([](ImportedScene* imported) {
                   char* volatile many =
                       new char[std::size_t(1) << 30];  // visible outside, so the compiler cannot omit it
                   make_triangle(imported);
                   delete[] many;
                 }),
                 "not enough memory"));
#endif
}

// Goal: a reader that waits forever, and so takes no processor time, is ended too. Method: one that sleeps.
TEST_CASE("contained_reader_that_waits_is_ended") {
  ContainerLimits impatient = kLimits;
  impatient.elapsed_seconds = 1;
  const std::string error = error_of(
      [](ImportedScene*) {
        for (;;) pause();
      },
      impatient);
  CHECK_MESSAGE(contains(error, "1 seconds in all"), error);
}

// Goal: a scene beyond the size limit is refused. Method: a limit below that of a triangle.
TEST_CASE("contained_scene_is_no_larger_than_allowed") {
  ImportedScene result;
  CHECK_THROWS_AS(import_contained({0, 1, 3600, 64}, make_triangle, &result), ImportError);
}

#if !defined(__SANITIZE_ADDRESS__)  // whose allocator does not survive a fork beside other threads
// Goal: several threads may read at once. Method: eight, of which half crash.
TEST_CASE("contained_readers_side_by_side") {
  std::atomic<int> read{0}, failed{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i)
    threads.emplace_back([&, i] {
      ImportedScene result;
      try {
        import_contained(
            kLimits, [i](ImportedScene* s) { i % 2 ? make_triangle(s) : std::abort(); }, &result);
        read += result.scene.triangles.count == 1;
      } catch (const ImportError&) {
        ++failed;
      }
    });
  for (std::thread& thread : threads) thread.join();
  CHECK(read == 4);
  CHECK(failed == 4);
}
#endif
