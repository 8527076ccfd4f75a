#include "bench/edges/follow.hpp"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace berth::bench {
namespace {

const cv::Point kNeighbours[8] = {{1, 0},  {1, 1},   {0, 1},  {-1, 1},
                                  {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

class Follower {
 public:
  explicit Follower(const cv::Mat& edges) {
    cv::copyMakeBorder(edges, left_, 1, 1, 1, 1, cv::BORDER_CONSTANT, 0);
  }

  int neighbours(cv::Point p) const {
    return static_cast<int>(std::count_if(std::begin(kNeighbours), std::end(kNeighbours),
                                          [&](cv::Point n) { return is_left(p + n); }));
  }
  bool is_left(cv::Point p) const { return left_.at<uchar>(p + cv::Point(1, 1)) != 0; }
  void take(cv::Point p) { left_.at<uchar>(p + cv::Point(1, 1)) = 0; }

  // The neighbour that turns least from direction `ahead`; direct before diagonal where equal.
  bool step(cv::Point& p, int& ahead, double& steps) {
    static constexpr int kTurns[8] = {0, 1, -1, 2, -2, 3, -3, 4};
    ++steps;
    for (const int turn : kTurns) {
      const int k = (ahead + turn + 8) & 7;
      if (!is_left(p + kNeighbours[k])) continue;
      p += kNeighbours[k];
      ahead = k;
      take(p);
      return true;
    }
    return false;
  }

  std::vector<cv::Point> walk(cv::Point start, double& steps) {
    std::vector<cv::Point> chain{start};
    take(start);
    int first = -1;
    for (const bool is_back : {false, true}) {
      cv::Point p = start;
      int ahead = is_back && first >= 0 ? (first + 4) & 7 : 0;
      if (is_back) std::reverse(chain.begin(), chain.end());
      while (step(p, ahead, steps)) {
        chain.push_back(p);
        if (first < 0) first = ahead;
      }
    }
    return chain;
  }

 private:
  cv::Mat left_;
};

enum : uchar { kNothing = 0, kAnchor = 1, kEdge = 2 };

// Edge Drawing's walk; the map of edges has a border of two pixels.
class DrawingWalk {
 public:
  DrawingWalk(const cv::Mat& smooth, const cv::Mat& magnitude, int threshold)
      : magnitude_(magnitude), threshold_(threshold), map_(cv::Mat::zeros(smooth.size(), CV_8U)) {
    cv::Sobel(smooth, gx_, CV_16S, 1, 0);
    cv::Sobel(smooth, gy_, CV_16S, 0, 1);
  }

  double run(int anchor_threshold) {
    std::vector<cv::Point> anchors;
    for (int y = 2; y < map_.rows - 2; ++y) {
      for (int x = 2; x < map_.cols - 2; ++x) {
        if (!is_anchor({x, y}, anchor_threshold)) continue;
        map_.at<uchar>(y, x) = kAnchor;
        anchors.emplace_back(x, y);
      }
    }
    std::stable_sort(anchors.begin(), anchors.end(),
                     [&](cv::Point a, cv::Point b) { return strength(a) > strength(b); });
    for (const cv::Point& anchor : anchors) {
      if (map_.at<uchar>(anchor) == kAnchor) draw_from(anchor);
    }
    return steps_;
  }

 private:
  struct Node {
    cv::Point p, ahead;
  };

  int strength(cv::Point p) const { return magnitude_.at<std::uint16_t>(p); }
  bool is_horizontal(cv::Point p) const {
    return std::abs(gx_.at<short>(p)) < std::abs(gy_.at<short>(p));
  }
  bool is_anchor(cv::Point p, int anchor_threshold) const {
    if (strength(p) < threshold_) return false;
    const cv::Point across = is_horizontal(p) ? cv::Point(0, 1) : cv::Point(1, 0);
    return strength(p) - strength(p + across) >= anchor_threshold &&
           strength(p) - strength(p - across) >= anchor_threshold;
  }
  bool is_inside(cv::Point p) const {
    return p.x >= 2 && p.y >= 2 && p.x < map_.cols - 2 && p.y < map_.rows - 2;
  }

  void turn_from(cv::Point p) {
    const cv::Point along = is_horizontal(p) ? cv::Point(1, 0) : cv::Point(0, 1);
    stack_.push_back({p, along});
    stack_.push_back({p, -along});
  }

  void draw_from(cv::Point anchor) {
    turn_from(anchor);
    while (!stack_.empty()) {
      const Node node = stack_.back();
      stack_.pop_back();
      draw_straight(node.p, node.ahead);
    }
  }

  // Goes on as long as the edge keeps to the axis of `ahead`; where it turns, both ways are tried.
  void draw_straight(cv::Point p, cv::Point ahead) {
    const cv::Point side(ahead.y, ahead.x);
    while (is_horizontal(p) == (ahead.y == 0)) {
      ++steps_;
      map_.at<uchar>(p) = kEdge;
      for (const cv::Point& q : {p + side, p - side}) {
        if (map_.at<uchar>(q) == kAnchor) map_.at<uchar>(q) = kNothing;
      }
      p = next(p + ahead, side);
      if (!is_inside(p) || map_.at<uchar>(p) == kEdge || strength(p) < threshold_) return;
    }
    turn_from(p);
  }

  cv::Point next(cv::Point middle, cv::Point side) const {
    for (const cv::Point& q : {middle, middle - side, middle + side}) {
      if (map_.at<uchar>(q) != kNothing) return q;
    }
    const int a = strength(middle - side), b = strength(middle), c = strength(middle + side);
    if (a > b) return a > c ? middle - side : middle + side;
    return c > b ? middle + side : middle;
  }

  const cv::Mat& magnitude_;
  int threshold_;
  cv::Mat map_, gx_, gy_;
  std::vector<Node> stack_;
  double steps_ = 0;
};

}  // namespace

std::vector<std::vector<cv::Point>> follow_contours(const cv::Mat& edges, int least,
                                                    double& steps) {
  Follower follower(edges);
  std::vector<std::vector<cv::Point>> chains;
  for (const bool ends_only : {true, false}) {
    for (int y = 0; y < edges.rows; ++y) {
      const uchar* row = edges.ptr<uchar>(y);
      for (int x = 0; x < edges.cols; ++x) {
        if (row[x] == 0 || !follower.is_left({x, y})) continue;
        if (ends_only && follower.neighbours({x, y}) != 1) continue;
        auto chain = follower.walk({x, y}, steps);
        if (static_cast<int>(chain.size()) >= least) chains.push_back(std::move(chain));
      }
    }
  }
  return chains;
}

double count_drawing_steps(const cv::Mat& smooth, const cv::Mat& magnitude, int threshold,
                           int anchor_threshold) {
  return DrawingWalk(smooth, magnitude, threshold).run(anchor_threshold);
}

}  // namespace berth::bench
