// Which animations of a glTF file play together, what they drive, and which keys count.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "import/gltf_writer.h"
#include "import/import_testing.h"
#include "import/posed.h"
#include "scene/channel.h"
#include "support/hard_case.h"

using namespace pocketray;

namespace {

std::string channel(int sampler, int node, const char* path) {
  return "{\"sampler\":" + std::to_string(sampler) + ",\"target\":{\"node\":" + std::to_string(node) + ",\"path\":\"" +
         path + "\"}}";
}
std::string animation(const char* name, const std::string& samplers, const std::string& channels) {
  return std::string("{\"name\":\"") + name + "\",\"samplers\":[" + samplers + "],\"channels\":[" + channels + "]}";
}

// Two triangles as nodes 0 and 1; accessors: times (1), places (2), longer times (3).
GltfWriter two_triangles() {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.floats({0, 1});
  w.vec3s({0, 0, 0, 10, 0, 0});
  w.floats({0, 2});
  return w;
}
std::string document(const GltfWriter& w, const std::string& animations) {
  return w.gltf(
      "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"nodes\":[{\"mesh\":0,\"name\":\"A\"},{"
      "\"mesh\":0,\"name\":\"B\",\"translation\":[0,5,0]}],\"scenes\":[{\"nodes\":[0,1]}],\"animations\":[" +
      animations + "]");
}

float x_of(const Pose& pose, const Scene& scene, std::uint32_t mesh) {
  return pose.positions[scene.moving_meshes[mesh].vertex_begin].x;
}

// The x of node 0's triangle at a time of the file's only animation, of these keys.
ImportedScene keyed(const TemporaryFolder& folder, const std::vector<float>& times) {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  w.floats(times);
  std::vector<float> places;
  for (std::size_t i = 0; i < times.size(); ++i) places.insert(places.end(), {static_cast<float>(10 * i), 0, 0});
  w.vec3s(places);
  return load(
      folder.write("k.gltf", document(w, animation("k", "{\"input\":1,\"output\":2}", channel(0, 0, "translation")))));
}

}  // namespace

// Goal: animations that drive different nodes play together; one that drives what another drives is left out and named,
// and can be chosen. Method: A, B and a second one of A, of different lengths.
TEST_CASE("gltf_animations_that_do_not_collide_play_together") {
  TemporaryFolder folder;
  GltfWriter w = two_triangles();
  const std::string short_key = "{\"input\":1,\"output\":2}", long_key = "{\"input\":3,\"output\":2}";
  ImportedScene imported =
      load(folder.write("a.gltf", document(w, animation("first", short_key, channel(0, 0, "translation")) + "," +
                                                  animation("again", short_key, channel(0, 0, "translation")) + "," +
                                                  animation("other", long_key, channel(0, 1, "translation")))));
  const Scene& s = imported.scene;
  REQUIRE(s.animations.count == 4);
  REQUIRE(s.animation_labels.count == 4);
  CHECK(s.animation_labels[0].combines == 1);
  CHECK(std::string(s.animation_labels[2].name) == "again");
  CHECK(std::string(s.animation_labels[3].drives) == "node 1 'B' (translation)");
  CHECK(contains(imported.warning, "1 'again'"));
  CHECK(s.animations[0].duration == 2);
  CHECK(s.info.frame_count == 60);
  Posed posed(s);
  pose_at(s, 0, 0.5, &posed.pose);
  CHECK(x_of(posed.pose, s, 0) == 5);
  CHECK(x_of(posed.pose, s, 1) == 2.5f);
  pose_at(s, 0, 1.5, &posed.pose);
  CHECK(x_of(posed.pose, s, 0) == 10);  // the shorter one holds its end
  CHECK(x_of(posed.pose, s, 1) == 7.5f);
  pose_at(s, 3, 1, &posed.pose);
  CHECK(x_of(posed.pose, s, 0) == 0);
  CHECK(x_of(posed.pose, s, 1) == 5);
  pose_at(s, kNone, 1, &posed.pose);
  CHECK(x_of(posed.pose, s, 1) == 0);
  ImportOptions still;
  still.animations = false;
  ImportedScene resting = load(folder.path + "/a.gltf", still);
  CHECK(resting.scene.animations.count == 0);
  CHECK(resting.scene.moving_meshes.count == 0);
}

// Goal: HARDCASES row 67: of keys at equal times the last counts; keys an ulp apart are finite; descending ones are
// refused with a line. Method: positions at and around the keys.
TEST_CASE("hard_67_of_keys_at_equal_times_the_last_counts") {
  count_assertions("position at and around the key");
  TemporaryFolder folder;
  ImportedScene equal = keyed(folder, {0, 1, 1, 1, 2});
  CHECK(contains(equal.warning, "equal times"));
  REQUIRE(equal.scene.channels.count == 1);
  CHECK(equal.scene.channels[0].key_count == 3);
  Posed posed(equal.scene);
  const double around[][2] = {{0, 0}, {0.5, 15}, {1, 30}, {1.5, 35}};
  for (const auto& at : around) {
    pose_at(equal.scene, 0, at[0], &posed.pose);
    CHECK(static_cast<double>(x_of(posed.pose, equal.scene, 0)) == at[1]);
  }
  CHECK(keyed(folder, {0, 0, 1}).scene.channels[0].key_count == 2);
  const float next = std::nextafter(1.0f, 2.0f);
  ImportedScene close = keyed(folder, {0, 1, next, 2});
  CHECK(close.scene.channels[0].key_count == 4);
  Posed near(close.scene);
  for (double time : {1.0, 0.5 * (1 + static_cast<double>(next)), static_cast<double>(next)}) {
    pose_at(close.scene, 0, time, &near.pose);
    const float x = x_of(near.pose, close.scene, 0);
    CHECK((x >= 10 && x <= 20));
  }
  ImportedScene descending = keyed(folder, {0, 2, 1});
  CHECK(contains(descending.warning, "node 0 'A' (translation) is left out: its keys descend"));
  CHECK(!is_animated(descending.scene));
}

namespace {

// A time at which a track of keys is asked for its place, and the place by exact arithmetic.
struct Moment {
  const ImportedScene* imported;
  const std::vector<float>* times;
  double time, place;
};

// The last of keys at equal times counts.
double place_at(const std::vector<float>& times, double time) {
  const auto begin = times.begin();
  const auto next = std::find_if(begin, times.end(), [&](float key) { return static_cast<double>(key) > time; });
  const auto last = next - begin - 1;
  if (next == times.end()) return 10.0 * static_cast<double>(last);
  const auto after = std::upper_bound(next, times.end(), *next) - begin - 1;
  const long double from = static_cast<long double>(times[static_cast<std::size_t>(last)]);
  const long double part = (static_cast<long double>(time) - from) / (static_cast<long double>(*next) - from);
  return 10 * static_cast<double>(static_cast<long double>(last) + part * static_cast<long double>(after - last));
}

float place_by_ours(const Moment& moment) {
  const Scene& scene = moment.imported->scene;
  float place[3];
  channel_value(scene, scene.channels[0], moment.time, 3, place);
  return place[0];
}

// As textbooks have it: the first interval that holds the time, and all of it in floats.
float place_in_floats(const Moment& moment) {
  const std::vector<float>& times = *moment.times;
  const auto time = static_cast<float>(moment.time);
  if (time < times[0]) return 0;
  for (std::size_t i = 0; i + 1 < times.size(); ++i)
    if (time <= times[i + 1]) return 10 * (static_cast<float>(i) + (time - times[i]) / (times[i + 1] - times[i]));
  return static_cast<float>(10 * (times.size() - 1));
}

}  // namespace

// Goal: between keys at equal and nearly equal times the place is the exact one, where floats give the first of equal
// keys, 0/0 or either neighbour. Method: tracks from 0 and from 1,000 s on; times at, between and around the keys.
TEST_CASE("hard_67_key_times_by_ordinary_interpolation") {
  TemporaryFolder folder;
  Rng rng = make_rng(67);
  const auto track_count = static_cast<std::size_t>(gate_share(100, 1000));
  std::vector<std::vector<float>> tracks(track_count);
  std::vector<ImportedScene> imported;
  std::vector<Moment> moments;
  for (std::vector<float>& times : tracks) {
    times.push_back(next_u32(&rng) % 2 ? 0.0f : 1000.0f);
    for (int key = 1; key < 6; ++key) {
      const float last = times.back(), steps[] = {0, std::nextafter(last, 2e9f) - last, 0.1f + next_float(&rng)};
      times.push_back(last + steps[key == 5 ? 2 : next_u32(&rng) % 3]);
    }
    imported.push_back(keyed(folder, times));
    REQUIRE(imported.back().scene.channels.count == 1);
  }
  for (std::size_t i = 0; i < track_count; ++i)
    for (std::size_t key = 0; key + 1 < tracks[i].size(); ++key) {
      const auto from = static_cast<double>(tracks[i][key]), to = static_cast<double>(tracks[i][key + 1]);
      for (const double time : {from, from + 0.25 * (to - from), from + 0.5 * (to - from), to})
        moments.push_back({&imported[i], &tracks[i], time, place_at(tracks[i], time)});
    }
  auto is_wrong = [](const Moment& moment, float place) {
    return !(std::fabs(static_cast<double>(place) - moment.place) < 0.001);
  };
  const Answers ours = time_answers(moments, place_by_ours, is_wrong),
                plain = time_answers(moments, place_in_floats, is_wrong);
  CHECK(ours.wrong == 0);
  CHECK(plain.wrong > 0);
  count_beside("first interval, in floats", "place at a time", moments.size(), plain, ours);
  count_hard(moments.size(), ours.wrong, "the exact place within 1/10,000 of a step");
}

// Goal: KHR_animation_pointer drives visibility, lights, cameras and materials; what it cannot drive is named. Method:
// values half-way between keys.
TEST_CASE("gltf_animation_pointers_drive_lights_cameras_and_materials") {
  GltfWriter w;
  w.vec3s({0, 0, 0, 1, 0, 0, 0, 1, 0});
  const int times = w.floats({0, 1}), colors = w.vec3s({1, 0, 0, 0, 1, 0}), numbers = w.floats({2, 4}),
            rgba = w.add<float>({0, 0, 0, 1, 1, 0.5f, 0, 1}, "VEC4", 4, 5126);
  auto sampler = [&](int output) {
    return "{\"input\":" + std::to_string(times) + ",\"output\":" + std::to_string(output) + "}";
  };
  auto pointer = [](int index, const std::string& path) {
    return "{\"sampler\":" + std::to_string(index) +
           ",\"target\":{\"path\":\"pointer\",\"extensions\":{"
           "\"KHR_animation_pointer\":{\"pointer\":\"" +
           path + "\"}}}}";
  };
  const std::string lights = "/extensions/KHR_lights_punctual/lights/0/";
  TemporaryFolder folder;
  ImportedScene imported = load(folder.write(
      "a.gltf",
      w.gltf(
          "\"extensionsUsed\":[\"KHR_animation_pointer\"],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}"
          ","
          "\"material\":0}]}],\"materials\":[{\"emissiveFactor\":[1,1,1],\"pbrMetallicRoughness\":{\"metallicFactor\":"
          "0}}],"
          "\"nodes\":[{\"mesh\":0},{\"camera\":0,\"extensions\":{\"KHR_lights_punctual\":{\"light\":0}}}],\"scenes\":[{"
          "\"nodes\":[0,1]}],\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.5,\"znear\":0.1}}],"
          "\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"point\",\"intensity\":8}]}},\"animations\":"
          "[{"
          "\"samplers\":[" +
          sampler(colors) + "," + sampler(numbers) + "," + sampler(rgba) + "],\"channels\":[" +
          pointer(1, lights + "intensity") + "," + pointer(0, lights + "color") + "," +
          pointer(1, "/cameras/0/perspective/yfov") + "," +
          pointer(2, "/materials/0/pbrMetallicRoughness/baseColorFactor") + "," +
          pointer(0, "/materials/0/emissiveFactor") + "," + pointer(1, "/materials/0/normalTexture/scale") + "]}]")));
  const Scene& s = imported.scene;
  CHECK(contains(imported.warning, "animation of /materials/{}/normalTexture/scale"));
  REQUIRE(s.animations.count == 1);
  CHECK(is_animated(s));
  Posed posed(s);
  pose_at(s, 0, 0.5, &posed.pose);
  CHECK(posed.pose.lights[0].intensity == Vec3{1.5f, 1.5f, 0});  // colour ½, ½, 0 times 3
  CHECK(posed.pose.cameras[0].vertical_fov == 3.0f);
  CHECK(posed.pose.materials[0].diffuse == Vec3{0.5f, 0.25f, 0});
  CHECK(posed.pose.materials[0].emission == Vec3{0.5f, 0.5f, 0});
}
