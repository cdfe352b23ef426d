#include "split/cost_model.h"

#include <cmath>

#include "base/check.h"

namespace pocketray {
namespace {

// Minimum part of a row's pixels from which its whole price is extrapolated. Chosen: fourfold at most, since single
// pixels cost up to twice as much as packets; with a larger minimum, rows of moving scenes would keep old prices.
constexpr double kPartMin = 0.25;
// The cap in integer units. Costs of rows are rounded up, so kImageSideMax rows lose at most 2⁻¹⁷ of it.
constexpr double kUnitsOfCap = 0x1p30;

// Converts to an entry of a row table. NaN and negative values count as 0.
std::uint64_t table_entry(double x) {
  constexpr double max = static_cast<double>(kRowTableMax);
  if (!(x > 0)) return 0;
  return x >= max ? kRowTableMax : static_cast<std::uint64_t>(std::ceil(x));
}

bool is_amount(double x) { return x >= 0 && x <= 1e30; }  // kSampleMax of smooth.cpp

double mean_device_ns(const CostModel& model) {
  double sum = 0;
  std::uint32_t count = 0;
  for (const RowModel& row : model.rows)
    if (is_known(row.device_ns)) sum += static_cast<double>(row.device_ns.value), ++count;
  return count ? sum / count : 0;
}

double mean_bytes(const CostModel& model) {
  double sum = 0;
  std::uint32_t count = 0;
  for (const RowModel& row : model.rows)
    if (is_known(row.bytes)) sum += static_cast<double>(row.bytes.value), ++count;
  return count ? sum / count : 0;
}

// Updates the rows that the device rendered, and scales all others by their common change.
void fold_device_rows(CostModel* model) {
  double before = 0, after = 0;
  for (RowModel& row : model->rows) {
    if (!(row.device_ns_seen > 0)) continue;
    double old_value = value_or(row.device_ns, 0);
    if (row.guessed) row.device_ns = Smoothed();  // next to a guess, a measurement could seem an outlier
    smooth(&row.device_ns, static_cast<double>(row.device_ns_seen));
    row.guessed = false;
    if (old_value > 0) before += old_value, after += static_cast<double>(row.device_ns.value);
  }
  if (!(before > 0)) return;
  for (RowModel& row : model->rows)
    if (!(row.device_ns_seen > 0)) scale(&row.device_ns, after / before);
}

// Device rows with its own light: their time as a fraction of a whole row's, common to all rows.
void fold_own_light(CostModel* model) {
  double own = 0, whole = 0;
  for (const RowModel& row : model->rows)
    if (row.device_ns_seen > 0 && is_known(row.device_ns) && !row.guessed)
      own += static_cast<double>(row.device_ns_seen), whole += static_cast<double>(row.device_ns.value);
  if (whole > 0) smooth(&model->light.own_part, own / whole);
  const auto part = static_cast<float>(value_or(model->light.own_part, 1));
  for (RowModel& row : model->rows) row.device_ns_seen /= part;
}

void fold_server_rows(CostModel* model, std::uint32_t server) {
  double mean = mean_device_ns(*model), device_sum = 0, server_sum = 0;
  for (const RowModel& row : model->rows) {
    if (!(row.server_ns_seen > 0) || row.server_seen != server) continue;
    device_sum += value_or(row.device_ns, mean);
    server_sum += static_cast<double>(row.server_ns_seen);
  }
  if (!(device_sum > 0)) return;
  double speed = server_sum / device_sum;
  smooth(&model->servers[server].speed, speed);
  if (!(speed > 0)) return;
  for (RowModel& row : model->rows)
    if (row.server_ns_seen > 0 && row.server_seen == server && !(row.device_ns_seen > 0))
      smooth(&row.device_ns, static_cast<double>(row.server_ns_seen) / speed);
}

void add_times(ByteTimes* times, double bytes, double ns) {
  if (!(bytes > 0 && ns > 0) || !is_amount(bytes) || !is_amount(ns)) return;
  times->bytes += bytes, times->ns += ns;
}

void fold_times(ByteTimes* times, Smoothed* ns_per_byte) {
  if (times->bytes > 0) smooth(ns_per_byte, times->ns / times->bytes);
  *times = ByteTimes();
}

// Factor from a problem's integer costs to the caller's unit.
double cost_scale(const SplitWish& wish) {
  if (wish.goal == SplitGoal::time_and_cost) return is_amount(wish.ns_per_cost) ? wish.ns_per_cost : 0;
  return wish.cap > 0 && is_amount(wish.cap) ? kUnitsOfCap / wish.cap : 1e30;
}

// Writes the prefix sums of entry(row) into the model's next table.
template <class Entry>
RowTable add_table(CostModel* model, std::uint32_t* table_count, Entry entry) {
  std::uint64_t* table = model->tables.data + std::size_t(*table_count) * (model->rows.count + 1);
  ++*table_count;
  CHECK_LE(std::size_t(*table_count) * (model->rows.count + 1), model->tables.count);
  table[0] = 0;
  for (std::uint32_t row = 0; row < model->rows.count; ++row) table[row + 1] = table[row] + table_entry(entry(row));
  return table;
}

bool is_usable(const ServerModel& server) {
  return server.connected && is_known(server.speed) && is_known(server.ns_per_byte) &&
         is_amount(server.cost_per_megabyte);
}

constexpr std::uint32_t kDeviceTables = 4, kServerTables = 3;

}  // namespace

std::size_t cost_model_need(std::uint32_t row_count, std::uint32_t server_count) {
  std::size_t entries = (std::size_t(row_count) + 1) * (kDeviceTables + kServerTables * std::size_t(server_count));
  return arena_need<RowModel>(row_count) + arena_need<std::uint64_t>(entries);
}

CostModel make_cost_model(std::uint32_t width, std::uint32_t row_count, std::uint32_t server_count, Arena* arena) {
  CHECK_LE(row_count, kImageSideMax);
  CHECK_LE(server_count, kServerCountMax);
  CostModel model;
  model.width = width;
  model.rows = arena_array<RowModel>(arena, row_count);
  for (RowModel& row : model.rows) row = RowModel();
  model.server_count = server_count;
  model.tables = arena_array<std::uint64_t>(
      arena, (std::size_t(row_count) + 1) * (kDeviceTables + kServerTables * std::size_t(server_count)));
  return model;
}

void observe_overture(CostModel* model, std::uint32_t server, const PixelTimes& times, double bytes_per_pixel,
                      double start_ns) {
  CHECK_LT(server, model->server_count);
  ServerModel* s = &model->servers[server];
  s->speed = s->ns_per_byte = s->start_ns = Smoothed();
  double pixels = model->width;
  for (RowModel& row : model->rows) {
    if (!is_known(row.device_ns)) smooth(&row.device_ns, times.device_ns * pixels), row.guessed = true;
    if (!is_known(row.bytes)) smooth(&row.bytes, bytes_per_pixel * pixels);
  }
  observe_server_speed(model, server, times.server_ns);
  s->price = s->price_stated;
  smooth(&s->ns_per_byte, times.transfer_ns / bytes_per_pixel);
  smooth(&s->start_ns, start_ns);
}

void observe_device_row(CostModel* model, std::uint32_t row, double ns, double part) {
  CHECK_LT(row, model->rows.count);
  model->rows[row].device_ns_seen = is_amount(ns) && part >= kPartMin ? static_cast<float>(ns / part) : 0;
}

void observe_server_rows(CostModel* model, std::uint32_t server, std::uint32_t row_begin, std::uint32_t row_end,
                         double work_ns, double bytes, double part) {
  CHECK_LT(server, model->server_count);
  CHECK_LE(row_begin, row_end);
  CHECK_LE(row_end, model->rows.count);
  double row_count = row_end - row_begin;
  for (std::uint32_t r = row_begin; r < row_end; ++r) {
    RowModel* row = &model->rows[r];
    row->server_ns_seen = is_amount(work_ns) && part >= kPartMin ? static_cast<float>(work_ns / row_count / part) : 0;
    row->part_seen = static_cast<float>(part);
    row->server_seen = static_cast<std::uint8_t>(server);
    // Bytes are counted, not timed: there is no noise to smooth, and with a moving camera the last frame is the best
    // guess. An unchanged row takes no bytes, which is a valid measurement.
    if (is_amount(bytes)) row->bytes = Smoothed(), smooth(&row->bytes, std::fmax(1, bytes / row_count));
  }
}

void observe_transfer(CostModel* model, std::uint32_t server, double bytes, double ns) {
  CHECK_LT(server, model->server_count);
  add_times(&model->servers[server].transfer_seen, bytes, ns);
}

void observe_unpack(CostModel* model, double bytes, double ns) { add_times(&model->unpack_seen, bytes, ns); }

void observe_link(CostModel* model, double bytes, double ns) { add_times(&model->link_seen, bytes, ns); }

void observe_own_link(CostModel* model, double ns_per_byte) {
  Smoothed* link = &model->link_ns_per_byte;
  if (is_known(*link) && !(ns_per_byte < static_cast<double>(link->value))) return;
  *link = Smoothed();
  smooth(link, ns_per_byte);
}

void observe_server_speed(CostModel* model, std::uint32_t server, double ns_per_pixel) {
  CHECK_LT(server, model->server_count);
  double mean = mean_device_ns(*model);
  if (mean > 0) smooth(&model->servers[server].speed, ns_per_pixel * model->width / mean);
}

void observe_price(CostModel* model, std::uint32_t server, double price) {
  CHECK_LT(server, model->server_count);
  const double max = static_cast<double>(kPriceMax);
  model->servers[server].price_stated = price >= 1 ? static_cast<float>(std::fmin(price, max)) : 1;
}

void observe_map(CostModel* model, double work_ns, double bytes, double arrival_ns) {
  smooth(&model->light.server_ns, work_ns), smooth(&model->light.bytes, bytes);
  smooth(&model->light.arrival_ns, arrival_ns);
}

void end_frame(CostModel* model, bool by_effect) {
  if (by_effect) fold_own_light(model);
  fold_device_rows(model);
  for (std::uint32_t i = 0; i < model->server_count; ++i) {
    fold_server_rows(model, i);
    ServerModel* server = &model->servers[i];
    fold_times(&server->transfer_seen, &server->ns_per_byte);
    server->price += kPricePart * (server->price_stated - server->price);
  }
  fold_times(&model->unpack_seen, &model->unpack_ns_per_byte);
  fold_times(&model->link_seen, &model->link_ns_per_byte);
  for (RowModel& row : model->rows) {
    row.holder = row.server_seen, row.holder_part = row.part_seen;
    row.device_ns_seen = row.server_ns_seen = 0, row.server_seen = kNoHolder;
  }
}

SplitProblem make_problem(CostModel* model, const SplitWish& wish, const RowsOfDevice& rows) {
  SplitProblem p;
  p.row_count = model->rows.count;
  p.server_count = model->server_count;
  double mean_ns = mean_device_ns(*model), mean_row_bytes = mean_bytes(*model);
  auto device_ns = [&](std::uint32_t row) { return value_or(model->rows[row].device_ns, mean_ns); };
  auto bytes = [&](std::uint32_t row) { return value_or(model->rows[row].bytes, mean_row_bytes); };
  double unpack = value_or(model->unpack_ns_per_byte, 0), link = value_or(model->link_ns_per_byte, 0);
  double per_cost = cost_scale(wish);
  const double map_ns = value_or(model->light.server_ns, 0), map_bytes = value_or(model->light.bytes, 0);
  bool cost_is_bytes = wish.goal == SplitGoal::time;
  std::uint32_t tables = 0;
  p.device_ns = add_table(model, &tables, [&](std::uint32_t row) {
    return device_ns(row) * (rows.part >= 0 ? rows.part : static_cast<double>(model->rows[row].device_part));
  });
  p.unpack_ns = add_table(model, &tables, [&](std::uint32_t row) { return bytes(row) * unpack; });
  p.link_ns = add_table(model, &tables, [&](std::uint32_t row) { return bytes(row) * link; });
  double device_pixel = cost_is_bytes ? 0 : model->cost_per_device_pixel * per_cost;
  p.device_cost = add_table(model, &tables, [&](std::uint32_t) { return device_pixel * model->width; });
  p.device_start_ns = table_entry(value_or(model->device_start_ns, 0));
  p.weigh_cost = wish.goal == SplitGoal::time_and_cost;
  if (wish.goal == SplitGoal::time_under_cap) p.cost_cap = wish.cap > 0 ? static_cast<std::uint64_t>(kUnitsOfCap) : 0;
  std::uint64_t least_start = kRowTableMax;
  for (std::uint32_t i = 0; i < model->server_count; ++i) {
    const ServerModel& server = model->servers[i];
    if (!is_usable(server)) continue;
    double slowness = server_slowness(server), per_byte = static_cast<double>(server.ns_per_byte.value);
    double byte_cost = cost_is_bytes ? 1 : (model->cost_per_byte + server.cost_per_megabyte * 1e-6) * per_cost;
    ServerTables* t = &p.servers[i];
    t->usable = true;
    t->render_ns = add_table(model, &tables, [&](std::uint32_t row) {
      const RowModel& r = model->rows[row];
      return device_ns(row) * slowness * (r.holder == i ? static_cast<double>(r.holder_part) : 1);
    });
    t->transfer_ns = add_table(model, &tables, [&](std::uint32_t row) { return bytes(row) * per_byte; });
    t->cost = add_table(model, &tables, [&](std::uint32_t row) { return bytes(row) * byte_cost; });
    t->start_ns = table_entry(value_or(server.start_ns, 0) + (i == rows.mapper ? map_ns + map_bytes * per_byte : 0));
    t->chunk_rows = server.chunk_rows > 0 ? server.chunk_rows : 1;
    const double row_ns = static_cast<double>(t->render_ns[p.row_count]) / p.row_count;
    t->chunk_row_ns = table_entry(std::fmin(row_ns, mean_row_bytes * per_byte));
    if (t->start_ns < least_start) least_start = t->start_ns;
  }
  p.link_start_ns = least_start;
  if (rows.mapper >= model->server_count) return p;
  p.link_start_ns = table_entry(static_cast<double>(least_start) + map_bytes * link);
  p.device_least_ns = table_entry(value_or(model->light.arrival_ns, 0));
  return p;
}

}  // namespace pocketray
