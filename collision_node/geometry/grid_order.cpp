#include "collision_node/geometry/grid_order.h"

#include <algorithm>
#include <cmath>

namespace collision_node::geometry {
namespace {

constexpr int kMostAlong = 64;

/// Along the longest axis: the cells that a surface passes hold some 30 entries each.
int cellsAlong(std::size_t entries) {
  constexpr double kPer = 150.0;
  return std::clamp(static_cast<int>(std::sqrt(static_cast<double>(entries) / kPer)), 2, kMostAlong);
}

}  // namespace

GridOrder::GridOrder(const Elements& elements, Entry* entries) : largest_cell_(elements.size()) {
  constexpr std::size_t kLeast = 16384;
  const RegisterBox& all = elements.around();
  const int along = cellsAlong(elements.size()), longest = all.longestAxis();
  const float per_length = static_cast<float>(along) / (2.0F * (all.upper[longest] - all.lower[longest]));
  if (elements.size() < kLeast || !(per_length < RegisterBox::kFar)) {
    for (std::size_t i = 0; i < elements.size(); ++i) entries[i].set(elements.box(i), i);
  } else {
    sort(elements, along, per_length, entries);
  }
}

/// Two passes over the elements, each of which makes their boxes.
void GridOrder::sort(const Elements& elements, int along, float per_length, Entry* entries) {
  const RegisterBox& all = elements.around();
  int size[3];
  for (int k = 0; k < 3; ++k)
    size[k] = std::clamp(1 + static_cast<int>(2.0F * (all.upper[k] - all.lower[k]) * per_length), 1, along);
  std::vector<std::int32_t> number(static_cast<std::size_t>(size[0] * size[1] * size[2]), kNone);
  std::vector<std::int32_t> cell_of;
  cell_of.reserve(elements.size());
  const FourFloats low = 2.0F * all.lower;
  const FourFloats last = {static_cast<float>(size[0] - 1), static_cast<float>(size[1] - 1),
                           static_cast<float>(size[2] - 1), 0.0F};
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const RegisterBox box = elements.box(i);
    const FourFloats place = smaller(larger((box.lower + box.upper - low) * per_length, FourFloats{}), last);
    const int at[3] = {static_cast<int>(place[0]), static_cast<int>(place[1]), static_cast<int>(place[2])};
    std::int32_t& cell = number[static_cast<std::size_t>(at[0] + size[0] * (at[1] + size[1] * at[2]))];
    if (cell == kNone) {
      cell = static_cast<std::int32_t>(cells_.size());
      order_.push_back(cell);
      cells_.push_back({RegisterBox::none(), {at[0], at[1], at[2]}, 0, 0});
    }
    cell_of.push_back(cell);
    Cell& to = cells_[static_cast<std::size_t>(cell)];
    to.box.add(box);
    ++to.count;
  }
  splits_.reserve(cells_.size());
  root_ = split(0, cells_.size());

  std::vector<std::size_t> begins;
  begins.reserve(cells_.size());
  std::size_t begin = 0;
  largest_cell_ = 0;
  for (const std::int32_t i : order_) {
    Cell& cell = cells_[static_cast<std::size_t>(i)];
    begins.push_back(begin);
    cell.next = begin;
    begin += cell.count;
    largest_cell_ = std::max(largest_cell_, cell.count);
  }
  for (Split& s : splits_) s.middle = begins[s.middle];
  for (std::size_t i = 0; i < elements.size(); ++i)
    entries[cells_[static_cast<std::size_t>(cell_of[i])].next++].set(elements.box(i), i);
}

/// Splits the cells order_[begin, end) at a plane of the grid, down to single ones, so that the order in
/// which they come does not matter. Here `middle` counts cells.
std::int32_t GridOrder::split(std::size_t begin, std::size_t end) {
  if (end - begin < 2) return kNone;
  const auto first = order_.begin() + static_cast<std::ptrdiff_t>(begin),
             last = order_.begin() + static_cast<std::ptrdiff_t>(end);
  const auto cell = [this](std::int32_t i) -> const Cell& { return cells_[static_cast<std::size_t>(i)]; };
  int low[3] = {kMostAlong, kMostAlong, kMostAlong}, high[3] = {0, 0, 0};
  RegisterBox all = RegisterBox::none();
  for (auto i = first; i != last; ++i) {
    all.add(cell(*i).box);
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], cell(*i).place[k]);
      high[k] = std::max(high[k], cell(*i).place[k]);
    }
  }
  int axis = -1;
  for (int k = 0; k < 3; ++k) {
    if (high[k] > low[k] && (axis < 0 || all.upper[k] - all.lower[k] > all.upper[axis] - all.lower[axis]))
      axis = k;
  }
  const int layers = high[axis] - low[axis] + 1;
  RegisterBox box[kMostAlong], behind[kMostAlong];
  std::size_t count[kMostAlong], entries = 0;
  std::fill(box, box + layers, RegisterBox::none());
  std::fill(count, count + layers, 0);
  for (auto i = first; i != last; ++i) {
    const int layer = cell(*i).place[axis] - low[axis];
    box[layer].add(cell(*i).box);
    count[layer] += cell(*i).count;
    entries += cell(*i).count;
  }
  for (int layer = layers - 1; layer >= 0; --layer) {
    behind[layer] = box[layer];
    if (layer + 1 < layers) behind[layer].add(behind[layer + 1]);
  }
  Split best{0, {}, {kNone, kNone}};
  int best_layer = -1;
  float least = RegisterBox::kFar;
  std::size_t before = 0;
  RegisterBox sweep = RegisterBox::none();
  for (int layer = 0; layer + 1 < layers; ++layer) {
    sweep.add(box[layer]);
    before += count[layer];
    const float cost = static_cast<float>(before) * sweep.halfArea() +
                       static_cast<float>(entries - before) * behind[layer + 1].halfArea();
    if (best_layer >= 0 && !(cost < least)) continue;
    least = cost;
    best_layer = layer;
    best.box[0] = sweep;
    best.box[1] = behind[layer + 1];
  }
  const auto middle = std::partition(
      first, last, [&](std::int32_t i) { return cell(i).place[axis] - low[axis] <= best_layer; });
  best.middle = static_cast<std::size_t>(middle - order_.begin());
  const auto made = static_cast<std::size_t>(splits_.size());
  splits_.push_back(best);
  const std::int32_t below[2] = {split(begin, best.middle), split(best.middle, end)};
  std::copy(below, below + 2, splits_[made].below);
  return static_cast<std::int32_t>(made);
}

}  // namespace collision_node::geometry
