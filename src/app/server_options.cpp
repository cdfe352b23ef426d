// Options for sharing frames with render servers.
#include "app/measured_prices.h"
#include "app/options.h"
#include "engine/light_map.h"

namespace pocketray {

constexpr double kCostMax = 1e12;  // sums of costs stay finite

Option add_server_option(Command command, std::vector<std::string>* addresses) {
  command.chapter("Render servers");
  return command.add_option("--server HOST:PORT", *addresses, "a render server to share frames with")
      .one_value_each()
      .details("Runs `pocketray serve`. Give the option once for each of several servers.");
}

Option add_key_option(Command command, std::string* path) {
  return command.add_option("--key FILE", *path, "encrypt links; accept only peers with this key")
      .details("Made by `pocketray keygen`, and equal on both sides; the file's mode must be 0600.");
}

void add_servers_options(Command command, ServersOptions* o) {
  add_server_option(command, &o->addresses);
  add_key_option(command, &o->key);
  command.add_option("--share X", o->device_share, "the device's share of the rows")
      .range(0, 1)
      .default_str("the fastest");
  command.add_option("--verify N", o->verify, "pixels per frame that the device checks itself")
      .range(0, 1024)
      .default_str("what 1 % of the time allows")
      .details(
          "Pixels are drawn at random, and a server caught with a wrong one is dropped. N pixels catch one wrong row "
          "of R "
          "in a frame with a probability of at least 1 - (1 - 1/R)^N.");
  command.add_flag("--near-lossless", o->near_lossless, "let servers err by one level per channel, for half the bytes")
      .details("A level of the pixels' format. Otherwise every pixel is exact.")
      .price(measured_price("--near-lossless"));
  command.add_option("--split HOW", o->split, "what servers render")
      .one_of({"rows", "effect", "auto"})
      .default_str("rows")
      .details(
          "rows: some rows, exactly as the device would. effect: indirect light at some pixels, while the device "
          "renders "
          "every pixel without it. auto: whichever is faster, or both.");
  command.add_option("--light-every N", o->light_every, "frames of a moving view that share a server's light")
      .range(1, kLightEveryMax)
      .capture_default_str()
      .details("With --split effect or auto.");
  command.add_option("--price X", o->price, "price of 10^6 bytes from a server, in any unit")
      .range(0, kCostMax)
      .default_str("0");
  command.add_option("--energy-pixel X", o->energy_pixel, "cost of rendering a pixel on the device, in that unit")
      .range(0, kCostMax)
      .default_str("0");
  command.add_option("--energy-byte X", o->energy_byte, "cost of receiving a byte on the device, in that unit")
      .range(0, kCostMax)
      .default_str("0");
  command
      .add_option("--cost-weight MS", o->cost_weight_ms,
                  "milliseconds that a unit of cost is worth: minimises time plus weighted cost")
      .range(0, kCostMax)
      .default_str("0");
  command.add_option("--cost-cap X", o->cost_cap, "largest cost per frame: takes the fastest split within it")
      .range(0, kCostMax)
      .default_str("none");
}

}  // namespace pocketray
