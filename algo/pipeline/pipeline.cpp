#include "pipeline/pipeline.hpp"

#include "marker/locate_dots.hpp"
#include "pipeline/measure.hpp"
#include "pipeline/plates.hpp"
#include "pipeline/search.hpp"
#include "pipeline/window.hpp"
#include "target/verify_layout.hpp"

namespace berth {
namespace {

constexpr int kMinDots = 3;  // of any target
constexpr std::uint32_t kStepsForLayout = 330000;
// Cells of a side, binned 2 x 2, from which on a window is looked at binned 4 x 4 first.
constexpr int kLargeWindow = 128;
constexpr int kMaxSmallRings = 8;

// Every 32nd pixel in every 32nd row: more than half at the end of the scale.
bool is_mostly_clipped(const ImageView& image) {
  int clipped = 0, seen = 0;
  for (int y = 16; y < image.height; y += 32) {
    for (int x = 16; x < image.width; x += 32, ++seen) {
      clipped += image.pixels[y * image.stride + x] >= 254 ? 1 : 0;
    }
  }
  return 2 * clipped > seen;
}

class Frame {
 public:
  Frame(const Parameters& parameters, const ImageView& image, const Prior& prior, Workspace& work,
        FrameResult& result, const StageObserver& observer)
      : parameters_(parameters),
        image_(image),
        prior_(prior),
        work_(work),
        result_(result),
        observer_(observer) {}

  void run() {
    const Thresholds& t = parameters_.thresholds;
    const bool is_search_shorter = t.search_budget_units < t.frame_budget_units;
    search_units_ = is_search_shorter ? t.search_budget_units : t.frame_budget_units;
    budget_.set_budget(search_units_);
    work_.identification = Identification{};
    if (!find_there() && !find_soon() && !find_anywhere()) give_up();
    result_.work_units = budget_.units();
  }

 private:
  // Where the target was, if ring, line and dots are seen from its last pose: without edges.
  bool find_there() {
    if (!prior_.has_pose || !know_noise(image_, result_, budget_)) return false;
    work_.grid = whole_frame(image_);
    most_dots_ = min_dots() - 1;
    identify_pose(prior_.camera_from_target);
    if (most_dots_ >= min_dots() && is_confirmed(nullptr) && !budget_.is_spent()) {
      accept(0);
      result_.tally.targets = 1;
      measure();
      if (result_.identified && result_.reason != Reason::kResidualTooLarge) return true;
    }
    budget_.set_budget(search_units_);
    work_.identification = Identification{};
    forget();
    return false;
  }

  // Where the target is found for a few instructions, if it is: in the surroundings of the last
  // pose, in the whole frame at a quarter of its resolution.
  bool find_soon() {
    if (prior_.has_pose && find_in(surroundings(prior_.camera_from_target))) return true;
    return search(coarser(whole_frame(image_)));
  }

  bool find_in(const SearchGrid& window) {
    return (is_large(window) && search(coarser(window))) || search(window);
  }

  static bool is_large(const SearchGrid& window) {
    return window.width >= kLargeWindow || window.height >= kLargeWindow;
  }

  // The same wherever it is, however small or dim; first where the coarse look saw something like
  // it. Votes are cast only where no arc is the target's ring.
  bool find_anywhere() {
    if (is_in_doubt_ && search_again()) return true;
    return search_small_rings() || search(whole_frame(image_)) || search_votes();
  }

  // Where the coarse look saw a ring too small for it to tell line and dots.
  bool search_small_rings() {
    for (int k = 0; k < small_ring_count_ && !budget_.is_spent(); ++k) {
      if (search(small_rings_[k])) return true;
    }
    return false;
  }

  // As if there had been no coarse look, but for the place.
  bool search_again() {
    const RigidTransform place = work_.identification.camera_from_target;
    work_.identification = Identification{};
    return search(surroundings(place));
  }

  SearchGrid surroundings(const RigidTransform& camera_from_target) const {
    return window_around(parameters_.camera, parameters_.target, camera_from_target);
  }

  // The ring whose line and dots are where the target has them, of those that arcs propose: whole
  // outlines first, which nearly all targets show.
  bool search(const SearchGrid& grid) {
    is_in_doubt_ = false;
    work_.arc_count = work_.candidate_count = work_.ring_count = 0;
    work_.map.count = work_.set.count = 0;
    if (budget_.is_spent()) return false;
    search_edges(parameters_, image_, grid, work_, result_, budget_);
    end(Stage::kEdges);
    if (budget_.is_spent()) return false;
    link_chains(work_, result_, budget_);
    end(Stage::kLink);
    if (budget_.is_spent()) return false;
    const int whole = cut_arcs(work_, result_, budget_);
    return search_arcs(0, whole) || (!is_in_doubt_ && search_arcs(whole, work_.arc_count));
  }

  bool search_arcs(int begin, int end_of_arcs) {
    if (budget_.is_spent()) return false;
    const int first = work_.ring_count;
    rings_from_arcs(begin, end_of_arcs, work_, result_, budget_);
    end(Stage::kCircles);
    return identify_rings(first);
  }

  // The same of those that votes propose, among the edges that are there.
  bool search_votes() {
    if (budget_.is_spent()) return false;
    const int first = work_.ring_count;
    rings_from_votes(work_, result_, budget_);
    end(Stage::kCircles);
    return identify_rings(first);
  }

  // Nothing is left of a target that a coarse look or the profiles took for one.
  void forget() {
    result_.identified = false;
    result_.tally.dots_located = 0;
    result_.tally.identified_rank = 0;
    result_.tally.targets = 0;
    result_.ring_center_px = Vec2Px(Px(0), Px(0));
    result_.ring_radius_px = Px(0);
    result_.roll = Angle(0);
    result_.effector_from_latch = RigidTransform{};
    result_.effector_covariance = PoseCovariance{};
    result_.markers = MarkerSet{};
    result_.pose = PoseEstimate{};
    result_.blur = kUnknownBlur;
    result_.has_pose = false;
  }

  void give_up() {
    forget();
    result_.reason = budget_.is_spent() ? Reason::kDeadline : why_not_found();
  }

  // One dot may be hidden. Any three blobs have a pose that fits them, so that CT-1 needs four.
  int min_dots() const {
    const int all_but_one = parameters_.target.dot_count - 1;
    return all_but_one > kMinDots ? all_but_one : kMinDots;
  }

  // Stages 4 to 6 of ring after ring, until all of them take one for the target's.
  bool identify_rings(int first) {
    for (int ring = first; ring < work_.ring_count && !budget_.is_spent(); ++ring) {
      if (near_misses_.cover(work_.grid, work_.rings[ring])) continue;
      if (!identify_ring(work_.rings[ring])) {
        if (has_ring_) keep_small_ring(work_.rings[ring]);
        continue;
      }
      const bool is_target = is_confirmed(&work_.rings[ring]);
      if (budget_.is_spent()) return false;  // what was not looked at to the end confirms nothing
      if (!is_target) {
        keep_small_ring(work_.rings[ring]);
        work_.identification.reason = Reason::kLayoutMismatch;
        continue;
      }
      is_in_doubt_ = is_coarse(work_.grid) && !is_beyond_doubt() && !is_settled_by_its_pose(ring);
      if (is_in_doubt_) return false;
      accept(ring + 1);
      measure();
      if (result_.identified) {
        result_.tally.targets = static_cast<std::uint8_t>(1 + count_further_targets(ring));
        end(Stage::kIdentify);
        return true;
      }
      budget_.set_budget(search_units_);
      // Dots sought from a coarse ring's pose may be others than from a fine one's.
      is_in_doubt_ = is_coarse(work_.grid) && result_.reason == Reason::kResidualTooLarge;
      if (is_in_doubt_) return false;
      refute(ring);
    }
    return false;
  }

  void keep_small_ring(const RingCandidate& ring) {
    if (!is_coarse(work_.grid) || small_ring_count_ == kMaxSmallRings) return;
    const SearchGrid window = window_around(parameters_.camera, work_.grid, ring);
    if (!is_large(window)) small_rings_[small_ring_count_++] = window;
  }

  // All dots are seen, and have one pose. Else a finer look may see more.
  bool is_beyond_doubt() const {
    return start_.has_pose && start_.reason == Reason::kNone &&
           result_.tally.dots_located == parameters_.target.dot_count;
  }

  // A ring that is large enough in coarse cells: its dots' pose tells better where to look for line
  // and dots than a finer outline would.
  bool is_settled_by_its_pose(int ring) {
    if (!start_.has_pose) return false;
    const PoseEstimate pose = start_.estimate;
    const SearchGrid window = surroundings(pose.camera_from_target);
    if (!is_large(window)) return false;
    const Identification id = work_.identification;
    work_.identification = Identification{};
    most_dots_ = min_dots() - 1;
    identify_pose(pose.camera_from_target);
    if (pose.has_second) identify_pose(pose.second);
    if (most_dots_ >= min_dots() && is_confirmed(&work_.rings[ring]) && !budget_.is_spent())
      return true;
    work_.identification = id;
    return false;
  }

  // Whole rings after the accepted one that have line and dots as well, as far as the frame's
  // budget lasts. They were found anyway.
  int count_further_targets(int accepted) {
    const PlateCircle plate = plate_about(parameters_.target, work_.grid, work_.rings[accepted]);
    int count = 0;
    for (int ring = accepted + 1; ring < work_.ring_count && !budget_.is_spent(); ++ring) {
      if (work_.rings[ring].covered < kWholeSectors) break;
      if (is_inside(work_.grid, work_.rings[ring], plate)) continue;
      if (is_like_target(work_.rings[ring])) ++count;
    }
    return count;
  }

  bool is_like_target(const RingCandidate& ring) {
    PlatePose plates[2];
    if (!solve_plates(parameters_.camera, parameters_.target, work_.grid, ring, plates, budget_)) {
      return false;
    }
    for (const PlatePose& plate : plates) {
      const Identification id = identify_target(
          parameters_.camera, image_, plate, parameters_.target, result_.tally.noise_q8, budget_);
      MarkerSet markers;
      if (id.reason == Reason::kNone && locate_markers(id, markers) >= min_dots()) return true;
    }
    return false;
  }

  // Both tilts of a ring, of which the one with more dots in place is the right one.
  bool identify_ring(const RingCandidate& ring) {
    PlatePose plates[2];
    if (!solve_plates(parameters_.camera, parameters_.target, work_.grid, ring, plates, budget_)) {
      return false;
    }
    most_dots_ = min_dots() - 1;
    has_ring_ = false;
    for (const PlatePose& plate : plates) identify_plate(plate, false);
    return most_dots_ >= min_dots();
  }

  // Where a pose of the target has it: with its roll.
  void identify_pose(const RigidTransform& pose) {
    identify_plate({pose.rotation, pose.translation_mm}, true);
  }

  void identify_plate(const PlatePose& plate, bool has_roll) {
    const Identification id =
        berth::identify_plate(parameters_, image_, plate, has_roll, result_, budget_);
    end(Stage::kIdentify);
    if (id.reason != Reason::kNoCircle) has_ring_ = true;
    if (id.reason != Reason::kNone) return keep_if_closer(id);
    MarkerSet markers;
    const int dots = locate_markers(id, markers);
    end(Stage::kMarkers);
    const bool is_better = dots > most_dots_ || (dots == most_dots_ && dots >= min_dots() &&
                                                 id.line_cost < work_.identification.line_cost);
    if (!is_better) {
      if (dots < min_dots()) keep_if_closer(short_of_dots(id, dots));
      return;
    }
    most_dots_ = dots;
    work_.identification = id;
    result_.markers = markers;
    result_.tally.dots_located = static_cast<std::uint16_t>(dots);
  }

  // Do the dots confirm the ring, all of them or all but the unlikeliest? A glint or an occluder
  // may pass for a dot.
  bool is_confirmed(const RingCandidate* ring) {
    if (is_confirmed_by_dots(ring)) return true;
    if (start_.reason != Reason::kResidualTooLarge) return false;
    if (result_.tally.dots_located <= min_dots()) return false;
    drop_unlikeliest_dot(parameters_, work_.identification, result_);
    return is_confirmed_by_dots(ring);
  }

  // The pose of the dots, and whether ring, line and sizes are what it says, in either pose where
  // there are two. Dots that give no pose don't refute the layout either, if the ring's own
  // pose has the line in its place.
  bool is_confirmed_by_dots(const RingCandidate* ring) {
    start_ =
        solve_from_dots(parameters_, work_.identification.camera_from_target, result_, budget_);
    end(Stage::kPose);
    if (!start_.has_pose) return work_.identification.line_in_place;
    const bool fits = is_layout_seen(ring);
    end(Stage::kIdentify);
    return fits;
  }

  bool is_layout_seen(const RingCandidate* ring) {
    const PoseEstimate& pose = start_.estimate;
    return has_layout(ring, pose.camera_from_target) ||
           (start_.reason == Reason::kAmbiguous && pose.has_second &&
            has_layout(ring, pose.second));
  }

  bool has_layout(const RingCandidate* ring, const RigidTransform& pose) {
    if (!budget_.take(kStepsForLayout)) return false;
    const TargetView view{parameters_.camera, image_, pose};
    if (ring && !is_ring_of_size(view, parameters_.target, work_.grid, *ring)) return false;
    const LayoutCheck check = check_layout(view, parameters_.target, work_.identification.reference,
                                           result_.tally.noise_q8);
    blur_mm_ = check.sigma_mm;
    return check.is_consistent;
  }

  // Two dots with ring and line: others are hidden. With fewer it is something else.
  static Identification short_of_dots(Identification id, int dots) {
    id.reason = dots >= 2 ? Reason::kDotMissing : Reason::kLayoutMismatch;
    return id;
  }

  // What is kept of a search without success is the ring that came closest.
  void keep_if_closer(const Identification& id) {
    const Reason kept = work_.identification.reason;
    if (kept == Reason::kNone) return;
    if (id.reason > kept) work_.identification = id;  // reasons are in the order of the tests
  }

  Reason why_not_found() const {
    const Identification& id = work_.identification;
    const bool has_ring = id.reason > Reason::kNoCircle;
    if (!has_ring && is_mostly_clipped(image_)) return Reason::kSaturated;
    if (work_.set.count == 0) return Reason::kLowContrast;
    const bool is_short_of_memory = (result_.tally.pools_full & 3) != 0;
    if (!has_ring && is_short_of_memory) return Reason::kPoolFull;
    // Clipped white spreads by an unknown part of the blur: sizes and dots are not to be judged.
    const bool is_judged = id.reason > Reason::kNoLine;
    if (is_judged && 2 * id.reference.clipped_sectors > kReferenceSectors) {
      return Reason::kSaturated;
    }
    return id.reason;
  }

  int locate_markers(const Identification& id, MarkerSet& markers) {
    const TargetView view{parameters_.camera, image_, id.camera_from_target};
    locate_dots(view, parameters_.target, id.reference, result_.tally.noise_q8, markers, budget_);
    int located = 0;
    for (int m = 0; m < markers.count; ++m) located += markers.markers[m].located ? 1 : 0;
    return located;
  }

  void accept(int rank) {
    const Identification& id = work_.identification;
    result_.identified = true;
    result_.tally.identified_rank = static_cast<std::uint16_t>(rank);
    // The dots see all of it better than the ring's outline, of which a part may be hidden.
    report_ring(start_.has_pose ? start_.estimate.camera_from_target : id.camera_from_target);
    result_.tally.black = static_cast<std::uint8_t>(id.reference.black / kGreyOne);
    result_.tally.white = static_cast<std::uint8_t>(id.reference.white / kGreyOne);
  }

  void report_ring(const RigidTransform& camera_from_target) {
    const TargetView view{parameters_.camera, image_, camera_from_target};
    const RingImage ring = image_of_ring(view, parameters_.target);
    result_.ring_center_px = ring.center_px;
    result_.ring_radius_px = ring.radius_px;
    result_.roll = ring.roll;
  }

  // Stage 6: where exactly? And is it the target, to all pixels of its outlines?
  void measure() {
    if (!start_.has_pose) {
      result_.reason = start_.reason;
      return;
    }
    budget_.set_budget(parameters_.thresholds.frame_budget_units);
    refine_from_outlines(parameters_, image_, start_, {blur_mm_, prior_.blur}, work_, result_,
                         budget_);
    report_ring(result_.pose.camera_from_target);
    end(Stage::kRefine);
  }

  // A near miss: the search goes on behind it.
  void refute(int ring) {
    near_misses_.add(plate_about(parameters_.target, work_.grid, work_.rings[ring]));
    forget();
    work_.identification.reason = Reason::kLayoutMismatch;
  }

  void end(Stage stage) {
    result_.work_units = budget_.units();
    if (observer_.on_stage_end) observer_.on_stage_end(observer_.context, stage);
  }

  const Parameters& parameters_;
  const ImageView& image_;
  const Prior& prior_;
  Workspace& work_;
  FrameResult& result_;
  const StageObserver& observer_;
  Work budget_;
  PoseOutcome start_;         // the dots' pose, from which the outlines start
  Mm blur_mm_{0};             // sigma on the plate, 0: unknown
  bool has_ring_ = false;     // one of the plates of a ring has it white between black
  int most_dots_ = 0;         // of the plates of a ring
  bool is_in_doubt_ = false;  // the coarse look has seen the target, but not all of it
  std::int32_t search_units_ = 0;
  NearMisses near_misses_;
  SearchGrid small_rings_[kMaxSmallRings] = {};  // windows around them
  int small_ring_count_ = 0;
};

}  // namespace

const char* stage_name(Stage stage) {
  constexpr const char* kNames[kStageCount] = {"edges",     "link",    "circles", "identify",
                                               "reference", "markers", "pose",    "refine"};
  return stage < Stage::kCount ? kNames[static_cast<int>(stage)] : "unknown";
}

void process_frame(const Parameters& parameters, const ImageView& image, const Prior& prior,
                   Workspace& workspace, FrameResult& result, const StageObserver& observer) {
  result = FrameResult{};
  workspace.arc_count = workspace.candidate_count = workspace.ring_count = 0;
  workspace.map.count = workspace.set.count = 0;
  if (image.width != parameters.camera.width || image.height != parameters.camera.height) return;
  ImageView view = image;
  view.polarity_mask = parameters.target.white_on_black ? 0x00 : 0xff;
  Frame(parameters, view, prior, workspace, result, observer).run();
}

}  // namespace berth
