#include "marker/grow_region.hpp"

namespace berth {
namespace {

struct Run {
  int x0, x1;
  bool is_empty() const { return x1 < x0; }
};

class Grower {
 public:
  Grower(const ImageView& image, const Window& window, GrowRule rule)
      : image_(image), window_(window), rule_(rule) {}

  bool is_bright(int x, int y) const {
    return rule_.smooth ? mean_is_bright(x, y) : image_.at(x, y) > rule_.threshold;
  }

  // The last bright pixel of a row from x on in the direction `way`, up to the window's `border`.
  int last_bright(int x, int y, int way, int border) const {
    if (rule_.smooth) {
      while (x != border && mean_is_bright(x + way, y)) x += way;
      return x;
    }
    const std::uint8_t* const row = image_.row(y);
    const int mask = image_.polarity_mask, threshold = rule_.threshold;
    while (x != border && (row[x + way] ^ mask) > threshold) x += way;
    return x;
  }

  // The bright run through (x, y), to both sides.
  Run run_through(int x, int y) const {
    return {last_bright(x, y, -1, window_.x0), last_bright(x, y, 1, window_.x1)};
  }

  // The bright pixels of row y that touch `before`, from the first to the last of them.
  Run run_below(const Run& before, int y) const {
    int first = before.x0, last = before.x1;
    while (first <= before.x1 && !is_bright(first, y)) ++first;
    if (first > before.x1) return {0, -1};
    while (!is_bright(last, y)) --last;
    Run run{first, last};
    if (first == before.x0) run.x0 = last_bright(first, y, -1, window_.x0);
    if (last == before.x1) run.x1 = last_bright(last, y, 1, window_.x1);
    return run;
  }

  void add(const Run& run, int y, Region& region) const {
    region.area += run.x1 - run.x0 + 1;
    if (run.x0 < region.x0) region.x0 = run.x0;
    if (run.x1 > region.x1) region.x1 = run.x1;
    if (y < region.y0) region.y0 = y;
    if (y > region.y1) region.y1 = y;
    if (run.x0 == window_.x0 || run.x1 == window_.x1 || y == window_.y0 || y == window_.y1) {
      region.touches_border = true;
    }
  }

 private:
  bool mean_is_bright(int x, int y) const {
    const std::uint8_t* const middle = image_.row(y) + x;
    if (x > 0 && x + 1 < image_.width && y > 0 && y + 1 < image_.height) {
      const std::uint8_t* const above = middle - image_.stride;
      const std::uint8_t* const below = middle + image_.stride;
      const int sum = above[-1] + above[0] + above[1] + middle[-1] + middle[0] + middle[1] +
                      below[-1] + below[0] + below[1];
      return (image_.polarity_mask != 0 ? 9 * 255 - sum : sum) > 9 * rule_.threshold;
    }
    // Less at the image's borders.
    const int u0 = x > 0 ? x - 1 : x, u1 = x + 1 < image_.width ? x + 1 : x;
    const int v0 = y > 0 ? y - 1 : y, v1 = y + 1 < image_.height ? y + 1 : y;
    int sum = 0;
    for (int v = v0; v <= v1; ++v) {
      const std::uint8_t* row = image_.row(v);
      for (int u = u0; u <= u1; ++u) sum += row[u] ^ image_.polarity_mask;
    }
    return sum > rule_.threshold * ((u1 - u0 + 1) * (v1 - v0 + 1));
  }

  const ImageView& image_;
  const Window& window_;
  GrowRule rule_;
};

}  // namespace

Region grow_region(const ImageView& image, const Window& window, int x, int y, GrowRule rule) {
  Region region;
  region.x0 = region.x1 = x;
  region.y0 = region.y1 = y;
  const Grower grower(image, window, rule);
  if (!grower.is_bright(x, y)) return region;
  const Run seed = grower.run_through(x, y);
  grower.add(seed, y, region);
  for (int step = -1; step <= 1; step += 2) {
    Run run = seed;
    for (int row = y + step; row >= window.y0 && row <= window.y1; row += step) {
      run = grower.run_below(run, row);
      if (run.is_empty()) break;
      grower.add(run, row, region);
    }
  }
  return region;
}

}  // namespace berth
