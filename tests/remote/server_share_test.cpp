// The scheduler in isolation, with counted work.
#include "remote/server/share.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

#include "base/limit_list.h"

using namespace pocketray;

namespace {

constexpr std::uint64_t kMs = 1'000'000;

// An account on a common CPU. It requests work in pieces of `piece_ns`, for a frame or in vain.
struct Player {
  Account account;
  std::uint64_t frame_ns = 0;  // per frame; 0: only messages
  bool gives_up = false;       // abandons frames before a row is sent
  std::uint64_t done_ns = 0, got_ns = 0;
};

void play(std::vector<Player>* players, Lanes* lanes, std::uint64_t ns, std::uint64_t piece_ns = 10 * kMs) {
  for (std::uint64_t now = 0; now < ns; now += piece_ns) {
    Choice choice;
    for (std::size_t i = 0; i < players->size(); ++i) {
      Player* p = &(*players)[i];
      forgive(&p->account, piece_ns, players->size());
      observe_demand(&p->account, piece_ns);
      note(lanes, &p->account, true);
      consider(&choice, static_cast<int>(i), p->account);
    }
    Player* p = &(*players)[static_cast<std::size_t>(choose(lanes, choice))];
    charge(lanes, &p->account, piece_ns);
    p->got_ns += piece_ns;
    if (p->frame_ns == 0) {
      owe_messages(&p->account, piece_ns);
      continue;
    }
    p->account.job_ns += piece_ns;
    p->done_ns += piece_ns;
    if (p->done_ns < p->frame_ns) continue;
    end_frame(&p->account, p->done_ns, p->gives_up ? 0 : p->done_ns);
    p->done_ns = 0;
  }
}

double share_of(const Player& p, std::uint64_t ns) { return static_cast<double>(p.got_ns) / static_cast<double>(ns); }

}  // namespace

// Goal: an account with light frames gets three quarters of the CPU against any number of heavy ones. Method: frames of
// 100 ms against twenty accounts with frames of 10 s, abandoned frames or only messages, once they are classified.
TEST_CASE("share_of_light_frames_does_not_depend_on_heavy_neighbours") {
  struct Case {
    std::uint64_t frame_ns;
    bool gives_up;
  };
  for (const Case& c : {Case{10'000 * kMs, false}, Case{200 * kMs, true}, Case{0, false}}) {
    CAPTURE(c.frame_ns);
    std::vector<Player> players(21);
    Lanes lanes;
    for (Player& p : players) p.frame_ns = c.frame_ns, p.gives_up = c.gives_up;
    players[0].frame_ns = 100 * kMs, players[0].gives_up = false;
    play(&players, &lanes, 10'000 * kMs);
    for (Player& p : players) p.got_ns = 0;
    play(&players, &lanes, 20'000 * kMs);
    CHECK(share_of(players[0], 20'000 * kMs) > 0.65);
    for (std::size_t i = 1; i < players.size(); ++i) CHECK(share_of(players[i], 20'000 * kMs) > 0.005);
  }
}

// Goal: equals get equal shares in either lane, even if they come later. Method: five with light frames of unequal
// sizes; five with heavy ones; then a sixth.
TEST_CASE("share_is_equal_among_equals") {
  for (std::uint64_t frame_ns : {20 * kMs, 5'000 * kMs}) {
    CAPTURE(frame_ns);
    std::vector<Player> players(5);
    Lanes lanes;
    for (std::size_t i = 0; i < players.size(); ++i) players[i].frame_ns = frame_ns * (1 + i);
    play(&players, &lanes, 10'000 * kMs);
    for (Player& p : players) p.got_ns = 0;
    players.push_back(players[0]);
    players[5].account = Account();
    play(&players, &lanes, 12'000 * kMs);
    for (const Player& p : players) CHECK(share_of(p, 12'000 * kMs) == doctest::Approx(1.0 / 6).epsilon(0.1));
  }
}

// Goal: a heavy account becomes light again once it requests light frames, and a heavy frame in between does not pay
// off. Method: the debt after each.
TEST_CASE("share_forgives_who_asks_for_less") {
  Account a;
  end_frame(&a, 5'000 * kMs, 5'000 * kMs);
  CHECK(a.owed_ns == kOwedNsMax);
  CHECK(lane_of(a) == Lane::heavy);
  for (int i = 0; i < 3; ++i) end_frame(&a, 100 * kMs, 100 * kMs);
  CHECK(lane_of(a) == Lane::light);
  for (int i = 0; i < 2; ++i) end_frame(&a, 200 * kMs, 10 * kMs);  // abandoned
  CHECK(lane_of(a) == Lane::heavy);
  forgive(&a, 1'000'000 * kMs, 4);
  CHECK(a.owed_ns == 0);
}

// Goal: an account's standing follows from what it was sent and what it owes: a newcomer becomes light by a light
// frame, however long its renderer took to build, and heavy by a flood, by messages sooner than by frames; a tiny frame
// buys little trust. Method: the lane after each.
TEST_CASE("share_trusts_who_was_sent_light_frames") {
  Account honest;
  CHECK(lane_of(honest) == Lane::newcomer);
  honest.job_ns = kNewcomerNs;
  CHECK(lane_of(honest) == Lane::newcomer);
  honest.job_ns += 1;
  CHECK(lane_of(honest) == Lane::heavy);
  honest.job_ns = 450 * kMs;
  end_frame(&honest, 450 * kMs, 200 * kMs, 250 * kMs);
  CHECK(lane_of(honest) == Lane::light);
  Account views;
  end_frame(&views, 60 * kMs, 0, 55 * kMs);
  CHECK(lane_of(views) == Lane::heavy);
  Account flood;
  owe_messages(&flood, kNewcomerNs / kNewcomerMessages);
  CHECK(lane_of(flood) == Lane::newcomer);
  owe_messages(&flood, kMs);
  CHECK(lane_of(flood) == Lane::heavy);
  Account tiny;
  end_frame(&tiny, 2 * kMs, 2 * kMs);
  CHECK(lane_of(tiny) == Lane::light);
  owe_messages(&tiny, 9 * kMs);
  CHECK(lane_of(tiny) != Lane::light);
}

// Goal: newcomers wait for those seated before them and for nobody else, however many come. Method: a newcomer with a
// frame of 40 ms behind seven that want ever more; whenever one of them becomes heavy, another newcomer takes its
// place.
TEST_CASE("share_serves_newcomers_by_seniority") {
  std::vector<Player> players(9);
  Lanes lanes;
  for (std::size_t i = 0; i < players.size(); ++i) players[i].frame_ns = 10'000 * kMs, players[i].account.seat = i;
  players[7].frame_ns = 40 * kMs;
  std::uint64_t seats = players.size(), now = 0;
  for (; now < 10'000 * kMs && lane_of(players[7].account) == Lane::newcomer; now += 10 * kMs) {
    play(&players, &lanes, 10 * kMs);
    for (Player& p : players)
      if (lane_of(p.account) == Lane::heavy) p = Player(), p.frame_ns = 10'000 * kMs, p.account.seat = seats++;
  }
  CHECK(lane_of(players[7].account) == Lane::light);
  CHECK(now <= 7 * (kNewcomerNs + 10 * kMs) + 40 * kMs);
}

// Goal: a light account loses at most a quarter of the time to newcomers and heavy ones together, from its first
// request on and after each pause. Method: its frames of 40 ms with pauses of 20 ms, beside twenty of each kind; the
// longest.
TEST_CASE("share_of_a_light_account_holds_from_the_first_frame") {
  std::vector<Player> players(41);
  Lanes lanes;
  for (std::size_t i = 0; i < players.size(); ++i) players[i].frame_ns = 10'000 * kMs, players[i].account.seat = i;
  players[0].frame_ns = 0;
  end_frame(&players[0].account, 40 * kMs, 40 * kMs);
  for (std::size_t i = 1; i <= 20; ++i) owe(&players[i].account, kOwedNsMax);
  constexpr std::uint64_t kPiece = 4 * kMs;
  std::uint64_t longest = 0;
  for (int frame = 0; frame < 50; ++frame) {
    std::vector<Player> others(players.begin() + 1, players.end());
    for (int idle = 0; idle < 5; ++idle) play(&others, &lanes, kPiece, kPiece);
    std::copy(others.begin(), others.end(), players.begin() + 1);
    players[0].account.waits = false;
    players[0].frame_ns = 40 * kMs, players[0].got_ns = 0;
    std::uint64_t took = 0;
    for (; players[0].got_ns < 40 * kMs; took += kPiece) play(&players, &lanes, kPiece, kPiece);
    longest = std::max(longest, took);
  }
  CHECK(longest <= 2 * 40 * kMs);
}

// Goal: all ports of an address, and all hosts of an IPv6 network, count as one; other addresses do not. Method: names
// as given by the link.
TEST_CASE("share_knows_addresses") {
  CHECK(address_key("127.0.0.1:80") == address_key("127.0.0.1:7411"));
  CHECK(address_key("127.0.0.1:80") != address_key("127.0.0.2:80"));
  CHECK(address_key("[::1]:80") == address_key("[::1]:81"));
  CHECK(address_key("[2001:db8:1:2::7]:80") == address_key("[2001:db8:1:2:3:4:5:6]:80"));
  CHECK(address_key("[2001:db8:1:2::7]:80") != address_key("[2001:db8:1:3::7]:80"));
  CHECK(address_key("[2001:db8::3:0:0:7]:80") == address_key("[2001:db8:0:0:9::]:80"));
  CHECK(address_key("[2001::3:4:5:6:7]:80") == address_key("[2001:0:0:3::]:80"));
  CHECK(address_key("[::]:80") != address_key("[1::]:80"));
  for (const char* odd : {"", ":", "[", "[]", "[:::]", "[zz]:1", "[1:2:3:4:5:6:7:8:9:a]:1", "[::::::::::]"})
    (void)address_key(odd);
}

// Goal: the price is what an account waits, over its work. Method: accounts of the scheduler that always have work, or
// half of the time, after a long while: of one lane, and of the other.
TEST_CASE("share_price_is_what_others_take") {
  auto settled = [](double busy) {
    Account a;
    for (int i = 0; i < 4000; ++i) {
      a.waits = i % 10 < 10 * busy;
      observe_demand(&a, 5 * kMs);
    }
    return a;
  };
  const Account always = settled(1), half = settled(0.5), never = settled(0);
  CHECK(always.demand == doctest::Approx(1).epsilon(1e-3));
  CHECK(half.demand == doctest::Approx(0.5).epsilon(0.05));
  CHECK(never.demand == 0);
  Account heavy = always;
  heavy.lane = Lane::heavy;
  struct Case {
    std::vector<Account> others;
    double light_price, heavy_price;
  };
  const Case cases[] = {{{}, 1, 1},
                        {{never}, 1, 1},
                        {{always}, 2, 4},
                        {{always, always, half}, 3.5, 4},
                        {{heavy}, 4.0 / 3, 2},
                        {{always, heavy, heavy}, 2 / 0.75, 3 / 0.25}};
  for (const Case& c : cases) {
    Lanes lanes;
    clear_demand(&lanes);
    for (const Account& other : c.others) add_demand(&lanes, other);
    add_demand(&lanes, half);
    CHECK(crowding(lanes, half) == doctest::Approx(c.light_price).epsilon(0.02));
    clear_demand(&lanes);
    for (const Account& other : c.others) add_demand(&lanes, other);
    Account own;
    own.lane = Lane::heavy;
    CHECK(crowding(lanes, own) == doctest::Approx(c.heavy_price).epsilon(0.02));
  }
  CHECK(price_of(1, 1) == kPriceUnit);
  CHECK(price_of(2, 1.5) == 3 * kPriceUnit);
  CHECK(price_of(64, 64) == UINT16_MAX);
}

// Goal: the price tells how the scheduler divides its time. Method: light and heavy players as above; the inverse of
// each one's share of the time is its price.
TEST_CASE("share_price_agrees_with_the_scheduler") {
  std::vector<Player> players(5);
  Lanes lanes;
  for (std::size_t i = 0; i < players.size(); ++i) players[i].frame_ns = i < 3 ? 100 * kMs : 10'000 * kMs;
  play(&players, &lanes, 10'000 * kMs);
  for (Player& p : players) p.got_ns = 0;
  play(&players, &lanes, 30'000 * kMs);
  clear_demand(&lanes);
  for (Player& p : players) add_demand(&lanes, p.account);
  for (const Player& p : players)
    CHECK(crowding(lanes, p.account) * share_of(p, 30'000 * kMs) == doctest::Approx(1).epsilon(0.1));
}
