// Flips bits of the sample models and imports, bakes and renders the results: nothing crashes.
#include <dirent.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <csignal>

#include <algorithm>
#include <cstring>
#include <vector>

#include "base/rng.h"
#include "import/import_testing.h"
#include "scene/baked_file.h"
#include "support/effort.h"
#include "support/generated_scene.h"

using namespace pocketray;

namespace {

// A file whose bits are flipped, and the model imported then: itself, or one that names it.
struct Target {
  std::string file, model;
  std::size_t byte_count;
};

bool ends_in_one_of(const std::string& name, const std::vector<const char*>& endings) {
  std::size_t dot = name.rfind('.');
  return dot != std::string::npos &&
         std::any_of(endings.begin(), endings.end(), [&](const char* e) { return name.compare(dot + 1, 9, e) == 0; });
}

std::string content_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

// Models of a folder and below, and the files beside them that they name.
void list_targets(const std::string& folder, std::vector<Target>* targets) {
  std::vector<std::string> models, others;
  DIR* directory = opendir(folder.c_str());
  if (!directory) return;
  while (const dirent* entry = readdir(directory)) {
    std::string name = entry->d_name, path = folder + "/" + name;
    struct stat info;
    if (name[0] == '.' || name == "hostile" || stat(path.c_str(), &info) != 0) continue;
    if (S_ISDIR(info.st_mode)) list_targets(path, targets);
    if (!S_ISREG(info.st_mode)) continue;
    (ends_in_one_of(name, {"glb", "gltf", "obj", "ply"}) ? models : others).push_back(name);
  }
  closedir(directory);
  std::sort(models.begin(), models.end()), std::sort(others.begin(), others.end());
  for (const std::string& model : models) {
    std::string content = content_of(folder + "/" + model), path = folder + "/" + model;
    targets->push_back({path, path, content.size()});
    if (!ends_in_one_of(model, {"gltf", "obj"})) continue;
    for (const std::string& other : others)
      if (content.find(other) != std::string::npos)
        targets->push_back({folder + "/" + other, path, content_of(folder + "/" + other).size()});
  }
}

// Position and bits of a flip.
struct Flip {
  std::size_t target;
  std::uint32_t count;
  std::size_t at[4];
  std::uint8_t bit[4];
};

// Chooses small files more often, as they take less time; half of the flips hit the first kilobytes, where headers are.
Flip make_flip(std::uint64_t number, const std::vector<Target>& targets) {
  Rng rng = make_rng(number, 5);
  double sum = 0;
  auto weight = [](const Target& t) { return 1 / (2000 + static_cast<double>(t.byte_count)); };
  for (const Target& t : targets) sum += weight(t);
  double pick = next_double(&rng) * sum;
  Flip flip = {};
  while (flip.target + 1 < targets.size() && (pick -= weight(targets[flip.target])) > 0) ++flip.target;
  std::size_t bytes = targets[flip.target].byte_count;
  flip.count = next_u32(&rng) % 2 ? 1 : 1 + next_u32(&rng) % 4;
  for (std::uint32_t i = 0; i < flip.count; ++i) {
    std::size_t range = next_u32(&rng) % 2 ? std::min<std::size_t>(bytes, 4096) : bytes;
    flip.at[i] = next_u32(&rng) % range;
    flip.bit[i] = static_cast<std::uint8_t>(1u << next_u32(&rng) % 8);
  }
  return flip;
}

void turn_bits(const Target& target, const Flip& flip) {
  int file = open(target.file.c_str(), O_RDWR | O_CLOEXEC);
  REQUIRE(file >= 0);
  for (std::uint32_t i = 0; i < flip.count; ++i) {
    std::uint8_t byte = 0;
    off_t at = static_cast<off_t>(flip.at[i]);
    REQUIRE(pread(file, &byte, 1, at) == 1);
    byte ^= flip.bit[i];
    REQUIRE(pwrite(file, &byte, 1, at) == 1);
  }
  close(file);
}

// Progress of a batch, shared with its process.
struct Progress {
  std::uint64_t now;  // the current flip
  bool turned;        // its bits are flipped
  std::uint64_t refused, read, rendered;
};

void render_small(const Scene& scene, Progress* progress) {
  Settings settings = settings_for(0, 8, 6);
  settings.memory_bytes = 64u << 20;
  Status status;
  std::unique_ptr<TestRenderer> test = make_renderer(scene, settings, nullptr, &status);
  if (!test) return;
  bool rendered = true;
  for (double seconds : {0.0, 0.7}) rendered = render_frame(&test->renderer, seconds).ok && rendered;
  progress->rendered += rendered;
}

void try_flip(const std::vector<Target>& targets, std::uint64_t number, Progress* progress) {
  Flip flip = make_flip(number, targets);
  const Target& target = targets[flip.target];
  progress->now = number, progress->turned = true;
  turn_bits(target, flip);
  {
    ImportOptions options;
    options.byte_count_max = 256u << 20;
    options.texture_side_max = 4096;
    options.cpu_seconds_max = 20;
    ImportedScene imported;
    Status status = import_scene(target.model, options, &imported);
    ++(status.ok ? progress->read : progress->refused);
    if (status.ok) {
      BakedFile file = bake(imported.scene);
      Scene opened;
      if (!baked_open(file.data(), file.size(), &opened).ok) std::abort();
      render_small(opened, progress);
    }
  }
  turn_bits(target, flip);
  progress->turned = false;
}

// Limits a flip to 30 seconds of CPU time and 1.5 GB of additional address space.
void limit_flip() {
  itimerval limit = {{0, 0}, {30, 0}};
  setitimer(ITIMER_PROF, &limit, nullptr);
}
void limit_memory() {
#if !defined(__SANITIZE_ADDRESS__)
  unsigned long pages = 0;
  std::FILE* file = std::fopen("/proc/self/statm", "r");
  if (file && std::fscanf(file, "%lu", &pages) == 1) {
    rlim_t bytes = static_cast<rlim_t>(pages) * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + (rlim_t(3) << 29);
    rlimit limit = {bytes, bytes};
    setrlimit(RLIMIT_AS, &limit);
  }
  if (file) std::fclose(file);
#endif
}

// Runs flips from `first` to `end` in a child process. Returns the first one not tried; a flip that ended the process
// counts as tried, and *fatal_status says how it ended.
std::uint64_t run_batch(const std::vector<Target>& targets, std::uint64_t first, std::uint64_t end, Progress* progress,
                        int* fatal_status) {
  *fatal_status = 0;
  progress->now = first, progress->turned = false;
  pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    for (int signal_number : {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT, SIGPROF}) signal(signal_number, SIG_DFL);
    limit_memory();
    for (std::uint64_t number = first; number < end; ++number) limit_flip(), try_flip(targets, number, progress);
    _exit(0);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  if (status == 0) return end;
  *fatal_status = status;
  if (progress->turned) {
    Flip flip = make_flip(progress->now, targets);
    turn_bits(targets[flip.target], flip);
  }
  return progress->now + 1;
}

std::uint64_t number_from(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

}  // namespace

// Goal: a model with flipped bits ends in a picture or one line, in bounded time and memory. Method: numbered flips of
// every sample model and its files, in monitored batches. `make flips` runs a hundred thousand.
TEST_CASE("flips_of_every_model_end_in_a_picture_or_one_line") {
  if (!have(shared_scene(""))) return;
  TemporaryFolder folder;
  REQUIRE(std::system(("cp -r '" + shared_scene(".") + "' '" + folder.path + "/scenes' && rm -rf '" + folder.path +
                       "/scenes/hostile' && chmod -R u+w '" + folder.path + "/scenes'")
                          .c_str()) == 0);
  std::vector<Target> targets;
  list_targets(folder.path + "/scenes", &targets);
  REQUIRE(targets.size() > 50);
  std::uint64_t first = number_from("POCKETRAY_FLIP", 1);
  std::uint64_t count = number_from("POCKETRAY_FLIPS", static_cast<std::uint64_t>(effort(300))), end = first + count;
  void* shared = mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  REQUIRE(shared != MAP_FAILED);
  Progress* progress = static_cast<Progress*>(shared);
  std::uint64_t fatal = 0;
  for (std::uint64_t next = first; next < end;) {
    int status = 0;
    next = run_batch(targets, next, std::min(end, next + 500), progress, &status);
    if (status == 0) continue;
    ++fatal;
    const Target& target = targets[make_flip(progress->now, targets).target];
    MESSAGE("flip " << progress->now << ", of " << target.file.substr(folder.path.size())
                    << ", ended the program: " << (WIFSIGNALED(status) ? "signal " : "status ")
                    << (WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status)));
  }
  std::printf(
      "flips %llu to %llu of %zu files: %llu refused, %llu read, of them %llu rendered, %llu ended the program\n",
      static_cast<unsigned long long>(first), static_cast<unsigned long long>(end - 1), targets.size(),
      static_cast<unsigned long long>(progress->refused), static_cast<unsigned long long>(progress->read),
      static_cast<unsigned long long>(progress->rendered), static_cast<unsigned long long>(fatal));
  CHECK(fatal == 0);
  if (count >= 100) CHECK(progress->rendered > count / 10);
  munmap(shared, sizeof(Progress));
}
