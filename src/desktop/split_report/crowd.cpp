#include "desktop/split_report/crowd.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <queue>

#include "base/check.h"
#include "base/limit_list.h"
#include "remote/server/share.h"
#include "split/cost_model.h"

namespace pocketray {
namespace {

constexpr std::uint32_t kChunkRows = 4;             // 16 lines
constexpr std::uint64_t kIdlePingNs = 500'000'000;  // as in client/peer.cpp
constexpr std::uint64_t kSecondNs = 1'000'000'000;

enum class EventKind : std::uint8_t {
  frame,    // a client begins its next frame
  row,      // a client has rendered a row
  request,  // a server receives a request; without rows: a cancel
  slice,    // a server has done a slice
  chunk,    // a client receives rows
};

struct Event {
  std::uint64_t ns, order;
  EventKind kind;
  std::uint32_t client, server;  // server: index in the client's list; for a slice: global index
  std::uint32_t frame, begin, end;
  double price;
};

struct Later {
  bool operator()(const Event& a, const Event& b) const { return a.ns != b.ns ? a.ns > b.ns : a.order > b.order; }
};

// A client's connection at the server.
struct Place {
  std::uint32_t client, server;  // server: index in the client's list
  Account account;
  std::uint32_t frame = 0, begin = 0, end = 0;  // rows left to trace, from the bottom upward
  std::uint64_t took_ns = 0;                    // for the frame
};

struct ServerState {
  std::vector<Place> places;
  Lanes lanes;
  std::uint64_t settled_ns = 0;
  int at_work = -1;  // the place that has the CPU
  std::uint32_t slice_frame = 0, slice_rows = 0;
  double slice_ns = 0;
};

struct Connection {
  bool open = false;
  std::size_t place = 0;
  std::uint64_t heard_ns = 0, asked_ns = 0;
  std::uint32_t begin = 0, end = 0, rows_come = 0;
};

enum class Row : std::uint8_t { missing, done };

struct ClientState {
  std::vector<std::uint8_t> block;
  CostModel model;
  SplitWorkspace workspace;
  Split split;
  std::vector<Row> rows;
  Connection connections[kServerCountMax];
  std::uint32_t frame = 0, missing = 0, device_rows = 0;
  std::uint32_t row = 0;  // being rendered on the device
  std::uint64_t begin_ns = 0, link_free_ns = 0;
  double share_before = -1;
  double share_sum = 0, change_sum = 0, ns_sum = 0;
  std::uint32_t changes = 0;
};

struct Simulation {
  const Crowd* crowd;
  std::priority_queue<Event, std::vector<Event>, Later> events;
  std::uint64_t now = 0, planned = 0;
  std::vector<ServerState> servers;
  std::vector<std::unique_ptr<ClientState>> clients;
  std::vector<double> changes;
  std::vector<std::uint32_t> frames;  // by second
  CrowdReport report;
};

void plan(Simulation* s, double in_ns, Event event) {
  CHECK_GE(in_ns, 0);
  event.ns = s->now + static_cast<std::uint64_t>(std::ceil(in_ns));
  event.order = s->planned++;
  s->events.push(event);
}

const CrowdClient& given(const Simulation& s, std::uint32_t client) { return s.crowd->clients[client]; }
std::uint32_t server_of(const Simulation& s, std::uint32_t client, std::uint32_t i) {
  return given(s, client).servers[i];
}
bool is_there(const Simulation& s, std::uint32_t server) {
  const CrowdServer& given = s.crowd->servers[server];
  return s.now >= given.begin_ns && s.now < given.end_ns;
}

// ---- The server, like remote/server/work.cpp

bool has_work(const Place& place) { return place.begin < place.end; }

double price_for(const ServerState& server, const Account& account) {
  return static_cast<double>(price_of(crowding(server.lanes, account), 1)) / kPriceUnit;
}

int choose_place(Simulation* s, ServerState* server) {
  const std::uint64_t passed = s->now - server->settled_ns, count = 1 + server->places.size();
  server->settled_ns = s->now;
  Choice choice;
  clear_demand(&server->lanes);
  for (std::size_t i = 0; i < server->places.size(); ++i) {
    Place* place = &server->places[i];
    forgive(&place->account, passed, count);
    observe_demand(&place->account, passed);
    note(&server->lanes, &place->account, has_work(*place));
    add_demand(&server->lanes, place->account);
    consider(&choice, static_cast<int>(i), place->account);
  }
  return choose(&server->lanes, choice);
}

void begin_slice(Simulation* s, std::uint32_t index) {
  ServerState* server = &s->servers[index];
  CHECK_LT(server->at_work, 0);
  if (!is_there(*s, index)) return;
  server->at_work = choose_place(s, server);
  if (server->at_work < 0) return;
  const Place& place = server->places[static_cast<std::size_t>(server->at_work)];
  CHECK(has_work(place));
  const double row_ns = s->crowd->servers[index].pixel_ns * s->crowd->row_pixels;
  const double rows = std::max(1.0, std::min<double>(kChunkRows, std::floor(double(kSliceNs) / row_ns)));
  server->slice_rows = std::min(place.end - place.begin, static_cast<std::uint32_t>(rows));
  server->slice_ns = row_ns * server->slice_rows;
  server->slice_frame = place.frame;
  plan(s, server->slice_ns, {0, 0, EventKind::slice, 0, index, 0, 0, 0, 0});
}

void end_job(Place* place, std::uint64_t sent_ns) {
  if (place->took_ns > 0) end_frame(&place->account, place->took_ns, sent_ns);
  place->took_ns = 0;
}

void end_slice(Simulation* s, std::uint32_t index) {
  ServerState* server = &s->servers[index];
  CHECK_GE(server->at_work, 0);
  CHECK_GT(server->slice_rows, 0u);
  Place* place = &server->places[static_cast<std::size_t>(server->at_work)];
  server->at_work = -1;
  if (!is_there(*s, index)) return;
  const std::uint64_t took = static_cast<std::uint64_t>(server->slice_ns);
  charge(&server->lanes, &place->account, took);
  place->account.job_ns += took;
  place->took_ns += took;
  if (s->now >= s->crowd->watch_ns) s->report.clients[place->client].work_ns += server->slice_ns;
  ClientState* client = s->clients[place->client].get();
  if (place->frame == server->slice_frame && has_work(*place)) {
    const std::uint32_t begin = place->end - std::min(place->end - place->begin, server->slice_rows);
    const double price = price_for(*server, place->account);
    double bytes = s->crowd->pixel_bytes * s->crowd->row_pixels * (place->end - begin);
    const CrowdClient& c = given(*s, place->client);
    client->link_free_ns = std::max(client->link_free_ns, s->now) + static_cast<std::uint64_t>(bytes * c.ns_per_byte);
    plan(s, static_cast<double>(client->link_free_ns - s->now + c.latency_ns),
         {0, 0, EventKind::chunk, place->client, place->server, place->frame, begin, place->end, price});
    place->end = begin;
    if (!has_work(*place)) end_job(place, place->took_ns);
    if (s->now >= s->crowd->watch_ns) {
      double* low = &s->report.price_low[index];
      *low = *low > 0 ? std::min(*low, price) : price;
      s->report.price_high[index] = std::max(s->report.price_high[index], price);
    }
  }
  begin_slice(s, index);
}

void take_request(Simulation* s, const Event& e) {
  const std::uint32_t index = server_of(*s, e.client, e.server);
  if (!is_there(*s, index)) return;
  ServerState* server = &s->servers[index];
  Place* place = &server->places[s->clients[e.client]->connections[e.server].place];
  CHECK(place->client == e.client && place->server == e.server);
  if (has_work(*place)) end_job(place, place->took_ns / 2);
  place->frame = e.frame, place->begin = e.begin, place->end = e.end;
  if (server->at_work < 0) begin_slice(s, index);
}

// ---- The client, like remote/client

void render_next_row(Simulation* s, std::uint32_t index) {
  ClientState* client = s->clients[index].get();
  while (client->row < s->crowd->row_count && client->rows[client->row] == Row::done) ++client->row;
  CHECK_LT(client->row, s->crowd->row_count);  // since some row is missing
  plan(s, given(*s, index).pixel_ns * s->crowd->row_pixels,
       {0, 0, EventKind::row, index, 0, client->frame, client->row, 0, 0});
}

// Connects to new servers, and pings those that it has not asked for a while.
void tend_connections(Simulation* s, std::uint32_t index) {
  ClientState* client = s->clients[index].get();
  const CrowdClient& c = given(*s, index);
  for (std::uint32_t i = 0; i < c.server_count; ++i) {
    Connection* connection = &client->connections[i];
    ServerState* server = &s->servers[c.servers[i]];
    ServerModel* model = &client->model.servers[i];
    const bool there = is_there(*s, c.servers[i]);
    if (!there) {
      connection->open = model->connected = false;
      continue;
    }
    if (!connection->open) {
      connection->open = model->connected = true;
      connection->place = server->places.size();
      server->places.push_back({index, i, Account(), 0, 0, 0, 0});
      server->places.back().account.seat = connection->place;
      observe_price(&client->model, i, price_for(*server, Account()));
      const PixelTimes times = {c.pixel_ns, s->crowd->servers[c.servers[i]].pixel_ns,
                                s->crowd->pixel_bytes * c.ns_per_byte};
      observe_overture(&client->model, i, times, s->crowd->pixel_bytes, 2.0 * static_cast<double>(c.latency_ns));
      model->chunk_rows = kChunkRows;
      connection->heard_ns = s->now;
    } else if (s->now - connection->heard_ns >= kIdlePingNs) {
      observe_price(&client->model, i, price_for(*server, server->places[connection->place].account));
      observe_start(&client->model, i, 2.0 * static_cast<double>(c.latency_ns));
      connection->heard_ns = s->now;
    }
  }
}

void begin_frame(Simulation* s, std::uint32_t index) {
  ClientState* client = s->clients[index].get();
  const CrowdClient& c = given(*s, index);
  if (s->now >= c.end_ns) return;
  tend_connections(s, index);
  ++client->frame;
  client->begin_ns = s->now;
  client->missing = s->crowd->row_count, client->device_rows = client->row = 0;
  std::fill(client->rows.begin(), client->rows.end(), Row::missing);
  client->split = next_split(make_problem(&client->model, SplitWish()), client->split, &client->workspace);
  for (std::uint32_t i = 0; i < c.server_count; ++i) {
    Connection* connection = &client->connections[i];
    const bool had_rows = connection->begin < connection->end;
    connection->begin = client->split.boundary[i], connection->end = client->split.boundary[i + 1];
    connection->rows_come = 0, connection->asked_ns = s->now;
    if (!connection->open || (!had_rows && connection->begin == connection->end)) continue;
    plan(s, static_cast<double>(c.latency_ns),
         {0, 0, EventKind::request, index, i, client->frame, connection->begin, connection->end, 0});
  }
  render_next_row(s, index);
}

void end_client_frame(Simulation* s, std::uint32_t index) {
  ClientState* client = s->clients[index].get();
  CHECK_EQ(client->missing, 0u);
  CHECK_GE(s->now, client->begin_ns);
  const double share = static_cast<double>(client->split.boundary[0]) / s->crowd->row_count;
  const std::size_t second = static_cast<std::size_t>(s->now / kSecondNs);
  if (client->share_before >= 0) {
    const double change = std::fabs(share - client->share_before);
    s->changes[second] += change, ++s->frames[second];
    if (s->now >= s->crowd->watch_ns) client->change_sum += change, ++client->changes;
  }
  client->share_before = share;
  if (client->begin_ns >= s->crowd->watch_ns) {
    ++s->report.clients[index].frame_count;
    client->ns_sum += static_cast<double>(s->now - client->begin_ns);
    client->share_sum += static_cast<double>(client->device_rows) / s->crowd->row_count;
  }
  for (std::uint32_t i = 0; i < given(*s, index).server_count; ++i) {
    const Connection& connection = client->connections[i];
    if (connection.open && connection.begin < connection.end && connection.rows_come == 0)
      observe_start(&client->model, i, static_cast<double>(s->now - connection.asked_ns));
  }
  end_frame(&client->model);
  plan(s, 0, {0, 0, EventKind::frame, index, 0, 0, 0, 0, 0});
}

void finish_row(Simulation* s, const Event& e) {
  ClientState* client = s->clients[e.client].get();
  if (e.frame != client->frame || client->missing == 0) return;
  observe_device_row(&client->model, e.begin, given(*s, e.client).pixel_ns * s->crowd->row_pixels);
  if (client->rows[e.begin] == Row::missing) {
    client->rows[e.begin] = Row::done;
    --client->missing, ++client->device_rows;
  }
  client->missing > 0 ? render_next_row(s, e.client) : end_client_frame(s, e.client);
}

void take_chunk(Simulation* s, const Event& e) {
  ClientState* client = s->clients[e.client].get();
  CHECK(e.begin < e.end && e.end <= s->crowd->row_count);
  CHECK_GE(e.price, 1);
  Connection* connection = &client->connections[e.server];
  connection->heard_ns = s->now;
  observe_price(&client->model, e.server, e.price);
  if (e.frame != client->frame || client->missing == 0) return;
  connection->rows_come += e.end - e.begin;
  const double pixels = double(s->crowd->row_pixels) * (e.end - e.begin);
  const double bytes = s->crowd->pixel_bytes * pixels;
  observe_server_rows(&client->model, e.server, e.begin, e.end,
                      s->crowd->servers[server_of(*s, e.client, e.server)].pixel_ns * pixels, bytes);
  observe_transfer(&client->model, e.server, bytes, bytes * given(*s, e.client).ns_per_byte);
  observe_link(&client->model, bytes, bytes * given(*s, e.client).ns_per_byte);
  for (std::uint32_t row = e.begin; row < e.end; ++row)
    if (client->rows[row] == Row::missing) client->rows[row] = Row::done, --client->missing;
  if (client->missing == 0) end_client_frame(s, e.client);
}

void make_client(const Crowd& crowd, const CrowdClient& c, ClientState* client) {
  client->block.resize(cost_model_need(crowd.row_count, c.server_count) + split_need(crowd.row_count, c.server_count) +
                       kArenaAlignment);
  Arena arena = make_arena("client", client->block.data(), client->block.size());
  client->model = make_cost_model(crowd.row_pixels, crowd.row_count, c.server_count, &arena);
  client->workspace = make_split_workspace(crowd.row_count, c.server_count, &arena);
  client->rows.resize(crowd.row_count);
}

void take_figures(Simulation* s) {
  for (std::size_t i = 0; i < s->clients.size(); ++i) {
    CrowdFigures* figures = &s->report.clients[i];
    const ClientState& client = *s->clients[i];
    if (figures->frame_count > 0) {
      figures->frame_ns = client.ns_sum / figures->frame_count;
      figures->device_share = client.share_sum / figures->frame_count;
    }
    if (client.changes > 0) figures->change = client.change_sum / client.changes;
  }
  for (std::size_t i = 0; i < s->changes.size(); ++i)
    s->report.change_by_second.push_back(s->frames[i] > 0 ? s->changes[i] / s->frames[i] : 0);
}

}  // namespace

CrowdReport simulate_crowd(const Crowd& crowd) {
  CHECK(crowd.row_count > 0 && crowd.row_count <= kImageSideMax);
  CHECK_LE(crowd.watch_ns, crowd.end_ns);
  Simulation s;
  s.crowd = &crowd;
  s.servers.resize(crowd.servers.size());
  s.report.clients.resize(crowd.clients.size());
  s.report.price_low.resize(crowd.servers.size()), s.report.price_high.resize(crowd.servers.size());
  s.changes.resize(static_cast<std::size_t>(crowd.end_ns / kSecondNs) + 1), s.frames.resize(s.changes.size());
  for (std::uint32_t i = 0; i < crowd.clients.size(); ++i) {
    CHECK_LE(crowd.clients[i].server_count, kServerCountMax);
    CHECK_GT(crowd.clients[i].pixel_ns, 0);
    s.clients.push_back(std::make_unique<ClientState>());
    make_client(crowd, crowd.clients[i], s.clients.back().get());
    plan(&s, static_cast<double>(crowd.clients[i].begin_ns), {0, 0, EventKind::frame, i, 0, 0, 0, 0, 0});
  }
  while (!s.events.empty() && s.events.top().ns < crowd.end_ns) {
    const Event e = s.events.top();
    s.events.pop();
    s.now = e.ns;
    switch (e.kind) {
      case EventKind::frame:
        begin_frame(&s, e.client);
        break;
      case EventKind::row:
        finish_row(&s, e);
        break;
      case EventKind::request:
        take_request(&s, e);
        break;
      case EventKind::slice:
        end_slice(&s, e.server);
        break;
      case EventKind::chunk:
        take_chunk(&s, e);
        break;
    }
  }
  take_figures(&s);
  return s.report;
}

}  // namespace pocketray
