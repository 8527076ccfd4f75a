#include "pipeline/pipeline.hpp"

#include "core/digest.hpp"
#include "marker/locate_dots.hpp"
#include "pipeline/search.hpp"

namespace berth {
namespace {

class Frame {
 public:
  Frame(const Parameters& parameters, const ImageView& image, Workspace& work, FrameResult& result,
        const StageObserver& observer)
      : parameters_(parameters), image_(image), work_(work), result_(result), observer_(observer) {}

  void run() {
    if (search()) measure();
  }

 private:
  // Stages 1 to 3: where is the target, roughly?
  bool search() {
    search_edges(parameters_, image_, work_, result_);
    end(Stage::kEdges);
    link_chains(work_, result_);
    end(Stage::kLink);
    search_rings(work_, result_);
    end(Stage::kCircles);
    identify_ring(parameters_, image_, work_, result_);
    end(Stage::kIdentify);
    if (result_.tally.identified_rank == 0) result_.reason = why_not_found();
    return result_.tally.identified_rank != 0;
  }

  Reason why_not_found() const {
    if (work_.set.count == 0) return Reason::kLowContrast;
    const Reason reason = work_.identification.reason;
    const bool is_short_of_memory = (result_.tally.pools_full & 3) != 0;
    return reason == Reason::kNoCircle && is_short_of_memory ? Reason::kPoolFull : reason;
  }

  // Stages 4 to 6: where exactly?
  void measure() {
    const Identification& id = work_.identification;
    result_.identified = true;
    result_.ring_center_px = id.ring_center_px;
    result_.ring_radius_px = id.ring_radius_px;
    result_.roll = id.roll;
    result_.tally.black = static_cast<std::uint8_t>(id.reference.black / kGreyOne);
    result_.tally.white = static_cast<std::uint8_t>(id.reference.white / kGreyOne);
    end(Stage::kReference);
    const TargetView view{parameters_.camera, image_, id.camera_from_target};
    locate_dots(view, parameters_.target, id.reference, result_.tally.noise_q8, result_.markers);
    for (int m = 0; m < result_.markers.count; ++m) {
      if (result_.markers.markers[m].located) ++result_.tally.dots_located;
    }
    end(Stage::kMarkers);
    result_.reason = Reason::kNoSolution;
  }

  void end(Stage stage) {
    if (observer_.on_stage_end) observer_.on_stage_end(observer_.context, stage);
  }

  const Parameters& parameters_;
  const ImageView& image_;
  Workspace& work_;
  FrameResult& result_;
  const StageObserver& observer_;
};

}  // namespace

const char* stage_name(Stage stage) {
  constexpr const char* kNames[kStageCount] = {"edges",     "link",    "circles", "identify",
                                               "reference", "markers", "pose",    "refine"};
  return stage < Stage::kCount ? kNames[static_cast<int>(stage)] : "unknown";
}

void process_frame(const Parameters& parameters, const ImageView& image, Workspace& workspace,
                   FrameResult& result, const StageObserver& observer) {
  result = FrameResult{};
  workspace.candidate_count = workspace.ring_count = 0;
  workspace.map.count = workspace.set.count = 0;
  if (image.width != parameters.camera.width || image.height != parameters.camera.height) return;
  ImageView view = image;
  view.polarity_mask = parameters.target.white_on_black ? 0x00 : 0xff;
  Frame(parameters, view, workspace, result, observer).run();
}

}  // namespace berth
