// A cost model and its workspace in their own memory.
#pragma once
#include <vector>

#include "split/cost_model.h"

namespace pocketray {

struct OwnModel {
  std::vector<std::uint8_t> block;
  std::uint32_t width, row_count, server_count;
  CostModel model;
  SplitWorkspace workspace;

  OwnModel(std::uint32_t width_, std::uint32_t row_count_, std::uint32_t server_count_)
      : block(cost_model_need(row_count_, server_count_) + split_need(row_count_, server_count_) + kArenaAlignment),
        width(width_),
        row_count(row_count_),
        server_count(server_count_) {
    reset();
  }
  OwnModel(const OwnModel&) = delete;
  void reset() {
    Arena arena = make_arena("model", block.data(), block.size());
    model = make_cost_model(width, row_count, server_count, &arena);
    workspace = make_split_workspace(row_count, server_count, &arena);
  }
  Split plan(const SplitWish& wish = SplitWish()) { return find_split(make_problem(&model, wish), &workspace); }
};

}  // namespace pocketray
