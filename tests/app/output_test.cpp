// Output files, checked by the commands themselves before their work.
#include "session/output.h"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>

#include "app/commands.h"
#if defined POCKETRAY_HAVE_ACCURACY && defined POCKETRAY_HAVE_NETWORK
#include "app/split_report/split_report_command.h"
#endif
#include "platform/file.h"
#include "session/report.h"

using namespace pocketray;

namespace {

struct Folder {
  char path[32] = "/tmp/pocketray_XXXXXX";
  Folder() { REQUIRE(mkdtemp(path) != nullptr); }
  ~Folder() { platform::remove_folder(path); }
  std::string operator/(const char* name) const { return std::string(path) + "/" + name; }
};

// Runs a command line with output to `out`; returns its exit status.
int run(const std::vector<std::string>& words, const char* out = "/dev/null") {
  int exit_status = kExitDone;
  CommandLine line("pocketray", "");
  Command program = line.program();
  add_render_command(program, OptionalParts(), &exit_status);
  add_bake_command(program, &exit_status);
  add_plan_command(program, &exit_status);
  add_bench_command(program, &exit_status);
#if defined POCKETRAY_HAVE_ACCURACY && defined POCKETRAY_HAVE_NETWORK
  add_split_report_command(program, &exit_status);
#endif
  std::fflush(stdout);
  int kept = dup(STDOUT_FILENO), other = open(out, O_WRONLY);
  REQUIRE(dup2(other, STDOUT_FILENO) >= 0);
  std::string error = line.parse(words).error;
  exit_status = finish_printing(exit_status);
  dup2(kept, STDOUT_FILENO);
  std::clearerr(stdout);
  close(kept), close(other);
  REQUIRE(error == "");
  return exit_status;
}

std::string content(const std::string& path) {
  platform::LoadedFile file;
  platform::FileError error;
  if (!platform::load_file(path.c_str(), &file, &error)) return "";
  std::string text(reinterpret_cast<const char*>(file.bytes), file.byte_count);
  platform::unload_file(&file);
  return text;
}

// Standard error of a failing command line.
std::string told_by(const std::vector<std::string>& words, const std::string& file) {
  int kept = dup(STDERR_FILENO), other = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  REQUIRE(dup2(other, STDERR_FILENO) >= 0);
  int exit_status = run(words);
  dup2(kept, STDERR_FILENO);
  close(kept), close(other);
  CHECK(exit_status == kExitInput);
  return content(file);
}

bool has(const Status& status, const char* part) { return std::strstr(status.message, part) != nullptr; }

}  // namespace

// Goal: no command overwrites its input. Method: a scene and its other names as each output; all stay unchanged.
TEST_CASE("output_is_no_input") {
  Folder folder;
  std::string scene = folder / "scene.pray", other = folder / "other.pray", json = folder / "a.json";
  REQUIRE(run({"bake", "cube", "-o", scene}) == 0);
  REQUIRE(link(scene.c_str(), other.c_str()) == 0);
  REQUIRE(link(scene.c_str(), json.c_str()) == 0);
  REQUIRE(link(scene.c_str(), (folder / "a.ppm").c_str()) == 0);
  std::string before = content(scene);
  CHECK(told_by({"bake", scene, "-o", other}, folder / "told").find("would overwrite") != std::string::npos);
  CHECK(run({"plan", scene, "--json", json}) == 1);
  CHECK(run({"bench", scene, "--size", "8x6", "--frames", "1", "--json", json}) == 1);
  CHECK(run({"bench", scene, "--size", "8x6", "--frames", "1", "--front", other}) == 1);
  CHECK(run({"render", scene, "--size", "8x6", "-o", folder / "a.ppm"}) == 1);
  CHECK(run({"render", scene, "--size", "8x6", "-o", folder / "b.ppm", "--json", json}) == 1);
#if defined POCKETRAY_HAVE_ACCURACY && defined POCKETRAY_HAVE_NETWORK
  CHECK(run({"split-report", scene, "--size", "8x6", "--json", json}) == 1);
#endif
  CHECK(content(scene) == before);
  CHECK(content(folder / "b.ppm").empty());
}

// Goal: files that a scene was read from are known by other names, too, and by nothing else. Method: links of both
// kinds; in a folder, pictures alone count, as results are never named as models are.
TEST_CASE("output_is_nothing_the_scene_was_read_from") {
  Folder folder;
  const std::string texture = folder / "tile.png", materials = folder / "a.mtl";
  REQUIRE(write_file(texture, "tile").ok);
  REQUIRE(write_file(materials, "newmtl").ok);
  REQUIRE(write_file(folder / "other.png", "tile").ok);
  REQUIRE(link(texture.c_str(), (folder / "hard.png").c_str()) == 0);
  REQUIRE(symlink("tile.png", (folder / "soft.png").c_str()) == 0);
  const std::vector<std::string> files = {materials, texture};
  for (const char* name : {"tile.png", "hard.png", "soft.png", "a.mtl"}) {
    const Status status = check_not_read(files, {{"-x", ""}, {"-o", folder / "new.png"}, {"--json", folder / name}});
    CHECK_FALSE(status.ok);
    CHECK(has(status, ("--json " + (folder / name) + " would overwrite ").c_str()));
  }
  CHECK(check_not_read(files, {{"-o", folder / "other.png"}, {"-p", "-"}, {"-q", "/dev/null"}}).ok);
  CHECK(check_not_read({}, {{"-o", texture}}).ok);
  CHECK(has(check_folder_not_read(files, folder.path), "tile.png, which the scene is read from: name another folder"));
  CHECK(check_folder_not_read({materials}, folder.path).ok);
  CHECK(check_folder_not_read(files, "").ok);
  CHECK(check_folder_not_read(files, folder / "none").ok);
}

#if defined POCKETRAY_HAVE_IMPORT
// Goal: no command overwrites a file that its model refers to. Method: the materials of a model as each output; they
// and all else stay unchanged.
TEST_CASE("output_is_no_file_of_the_model") {
  Folder folder;
  const std::string model = folder / "a.obj", materials = folder / "a.mtl";
  REQUIRE(write_file(model, "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl one\nf 1 2 3\n").ok);
  REQUIRE(write_file(materials, "newmtl one\nKd 1 0 0\n").ok);
  for (const char* name : {"a.ppm", "a.gif", "a.pray", "s-0001.ppm"})
    REQUIRE(link(materials.c_str(), (folder / name).c_str()) == 0);
  const std::string before = content(materials);
  const std::vector<std::string> render = {"render", model, "--size", "8x6", "-o"};
  auto renders = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = render;
    words.insert(words.end(), more.begin(), more.end());
    return told_by(words, folder / "told").find("which the scene is read from") != std::string::npos;
  };
  CHECK(renders({folder / "a.ppm"}));
  CHECK(renders({folder / "b.ppm", "--json", materials}));
  CHECK(renders({folder / "a.gif", "--turntable", "3"}));
  CHECK(renders({folder / "s.ppm", "--turntable", "3"}));
  CHECK(run({"bake", model, "-o", folder / "a.pray"}) == 1);
  CHECK(run({"bake", model, "-o", folder / "b.pray", "--json", materials}) == 1);
  CHECK(run({"plan", model, "--json", materials}) == 1);
  CHECK(run({"bench", model, "--size", "8x6", "--frames", "1", "--json", materials}) == 1);
  CHECK(run({"bench", model, "--size", "8x6", "--frames", "1", "--front", materials}) == 1);
  CHECK(content(materials) == before);
  for (const char* name : {"b.ppm", "s-0000.ppm", "s.ppm.resume", "b.pray"}) CHECK(content(folder / name).empty());
  CHECK(run({"render", model, "--size", "8x6", "-o", folder / "b.ppm"}) == 0);
}
#endif

// Goal: a baked scene must end in .pray, so that a slip cannot overwrite a model. Method: other names, and outputs that
// may have any name.
TEST_CASE("output_of_bake_is_named_so") {
  Folder folder;
  for (const char* name : {"a.glb", "a.pray.obj", "a", ".pray"}) {
    CAPTURE(name);
    CHECK(run({"bake", "cube", "-o", folder / name}) == 1);
    CHECK(content(folder / name).empty());
  }
  CHECK(run({"bake", "cube", "-o", folder / "a.pray"}) == 0);
  CHECK(run({"bake", "cube", "-o", "/dev/null"}) == 0);
}

// Goal: an unwritable output is reported before the work. Method: two outputs, the later one impossible: the earlier
// one is not created; a sequence whose last picture is blocked.
TEST_CASE("output_is_asked_for_before_the_work") {
  Folder folder;
  std::string nowhere = folder / "no/such.json", picture = folder / "a.ppm";
  CHECK(run({"render", "cube", "--size", "8x6", "-o", picture, "--json", nowhere}) == 1);
  CHECK(content(picture).empty());
  CHECK(run({"bake", "cube", "-o", folder / "a.pray", "--json", nowhere}) == 1);
  CHECK(content(folder / "a.pray").empty());
  for (const char* option : {"--json", "--front"})
    CHECK(run({"bench", "cube", "--size", "8x6", "--frames", "1", option, nowhere}) == 1);
  CHECK(run({"render", "cube", "--size", "8x6", "-o", picture, "--json", picture}) == 1);
  CHECK(content(picture).empty());
  std::string last = folder / "s-0002.ppm";
  REQUIRE(mkdir(last.c_str(), 0777) == 0);
  CHECK(run({"render", "cube", "--size", "8x6", "--frames", "0:2", "-o", folder / "s.ppm"}) == 1);
  CHECK(content(folder / "s-0000.ppm").empty());
  rmdir(last.c_str());
}

// Goal: a folder for results is created before the work, and a file in its place is reported. Method: a new folder, the
// same again, one in a missing folder, a file.
TEST_CASE("output_folder_is_made") {
  Folder folder;
  std::string made = folder / "made";
  CHECK(make_output_folder(made).ok);
  CHECK(make_output_folder(made).ok);
  CHECK(rmdir(made.c_str()) == 0);  // empty
  CHECK(has(make_output_folder(folder / "no/such"), "no/such"));
  REQUIRE(write_file(folder / "file", "x").ok);
  CHECK(!make_output_folder(folder / "file").ok);
#if defined POCKETRAY_HAVE_ACCURACY && defined POCKETRAY_HAVE_NETWORK
  std::vector<std::string> command = {"split-report", "cube", "--size",    "64x48", "--steps",     "2",
                                      "--frames",     "2",    "-o",        made,    "--device-ns", "5000",
                                      "--server-ns",  "500",  "--no-paper"};
  CHECK(run(command) == 0);
  CHECK(content(made + "/split.csv").size() > 100);
  platform::remove_folder(made.c_str());
#endif
}

// Goal: lost output is an error. Method: a full device; text and JSON.
TEST_CASE("output_that_does_not_arrive_is_an_error") {
  CHECK(run({"plan", "cube"}, "/dev/null") == 0);
  CHECK(run({"plan", "cube"}, "/dev/full") == 1);
  CHECK(run({"plan", "cube", "--json", "-"}, "/dev/full") == 1);
  CHECK(run({"bench", "cube", "--size", "8x6", "--frames", "1", "--no-prices"}, "/dev/full") == 1);
}

// Goal: an empty argument is refused. Method: as a value and as the scene.
TEST_CASE("output_empty_arguments_are_refused") {
  const char* const good[] = {"pocketray", "render", "cube"};
  const char* const value[] = {"pocketray", "render", "cube", "--size", ""};
  const char* const scene[] = {"pocketray", "render", ""};
  CHECK(check_arguments(3, good).ok);
  CHECK(has(check_arguments(5, value), "--size has an empty value"));
  CHECK(has(check_arguments(3, scene), "argument 2"));
}
