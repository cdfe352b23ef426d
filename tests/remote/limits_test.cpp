// One table of limits serves the command line, files and messages.
#include <doctest/doctest.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "base/limit_list.h"
#include "engine/frame.h"
#include "scene/baked_file.h"
#include "scene/builtin_helpers.h"
#include "session/open_scene.h"
#include "support/generated_scene.h"
#include "wire/message.h"

using namespace pocketray;

namespace {

std::string text_of(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", x);
  return text;
}

// ---- the command line

bool settings_accept(const std::function<void(CommonOptions*)>& set) {
  CommonOptions options;
  set(&options);
  Settings settings;
  return read_settings(options, &settings).ok;
}
bool camera_accepts(int place, const std::string& number) {
  std::string text;
  const char* rest[10] = {"1", "2", "3", "0", "0", "0", "0", "1", "0", "40"};
  for (int i = 0; i < 10; ++i) text += (i ? "," : "") + (i == place ? number : std::string(rest[i]));
  Camera camera;
  return parse_camera(text, &camera).ok;
}
// Maps values that are not counts to a count beyond any limit.
std::uint32_t count_of(double x) { return x >= 0 && x <= 1e9 ? static_cast<std::uint32_t>(x) : ~std::uint32_t(0); }
// The setting with these limits; null if none.
const SettingRow* setting_of(Quantity quantity) {
  for (const SettingRow& row : kSettingList)
    if (row.field.kind != SettingKind::choice && row.field.quantity == quantity) return &row;
  return nullptr;
}
bool option_accepts(Quantity quantity, double x) {
  std::uint32_t count = count_of(x);
  bool accepted = true;
  if (const SettingRow* row = setting_of(quantity))
    return settings_accept([&](CommonOptions* o) {
      o->settings[row->name].count = count;
      o->settings[row->name].real = static_cast<float>(x);
    });
  switch (quantity) {
    case Quantity::width:
      return settings_accept([&](CommonOptions* o) { o->size = text_of(x) + "x1"; });
    case Quantity::height:
      return settings_accept([&](CommonOptions* o) { o->size = "1x" + text_of(x); });
    case Quantity::camera_index:
      return settings_accept([&](CommonOptions* o) { o->camera_index = count; });
    case Quantity::texture_side:
      return settings_accept([&](CommonOptions* o) { o->texture_side_max = count; });
    case Quantity::coordinate:
      for (int place = 0; place < 9; ++place) accepted = accepted && camera_accepts(place, text_of(x));
      return accepted;
    case Quantity::field_of_view:  // degrees
      return camera_accepts(9, x < double(kFieldOfViewMin)    ? "0.0009999"
                               : x == double(kFieldOfViewMin) ? "0.001"
                               : x == double(kFieldOfViewMax) ? "179"
                               : x > double(kFieldOfViewMax)  ? "179.0001"
                                                              : text_of(x));
    case Quantity::exposure: {
      float exposure = 1;
      return change_exposure(static_cast<float>(x), &exposure).ok;
    }
    default:
      return within(quantity, x);  // tests/app/numbers_test.sh types them
  }
}

// ---- a file

bool file_accepts(Quantity quantity, double x) {
  Scene scene;
  std::vector<Camera> cameras(1);
  Node nodes[1];
  float key_time = 0;
  Vec3 corner = {0, 0, 0};
  auto real = static_cast<float>(x);
  if (quantity == Quantity::coordinate) corner.y = cameras[0].up.x = real;
  if (quantity == Quantity::field_of_view) cameras[0].vertical_fov = real;
  if (quantity == Quantity::vertical_extent) cameras[0].vertical_extent = real;
  if (quantity == Quantity::camera_index) cameras.resize(static_cast<std::size_t>(x) + 1);
  if (quantity == Quantity::seconds) key_time = real;
  if (quantity == Quantity::exposure) scene.info.exposure = real;
  if (quantity == Quantity::frame_rate) scene.info.frames_per_second = real;
  scene.positions = {&corner, 1};
  scene.cameras = {cameras.data(), static_cast<std::uint32_t>(cameras.size())};
  scene.nodes = {nodes, 1};
  scene.key_times = {&key_time, 1};
  BakedFile file = bake(scene);
  Scene opened;
  return baked_open(file.data(), file.size(), &opened).ok;
}

// ---- a message

struct Field {
  Quantity quantity;
  MessageType type;
  std::function<void(Message*, double)> set;
  std::uint32_t byte_count;  // 1 and 2: an integer; 4 and 8: a float and a double
};

template <class T>
void take(T* field, double x) {
  *field = static_cast<T>(x);
}

std::vector<Field> message_fields() {
  std::vector<Field> fields;
  for (MessageType type : {MessageType::frame_request, MessageType::view_query}) {
    auto settings = [](Message* m) {
      return m->type == MessageType::frame_request ? &m->frame_request.settings : &m->view_query.settings;
    };
    fields.push_back({Quantity::width, type, [=](Message* m, double x) { take(&settings(m)->width, x); }, 2});
    fields.push_back({Quantity::height, type, [=](Message* m, double x) { take(&settings(m)->height, x); }, 2});
    fields.push_back(
        {Quantity::texture_side, type, [=](Message* m, double x) { take(&settings(m)->texture_side_max, x); }, 2});
    for (const SettingRow& row : kSettingList)
      if (row.field.kind != SettingKind::choice)
        fields.push_back({row.field.quantity, type, [=, &row](Message* m, double x) { row.field.set(settings(m), x); },
                          row.wire_bytes});
  }
  fields.push_back({Quantity::camera_index, MessageType::frame_request,
                    [](Message* m, double x) { take(&m->frame_request.camera_index, x); }, 2});
  fields.push_back({Quantity::camera_index, MessageType::view_query,
                    [](Message* m, double x) { take(&m->view_query.camera_index, x); }, 2});
  for (MessageType type : {MessageType::frame_request, MessageType::frame_change})
    fields.push_back({Quantity::seconds, type, [](Message* m, double x) { m->frame_request.seconds = x; }, 8});
  for (MessageType type : {MessageType::hello, MessageType::row_chunk, MessageType::pong})
    fields.push_back({Quantity::price, type,
                      [](Message* m, double x) {
                        take(m->type == MessageType::hello       ? &m->hello.price
                             : m->type == MessageType::row_chunk ? &m->row_chunk.price
                                                                 : &m->pong.price,
                             x > UINT16_MAX ? 1 : x);  // 0 is none in a chunk
                      },
                      2});
  fields.push_back({Quantity::frame_rate, MessageType::view_entry,
                    [](Message* m, double x) { take(&m->view_entry.frames_per_second, x); }, 4});
  fields.push_back(
      {Quantity::exposure, MessageType::view_entry, [](Message* m, double x) { take(&m->view_entry.exposure, x); }, 4});
  fields.push_back({Quantity::exposure, MessageType::frame_request,
                    [](Message* m, double x) { take(&m->frame_request.exposure, x); }, 4});
  for (MessageType type :
       {MessageType::frame_request, MessageType::frame_change, MessageType::view_query, MessageType::view_entry}) {
    auto camera = [](Message* m) {
      return m->type == MessageType::view_query   ? &m->view_query.camera
             : m->type == MessageType::view_entry ? &m->view_entry.camera
                                                  : &m->frame_request.camera;
    };
    const bool is_change = type == MessageType::frame_change;  // has no up vector and no lens
    for (int i = 0; i < (is_change ? 6 : 9); ++i)
      fields.push_back({Quantity::coordinate, type,
                        [=](Message* m, double x) {
                          Vec3* v = i < 3 ? &camera(m)->eye : i < 6 ? &camera(m)->target : &camera(m)->up;
                          take(i % 3 == 0 ? &v->x : i % 3 == 1 ? &v->y : &v->z, x);
                        },
                        4});
    if (is_change) continue;
    fields.push_back(
        {Quantity::field_of_view, type, [=](Message* m, double x) { take(&camera(m)->vertical_fov, x); }, 4});
    fields.push_back(
        {Quantity::vertical_extent, type, [=](Message* m, double x) { take(&camera(m)->vertical_extent, x); }, 4});
  }
  return fields;
}

Message message_with(const Field& field, double x) {
  Message message;
  message.type = field.type;
  message.frame_request.row_end = message.row_chunk.row_count = 1;
  message.view_entry.bounds = {{0, 0, 0}, {1, 1, 1}};
  field.set(&message, x);
  return message;
}

std::vector<std::uint8_t> bytes_with(const Field& field, double x) {
  Message message = message_with(field, x);
  std::vector<std::uint8_t> bytes(message_bytes(message));
  encode_message(message, bytes.data());
  return bytes;
}

// The encoder's limits, checked before encoding.
bool sender_accepts(const Field& field, double x) { return can_encode(message_with(field, x)); }

// The decoder's limits, with bytes our encoder never writes: the field is located by what changes with its lowest byte.
bool receiver_accepts(const Field& field, double x) {
  const double valid = field.quantity == Quantity::price ? kPriceUnit : 1;
  double other = field.byte_count <= 2   ? valid + 1
                 : field.byte_count == 4 ? double(std::nextafterf(1, 0))
                                         : std::nextafter(1.0, 0.0);
  std::vector<std::uint8_t> bytes = bytes_with(field, valid), changed = bytes_with(field, other);
  std::size_t at = kHeaderBytes;
  while (at < bytes.size() && bytes[at] == changed[at]) ++at;
  REQUIRE(at + field.byte_count <= bytes.size());
  std::uint32_t integer = count_of(x);
  auto single = static_cast<float>(x);
  const void* from = field.byte_count <= 2   ? static_cast<const void*>(&integer)
                     : field.byte_count == 4 ? static_cast<const void*>(&single)
                                             : &x;
  std::memcpy(&bytes[at], from, field.byte_count);
  uLong sum =
      crc32(crc32(0, bytes.data(), 4), bytes.data() + kHeaderBytes, static_cast<uInt>(bytes.size() - kHeaderBytes));
  for (int i = 0; i < 4; ++i) bytes[4 + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(sum >> 8 * i);
  Message message;
  return decode_message(bytes.data(), bytes.size(), kMessageBytesMax, &message).state == DecodeState::message;
}

bool is_count(Quantity q) {
  return q == Quantity::width || q == Quantity::height || q == Quantity::samples || q == Quantity::depth ||
         q == Quantity::edge_samples || q == Quantity::area_light_points || q == Quantity::virtual_lights ||
         q == Quantity::environment_shadows || q == Quantity::texture_side || q == Quantity::camera_index ||
         q == Quantity::price;
}
// Quantities stored in files.
bool is_in_files(Quantity q) {
  return q == Quantity::coordinate || q == Quantity::field_of_view || q == Quantity::vertical_extent ||
         q == Quantity::camera_index || q == Quantity::seconds || q == Quantity::exposure || q == Quantity::frame_rate;
}

struct Value {
  double x;
  bool good;
};

// The limits, values just beyond, and non-numbers.
std::vector<Value> values_of(const LimitRow& row) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  if (is_count(row.quantity)) {
    std::vector<Value> values = {{row.low, true}, {row.high, true}, {row.high + 1, false}};
    if (row.low > 0) values.push_back({row.low - 1, false});
    return values;
  }
  auto low = static_cast<float>(row.low), high = static_cast<float>(row.high);
  return {{row.low, true},
          {row.high, true},
          {static_cast<double>(std::nextafterf(low, -HUGE_VALF)), false},
          {static_cast<double>(std::nextafterf(high, HUGE_VALF)), false},
          {kNan, false},
          {-kNan, false},
          {kInf, false},
          {-kInf, false}};
}

}  // namespace

// Goal: command line, file and message accept the same numbers, so that none accepts a value that a later CHECK
// rejects. Method: for each row of the table, both limits on every path, just beyond, NaN and infinities; every row
// must be used by a message and, but for prices, at least one other path.
TEST_CASE("limits_are_the_same_for_command_line_file_and_wire") {
  const std::vector<Field> fields = message_fields();
  for (const LimitRow& row : kLimitList) {
    CAPTURE(row.name);
    int message_count = 0;
    for (const Value& value : values_of(row)) {
      CAPTURE(value.x);
      if (row.quantity != Quantity::frame_rate && row.quantity != Quantity::vertical_extent &&
          row.quantity != Quantity::price)
        CHECK(option_accepts(row.quantity, value.x) == value.good);
      if (is_in_files(row.quantity)) CHECK(file_accepts(row.quantity, value.x) == value.good);
      for (const Field& field : fields)
        if (field.quantity == row.quantity) {
          CAPTURE(static_cast<int>(field.type));
          CHECK(sender_accepts(field, value.x) == value.good);
          CHECK(receiver_accepts(field, value.x) == value.good);
          ++message_count;
        }
    }
    CHECK(message_count > 0);
  }
}

// Goal: stops on the command line have exactly the range of exposures, also multiplied by the scene's.
TEST_CASE("limits_of_stops_are_those_of_exposures") {
  ExposureChoice choice;
  float factor;
  for (const char* good : {"60", "-60", "0", "1.5", "auto", "fixed", "fixed,60", "fixed,-60"})
    CHECK(parse_exposure(good, &choice, &factor).ok);
  for (const char* bad :
       {"60.001", "-60.001", "61", "nan", "inf", "-inf", "1e30", "x", "fixed,61", "fixed,", "fixed,auto"})
    CHECK(!parse_exposure(bad, &choice, &factor).ok);
  for (const char* end : {"60", "-60"}) {
    REQUIRE(parse_exposure(end, &choice, &factor).ok);
    float exposure = 1;
    CHECK(change_exposure(factor, &exposure).ok);
    CHECK(within(Quantity::exposure, exposure));
    exposure = factor;
    Status status = change_exposure(factor, &exposure);
    CHECK(!status.ok);
    CHECK(std::strstr(status.message, "exposure") != nullptr);
  }
}

// Goal: no frame is prepared for a time or camera beyond the limits. Method: values a library's caller may pass.
TEST_CASE("limits_hold_for_frames") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  std::unique_ptr<BuiltScene> built = build_builtin("cube");
  Settings settings;
  settings.width = 16, settings.height = 12;
  std::unique_ptr<TestRenderer> test = make_renderer(built->scene, settings);
  Renderer* renderer = &test->renderer;
  for (double good : {0.0, -kSecondsMax, kSecondsMax}) CHECK(begin_frame(renderer, {good}).ok);
  for (double bad : {kNan, kInf, -kInf, 2e9, -2e9, 1e300}) {
    Status status = begin_frame(renderer, {bad});
    CHECK(!status.ok);
    CHECK(std::strstr(status.message, "seconds") != nullptr);
  }
  for (double bad : {kNan, kInf, -kInf, 1.1e18, -1.1e18})
    for (int place = 0; place < 9; ++place) {
      Camera camera = renderer->view.camera;
      (place < 3 ? &camera.eye.x : place < 6 ? &camera.target.x : &camera.up.x)[place % 3] = static_cast<float>(bad);
      CHECK(!set_camera(renderer, camera).ok);
    }
  CHECK(set_camera(renderer, renderer->view.camera).ok);
}
